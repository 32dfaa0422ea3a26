"""What was measured as pictures for the docs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from .asking import Figure
from .memory import Peak

_STYLES = {
    "direct": ("0.4", ":", "x"), "evcosim": ("#0b6e4f", "-", "o"), "evcosim_python": ("#0b6e4f", "--", "o"),
    "ecospy": ("#c1440e", "-", "s"), "fmpy_loop": ("#3b6fb6", "--", "^"), "fmpy_ssp": ("#3b6fb6", "-", "^"),
    "cofmupy": ("#8a3b52", "--", "P"), "libcosimpy": ("#7b4ea3", "-", "D"),
    "fmpy_container": ("#b08900", "-", "v"), "toolbox_container": ("#b08900", "--", "v"),
}  # fmt: skip # color, line and marker of each master


def masters(found: Sequence[Sequence[Figure]], names: Mapping[str, str], path: Path) -> None:
    """Time a step against the number of units, a panel for each kind of FMU, recorded and not."""
    panels = [("c", True), ("c", False), ("python", True), ("python", False)]
    figure, axes = plt.subplots(2, 2, figsize=(10, 8), sharex=True, layout="constrained")
    shown: dict[str, Any] = {}
    for axis, (kind, record) in zip(axes.flat, panels, strict=True):
        rows = [
            r for r in found if (r[0].case.kind, r[0].case.record, r[0].case.channel) == (kind, record, False)
        ]
        shown |= _lines(axis, rows, names)
        units, rest = "C" if kind == "c" else "pythonfmu", "every output" if record else "nothing"
        axis.set_title(f"{units} FMUs, {rest} recorded", fontsize=10)
    for axis in axes[:, 0]:
        axis.set_ylabel("time a step of the whole loop [µs]")
    for axis in axes[1]:
        axis.set_xlabel("units in the loop [1]")
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=3, frameon=False)
    save(figure, path)


def _lines(axis: Any, rows: Sequence[Sequence[Figure]], names: Mapping[str, str]) -> dict[str, Any]:
    handles = {}
    for i, first in enumerate(rows[0] if rows else ()):
        points = [(r[i].case.units, r[i].microseconds) for r in rows if r[i].microseconds is not None]
        name = names[first.master].replace(" {}", "")
        if points:  # no line in the legend for a master that cannot do it
            handles[name] = _series(axis, points, first.master, name)
    logarithmic(axis, [r[0].case.units for r in rows])
    return handles


def logarithmic(axis: Any, ticks: Sequence[int]) -> None:
    """Both axes logarithmic, with the measured numbers on the lower one."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xticks(ticks, [str(n) for n in ticks])
    axis.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.minorticks_off()
    axis.grid(True, color="0.9", linewidth=0.8)
    axis.spines[["top", "right"]].set_visible(False)


def save(figure: Any, path: Path) -> None:
    """Write a figure, the same bytes for the same numbers."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130, metadata={"Software": None})
    plt.close(figure)


def scaling(units: Sequence[Sequence[Figure]], signals: Sequence[Sequence[Figure]], path: Path) -> None:
    """Time for a unit and step against the number of units; time a step against signals on a connection."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    names = {"evcosim": "compiled engine", "evcosim_python": "python engine"}
    for i, first in enumerate(units[0]):
        points = [(r[i].case.units, r[i].microseconds / r[i].case.units) for r in units if r[i].microseconds]
        _series(left, points, first.master, names[first.master])
        for channel in (False, True):
            rows = [r for r in signals if r[0].case.channel == channel]
            points = [(r[i].case.signals, r[i].microseconds) for r in rows if r[i].microseconds]
            over = "over a CAN bus" if channel else "direct"
            _series(right, points, first.master, f"{names[first.master]}, {over}", full=not channel)
    left.set_xlabel("C units in the loop [1]")
    left.set_ylabel("time for a unit and step [µs]")
    right.set_xlabel("signals on each of 2 connections [1]")
    right.set_ylabel("time a step of the whole loop [µs]")
    logarithmic(left, [1, 10, 100, 1000])
    logarithmic(right, [r[0].case.signals for r in signals[: len(signals) // 2]])
    for axis in (left, right):
        axis.set_ylim(bottom=axis.get_ylim()[0] / 2)
        axis.legend(frameon=False, fontsize=9)
    save(figure, path)


def memory(peaks: Sequence[tuple[Peak, Peak]], name: Callable[[float], str], path: Path) -> None:
    """The most memory of a run without and with a CAN log, and what its rows would take there, against its
    length."""
    figure, axis = plt.subplots(figsize=(7, 4.2), layout="constrained")
    lengths = [p.length for p, _ in peaks]
    for place, color, line, marker, label in (
        (0, "#0b6e4f", "-", "o", "whole process, at most"),
        (1, "#b5562b", "--", "s", "the same with --can-log"),
    ):
        values = [pair[place].memory / 1e6 for pair in peaks]
        axis.plot(lengths, values, color=color, linestyle=line, marker=marker, label=label)
    rows = [p.rows / 1e6 for p, _ in peaks]
    axis.plot(lengths, rows, color="0.4", linestyle=":", marker="x", label="recorded rows")
    logarithmic(axis, [])
    axis.set_xticks(lengths, [name(length) for length in lengths])
    axis.set_xlabel("length of the run at 100 Hz")
    axis.set_ylabel("memory [MB]")
    axis.legend(frameon=False, fontsize=9)
    save(figure, path)


def _series(
    axis: Any, points: Sequence[tuple[float, float]], master: str, label: str, full: bool = True
) -> Any:
    """Draw the measured points of a master; the line that stands for them in a legend."""
    color, line, marker = _STYLES[master]
    x, y = zip(*points, strict=True) if points else ((), ())
    (handle,) = axis.plot(x, y, color=color, linestyle=line, marker=marker, label=label)
    handle.set(markersize=4, linewidth=1.4, markerfacecolor=color if full else "white")
    return handle
