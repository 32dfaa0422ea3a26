"""Figs. 4 to 19 of the paper of the two-motor car: eight quantities, each under PIDs and the MIMO-PID."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ...cosim.results.results import Results, ResultVariable
from ...cosim.row_store import Array
from ...cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ...cosim.units.conversion import between
from ...models.constants import KMH
from .page import Picture

_SIDES = (("left", "left"), ("right", "right"))
_RESISTANCES = ("slope", "rolling", "aerodynamic")
_MARGIN = 0.06  # of the range of a panel, above and below

_QUANTITIES: tuple[tuple[int, str, str, tuple[tuple[str, str], ...]], ...] = (
    (4, "speed of the car", "km/h", (("speed", "car"), ("reference", "reference"))),
    (6, "error of the speed", "km/h", (("error", "reference - car"),)),
    (8, "torque of the motors", "N.m", tuple((f"{side} torque", label) for side, label in _SIDES)),
    (10, "driving forces", "kN", tuple((f"{side} force", label) for side, label in _SIDES)),
    (12, "speed of the wheels", "rad/s", tuple((f"{side} wheel", label) for side, label in _SIDES)),
    (14, "distance", "m", (("distance", "car"),)),
    (16, "torque of the air", "N.m", (("air", "air"),)),
    (18, "load torque", "N.m", (("load", "slope, rolling and air"),)),
)
"""The number of the figure of the PIDs (the next is that of the MIMO-PID), what it shows, its signals."""


def pictures(found: Mapping[str, Any]) -> tuple[Picture, ...]:
    """Return the pictures of the runs "pid" and "mimo", each of two figures of the paper."""
    columns = [
        (ResultVariable(f"{run}/{name}", unit), values)
        for run in ("pid", "mimo")
        for name, (values, unit) in _columns(found[run]).items()
    ]
    both = joined(found["pid"].time, columns)
    return tuple(
        Picture.over_time(
            f"fig{i}-{i + 1}", f"Figs. {i} and {i + 1}: {text}", both, _spec(both, i, text, unit, signals)
        )
        for i, text, unit, signals in _QUANTITIES
    )


def _spec(
    both: Results, number: int, text: str, unit: str, signals: tuple[tuple[str, str], ...]
) -> FigureSpec:
    names = [f"{name}/{signal}" for name in ("pid", "mimo") for signal, _ in signals]
    maps = [between(both.units[name], unit) for name in names]
    ends = [
        m(float(x)) for m, name in zip(maps, names, strict=True) for x in (both[name].min(), both[name].max())
    ]
    low, high = min(ends), max(ends)
    space = _MARGIN * (high - low) or 1.0
    panels = [
        PanelSpec(
            label=label,
            unit=unit,
            signals=[SignalSpec(name=f"{name}/{signal}", label=about) for signal, about in signals],
            limits=(low - space, high + space),
        )
        for name, label in (("pid", f"Fig. {number}: PIDs"), ("mimo", f"Fig. {number + 1}: MIMO-PID"))
    ]
    return FigureSpec(title=f"Two-motor car: {text}", panels=panels)


def _columns(results: Results) -> dict[str, tuple[Array, str]]:
    """Return what the figures show, by name, each with its unit."""
    reference = results["differential.speed_reference"]
    columns = {
        "speed": (results["vehicle.speed"], "m/s"),
        "reference": (reference, "km/h"),
        "error": (reference - KMH * results["vehicle.speed"], "km/h"),
        "distance": (results["vehicle.distance"], "m"),
        "air": (results["vehicle.aerodynamic_torque"], "N.m"),
        "load": (np.sum([results[f"vehicle.{part}_torque"] for part in _RESISTANCES], axis=0), "N.m"),
    }
    for side, _ in _SIDES:
        columns |= {
            f"{side} torque": (results[f"{side}_drive.motor_torque"], "N.m"),
            f"{side} force": (results[f"vehicle.{side}_force"], "N"),
            f"{side} wheel": (results[f"vehicle.{side}_wheel_speed"], "rad/s"),
        }
    return columns


def joined(time: Array, columns: Iterable[tuple[ResultVariable, Array]]) -> Results:
    """Return the columns, shape (n,) each as `time` [s], as results."""
    variables, values = zip(*columns, strict=True)
    return Results(time, np.column_stack(values), variables)
