"""Figures of results: stacked panels over one time axis, shaded by the states of an enumeration.

What a figure shows is a `FigureSpec`, which stands in a system or scenario file or is made from the
results (`default_spec`). Colors are those of Okabe and Ito (Color Universal Design, 2008), which color-blind
readers tell apart; every signal of a panel also has a dash pattern and a width of its own, for print in
black and white. matplotlib is used through its objects alone: no display, no global state, the user's
matplotlibrc ignored, so that equal results give equal bytes.
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import math
import re
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..results.results import PIECE, Results
from ..row_store import Array
from ..system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ..writing import replacing
from .check import check, panel_conversion
from .default_figure import MAX_PANELS, default_spec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "COLORS",
    "FigureSpec",
    "PanelSpec",
    "SignalSpec",
    "canvas",
    "check",
    "default_spec",
    "draw",
    "draw_comparison",
    "look",
    "pretty",
    "save",
    "style",
    "thinned",
    "write",
]

COLORS = ("#0072B2", "#D55E00", "#009E73", "#000000", "#CC79A7", "#56B4E9", "#E69F00", "#7F7F7F")
_DASHES: tuple[Any, ...] = (
    "solid",
    (0, (5, 1.5)),
    (0, (1.2, 1.2)),
    (0, (7, 1.5, 1.2, 1.5)),
    (0, (2.5, 1.5)),
    (0, (9, 3)),
    (0, (4, 1.2, 1.2, 1.2, 1.2, 1.2)),
    (0, (1.2, 3)),
)
_STYLES = {"solid": _DASHES[0], "dashed": _DASHES[1], "dotted": _DASHES[2], "dashdot": _DASHES[3]}
# Backgrounds of the states: pale, of falling lightness, so that they differ in gray as well.
_SHADES = ("#FFFFFF", "#FBE3C0", "#BBD7EE", "#F3CDE0", "#BFE3CF", "#D9D9D9")

_OVERLAY = (1.7, 1.0)  # widths of two runs over each other, and of their difference
_WIDTH = 10.0  # inches; at _DPI 1440 pixels
_DPI = 144
_POINTS = 40_000  # of all lines together: about 1 MB of SVG
_SPANS = 1000  # shaded stretches at most: one pixel each
_MINUTES = 600.0  # s; a longer run has its time axis in minutes

_RC = {
    "font.size": 10.0,
    "axes.labelsize": 10.0,
    "axes.titlesize": 11.0,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#B0B0B0",
    "grid.linewidth": 0.5,
    "grid.alpha": 0.6,
    "legend.fontsize": 9.0,
    "legend.frameon": False,
    "legend.handlelength": 3.2,
    "lines.dash_capstyle": "butt",
    "figure.dpi": _DPI,
    "savefig.dpi": _DPI,
    "svg.hashsalt": "evcosim",
}


def draw(results: Results, spec: FigureSpec | None = None, *, title: str | None = None) -> Figure:
    """The figure of some results; without a spec, of `default_spec(results)`.

    Raises ConfigError when the spec names a variable that is not there or measures something else.
    """
    spec = spec or default_spec(results)
    check(spec, {v.name: v for v in results.variables}, "figure")
    with style():
        figure, panels = _panels([_height(p) for p in spec.panels], title or spec.title or _title(results))
        clock = _Clock.of(results)
        limit = _points_per_line(sum(len(p.signals) for p in spec.panels))
        if spec.shade is not None:
            _draw_states(panels, results, spec.shade, clock)
        for axes, panel in zip(panels, spec.panels, strict=True):
            _draw_panel(axes, results, panel, clock, limit)
        _finish(figure, panels, clock, spec.note)
        return figure


def draw_comparison(
    a: Results, b: Results, names: Sequence[str] | None = None, labels: tuple[str, str] = ("a", "b")
) -> Figure:
    """Two runs over each other, and beside that b - a; a row for each variable: those named, or the six that
    differ most.

    Raises ConfigError when the runs have no variable in common, or one is named that they have not.
    """
    from ..results.compare import compare, worst

    if names is None:
        names = worst(compare(a, b).rows, MAX_PANELS)
    if not names:
        raise ConfigError("the two results have no variable in common that can be compared")
    with style():
        figure, panels = _grid(
            len(names), 2, 1.9 * len(names) + 1.3, _comparison_title(a, b), True, None, _OVERLAY
        )
        clock = _Clock.of(a, b)
        limit = _points_per_line(3 * len(names))
        looks = (_Look(COLORS[0], _DASHES[0], 2.6), _Look(COLORS[1], _DASHES[1], 1.2))
        for (axes, beside), name in zip(panels, names, strict=True):
            unit = a.variable(name).unit or b.variable(name).unit
            for results, label, look in zip((a, b), labels, looks, strict=True):
                _draw_signal(axes, results, SignalSpec(name=name, label=label), unit, clock, limit, look)
            _fit_axis(axes)
            _label_axis(axes, name, unit)
            _draw_difference(beside, a, b, name, unit, clock, limit)
        handles, shown = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, shown, loc="outside lower center", ncols=2)
        panels[0, 1].set_title("second run minus first", fontsize=10)
        for column in (0, 1):
            _finish(figure, list(panels[:, column]), clock, None)
        return figure


def _comparison_title(a: Results, b: Results) -> str:
    titles = [_title(a), _title(b)]
    return titles[0] if titles[0] == titles[1] else " and ".join(filter(None, titles))


def _draw_difference(
    axes: Axes, a: Results, b: Results, name: str, unit: str, clock: _Clock, limit: int
) -> None:
    from ..results.compare import difference

    times, values = difference(a, b, name)
    keep = thinned(values, limit)
    held = a.variable(name).held
    axes.plot(
        clock.scale * times[keep],
        values[keep],
        color=COLORS[3],
        linewidth=0.6 if _is_band(values[keep]) else 1.0,
        drawstyle="steps-post" if held else "default",
    )
    _fit_axis(axes)
    axes.set_ylabel(f"[{pretty(unit)}]" if unit else "")


def save(figure: Figure, folder: Path, stem: str = "figure") -> tuple[Path, Path]:
    """Write STEM.png (1440 pixels wide) and STEM.svg into a folder; equal figures give equal bytes.

    Raises ConfigError when a file cannot be written.
    """
    paths = (Path(folder) / f"{stem}.png", Path(folder) / f"{stem}.svg")
    for path in paths:
        write(figure, path)
    return paths


def write(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the name of the file ends in. Raises ConfigError."""
    kind = path.suffix.removeprefix(".").lower()
    known = figure.canvas.get_supported_filetypes()
    if kind not in known:
        raise ConfigError(
            f"{path}: '{kind}' is not a format of figures; use one of {', '.join(sorted(known))}"
        )
    dated = {"svg": "Date", "pdf": "CreationDate", "png": "Software"}
    metadata = {dated[kind]: None} if kind in dated else None
    with style(), replacing(path) as file:
        figure.savefig(file, format=kind, metadata=metadata)


@contextlib.contextmanager
def canvas(
    rows: int = 1,
    columns: int = 1,
    *,
    height: float = 3.0,
    title: str = "",
    share_x: bool = False,
    ratios: Sequence[float] | None = None,
) -> Iterator[tuple[Figure, NDArray[Any]]]:
    """An empty figure in the style of all others, for charts that are not over time.

    Gives the figure and its axes, shape (rows, columns); draw inside the `with` block. `height` is that of
    a row in inches, or with `ratios` of the rows their mean; the width is always the same.
    """
    with style():
        yield _grid(rows, columns, height * rows + (0.5 if title else 0.2), title, share_x, ratios)


def _grid(
    rows: int,
    columns: int,
    tall: float,
    title: str,
    share_x: bool,
    ratios: Sequence[float] | None,
    widths: Sequence[float] | None = None,
) -> tuple[Figure, NDArray[Any]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, tall), layout="constrained")
    axes = figure.subplots(
        rows, columns, squeeze=False, sharex=share_x, height_ratios=ratios, width_ratios=widths
    )
    if title:
        figure.suptitle(title, fontsize=12, fontweight="bold")
    return figure, axes


def look(i: int) -> dict[str, Any]:
    """Color and dashes of the i-th line of a chart: told apart in black and white too."""
    return {"color": COLORS[i % len(COLORS)], "linestyle": _DASHES[i % len(_DASHES)], "linewidth": 1.7}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """matplotlib's own defaults with ours on top, whatever the user's matplotlibrc says."""
    from matplotlib.style import context

    with context(["default", _RC]):
        yield


def _panels(heights: list[float], title: str) -> tuple[Figure, list[Axes]]:
    figure, axes = _grid(len(heights), 1, 1.9 * sum(heights) + 1.1, title, True, heights)
    return figure, list(axes[:, 0])


def _height(panel: PanelSpec) -> float:
    return max(1.0, 0.12 * len(panel.signals) + 0.2)  # so that the legend fits beside the panel


def _title(results: Results) -> str:
    parts = [results.manifest.get(key) for key in ("system", "scenario")]
    return " · ".join(part for part in parts if isinstance(part, str))


@dataclasses.dataclass(frozen=True)
class _Clock:
    """The time axis: `scale` from seconds to its `unit`, and its ends in that unit."""

    scale: float
    unit: str
    begin: float
    end: float

    @classmethod
    def of(cls, *runs: Results) -> _Clock:
        times = [t for run in runs if len(run) for t in run.span] or [0.0]
        begin, end = min(times), max(times)
        scale, unit = (1.0 / 60.0, "min") if end - begin > _MINUTES else (1.0, "s")
        return cls(scale, unit, scale * begin, scale * end)


def _points_per_line(lines: int) -> int:
    return max(300, min(4000, _POINTS // max(1, lines)))


def _draw_panel(axes: Axes, results: Results, panel: PanelSpec, clock: _Clock, limit: int) -> None:
    named = {signal.style for signal in panel.signals}
    free = [look for name, look in _STYLES.items() if name not in named] + list(_DASHES[len(_STYLES) :])
    unused = itertools.cycle(free)  # so that no other line of the panel looks like one with a named style
    for place, signal in enumerate(panel.signals):
        dashes = _STYLES[signal.style] if signal.style else next(unused)
        _draw_signal(axes, results, signal, panel.unit, clock, limit, _Look.of(place, dashes))
    shown = {(v.type, v.items) for signal in panel.signals for v in [results.variable(signal.name)]}
    if len(shown) == 1:
        kind, states = next(iter(shown))
        states = ((0, "false"), (1, "true")) if kind == "Boolean" else states
        if states:
            axes.set_yticks([value for value, _ in states], [name for _, name in states])
    if panel.limits is None:
        _fit_axis(axes)
    else:
        axes.set_ylim(*panel.limits)
    _label_axis(axes, panel.label, panel.unit)
    _add_legend(axes)


@dataclasses.dataclass(frozen=True)
class _Look:
    """What tells a line from its neighbors: color, dash pattern and width in points."""

    color: str
    dashes: Any
    width: float

    @classmethod
    def of(cls, place: int, dashes: Any) -> _Look:
        # the first line is the widest: one that the next ones cover is seen on both sides of them
        return cls(COLORS[place % len(COLORS)], dashes, max(1.1, 2.2 - 0.35 * place))


def _draw_signal(
    axes: Axes, results: Results, signal: SignalSpec, unit: str, clock: _Clock, limit: int, look: _Look
) -> None:
    variable = results.variable(signal.name)
    convert = panel_conversion(variable, unit, "figure")
    held = variable.held if signal.step is None else signal.step
    # a step has two points for each value
    time, values = _drawn(results, signal.name, limit // 2 if held else limit)
    label = signal.label or signal.name
    if not variable.unit and unit not in ("", "1"):
        label += " (no unit declared)"
    axes.plot(
        clock.scale * time,
        convert.scale * values + convert.offset,
        color=look.color,
        linestyle=look.dashes,
        linewidth=signal.weight or (0.6 * look.width if _is_band(values) else look.width),
        drawstyle="steps-post" if held else "default",
        label=broken(label, 26),
    )


def _is_band(values: Array) -> bool:
    """Whether a line goes up and down so often that it fills an area: thin, it shows what lies behind."""
    with np.errstate(invalid="ignore"):
        way, span = float(np.sum(np.abs(np.diff(values)))), float(np.ptp(values)) if len(values) else 0.0
    return span > 0.0 and way > 60.0 * span


def _drawn(results: Results, name: str, limit: int) -> tuple[Array, Array]:
    """Times and values of a variable, thinned; one piece of a long run is in memory at a time."""
    width = _width(len(results), limit)
    times, kept = [np.empty(0)], [np.empty(0)]
    for time, values in results.pieces([name], rows=width * max(1, PIECE // width)):
        at = _extremes(values[:, 0], width)
        times.append(time[at])
        kept.append(values[at, 0])
    return np.concatenate(times), np.concatenate(kept)


def thinned(values: Array, limit: int) -> NDArray[np.intp]:
    """The indices of about `limit` values that draw the same picture.

    In each of limit/2 equal stretches the smallest and the largest value stay, in their order in time, so
    that a spike of one sample survives. The first and the last value always stay.
    """
    return _extremes(values, _width(len(values), limit))


def _width(n: int, limit: int) -> int:
    """How many values a stretch has of which two are drawn; 1 where all are."""
    return 1 if n <= limit else math.ceil(n / max(1, limit // 2))


def _extremes(values: Array, width: int) -> NDArray[np.intp]:
    n = len(values)
    if width == 1:
        return np.arange(n)
    whole = n - n % width
    blocks = values[:whole].reshape(-1, width)
    begin = np.arange(0, whole, width)
    keep = [begin + blocks.argmin(axis=1), begin + blocks.argmax(axis=1), np.array([0, n - 1])]
    if whole < n:
        keep.append(whole + np.array([values[whole:].argmin(), values[whole:].argmax()]))
    return np.unique(np.concatenate(keep))


def _label_axis(axes: Axes, label: str, unit: str) -> None:
    shown = f"[{pretty(unit)}]" if unit else ""
    wrapped = broken(label, 24)
    axes.set_ylabel(f"{wrapped}\n{shown}" if len(label) > 14 and shown else f"{wrapped} {shown}".strip())


def broken(text: str, width: int) -> str:
    """A text on lines of at most `width` characters: broken after spaces, then after the dots and slashes of
    names, then after their other marks. What has none of them stays longer."""
    lines = [""]
    for word in text.split():
        for i, part in enumerate(_parts(word, width)):
            gap = " " if i == 0 and lines[-1] else ""
            if lines[-1] and len(lines[-1]) + len(gap) + len(part) > width:
                lines.append(part)
            else:
                lines[-1] += gap + part
    return "\n".join(lines)


def _parts(word: str, width: int, marks: tuple[str, ...] = (r"./\\", "_-")) -> list[str]:
    if len(word) <= width or not marks:
        return [word]
    parts = re.findall(f"[^{marks[0]}]*[{marks[0]}]+|[^{marks[0]}]+", word)
    return [piece for part in parts for piece in _parts(part, width, marks[1:])]


def _fit_axis(axes: Axes) -> None:
    """Limits with room around all lines; a constant in the middle, its rounding errors not blown up."""
    drawn = [np.asarray(line.get_ydata(), dtype=np.float64) for line in axes.get_lines()]
    values = np.concatenate([y[np.isfinite(y)] for y in drawn])
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    size = max(abs(low), abs(high))
    room = 0.07 * (high - low) if high - low > 1e-6 * size else 0.1 * size or 1.0
    axes.set_ylim(low - room, high + room)


def _add_legend(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def pretty(unit: str) -> str:
    """A unit's name as print has it: m/s2 as m/s², N.m as N·m."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda m: m[0].translate(raised), unit).replace(".", "·")


def _draw_states(panels: list[Axes], results: Results, name: str, clock: _Clock) -> None:
    from matplotlib.patches import Patch

    time, values = _course(results, name)
    handles = [Patch(visible=False, label=f"{name}:")]
    for place, (value, text) in enumerate(results.variable(name).items):
        face = _SHADES[place % len(_SHADES)]
        hatch = "///" if place >= len(_SHADES) else None
        spans = [(clock.scale * a, clock.scale * (b - a)) for a, b in _spans(time, values, value)]
        for axes in panels if spans else []:
            bars = axes.broken_barh(spans, (0.0, 1.0), transform=axes.get_xaxis_transform())
            bars.set(facecolor=face, hatch=hatch, edgecolor="#C0C0C0", linewidth=0.0, zorder=0.1)
        handles.append(Patch(facecolor=face, hatch=hatch, edgecolor="#808080", linewidth=0.6, label=text))
    legend = panels[0].legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=min(7, len(handles)),
        handlelength=1.8,
        columnspacing=1.6,
    )
    panels[0].add_artist(legend)  # beside the legend of the lines, which would replace it
    legend.set_clip_on(False)  # the layout makes room for what is not clipped


def _course(results: Results, name: str) -> tuple[Array, Array]:
    """Times and values of a held variable: at the start, wherever it changes, and at the end.

    More than _SPANS changes would not be seen: then the state at each of as many equal distances counts.
    """
    times, kept, count = [np.empty(0)], [np.empty(0)], 0
    for time, values in results.pieces([name], overlap=1):
        x = values[:, 0]
        at = np.flatnonzero(x[1:] != x[:-1]) + 1
        count += len(at)
        if count > _SPANS:
            rows = np.linspace(0, len(results) - 1, _SPANS).astype(np.intp).tolist()
            few = [next(results.pieces([name], first=k, rows=1)) for k in rows]
            return np.concatenate([t for t, _ in few]), np.concatenate([v[:, 0] for _, v in few])
        at = at if len(times) > 1 else np.insert(at, 0, 0)
        times.append(time[at])
        kept.append(x[at])
    if len(results) > 1:
        times.append(time[-1:])
        kept.append(x[-1:])
    return np.concatenate(times), np.concatenate(kept)


def _spans(time: Array, values: Array, value: float) -> list[tuple[float, float]]:
    """The stretches [t_k, t_j) of a variable's course in which it has this value."""
    inside = np.concatenate(([False], values[:-1] == value, [False]))  # the last value lasts no time
    edges = np.flatnonzero(inside[1:] != inside[:-1])
    spans = [(float(time[a]), float(time[b])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return [(a, b) for a, b in spans if a < b]  # a change at the end stands there twice


def _finish(figure: Figure, panels: list[Axes], clock: _Clock, note: str | None) -> None:
    panels[-1].set_xlabel(f"time [{clock.unit}]")
    if clock.end > clock.begin:
        panels[-1].set_xlim(clock.begin, clock.end)
    if note:
        figure.supxlabel(
            "\n".join(textwrap.wrap(note, 130)), x=0.01, ha="left", fontsize=8.5, color="#505050"
        )
    figure.align_ylabels(panels)
