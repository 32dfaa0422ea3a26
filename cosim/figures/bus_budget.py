"""The figure of a bus budget: the metric over each variation, the limit, and what is broken."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING

from ..analysis.bus_budget import Budget, Point, Series
from ..can.bus_settings import BusVariation
from ..visible import flowing, on_one_line, visible
from .canvas import canvas
from .style import COLORS
from .text import pretty

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HOLDS, _BROKEN, _FAILED, _SHADE = COLORS[0], COLORS[1], COLORS[3], "#FBE3C0"
_COLUMNS = 3
_ROOM = 5.0  # what lies farther from the limit than so many times the nominal point is off the scale


def draw_budget(budget: Budget) -> Figure:
    """Draw a panel for each series, over one scale: the limit dashed, the side beyond it shaded and hatched.

    A point that holds is a disk, a broken one a cross; one off the scale or without a value is a triangle at
    the edge, with its value or "no value"; one whose run failed is a black square there, "failed". The
    nominal point has a ring; of several seeds the worst is the point, and each has a dash.
    """
    name = " ".join(part for part in (budget.system, budget.scenario) if part)
    count = len(budget.series)
    columns = min(count, _COLUMNS)
    rows = -(-count // columns)
    with canvas(rows, columns, height=4.2, title=f"Bus budget of {name}") as (figure, axes):
        low, high = _scale(budget)
        panels = axes.ravel()
        for panel in panels[count:]:
            panel.set_axis_off()
        for panel, each in zip(panels, budget.series, strict=False):
            panel.set_ylim(low, high)
            _draw_limit(panel, budget, low, high)
            _draw_points(panel, budget, each, low, high)
            _label(panel, budget, each)
        for panel in axes[:, 1:].ravel():
            panel.tick_params(labelleft=False)
        unit = f" [{pretty(budget.unit)}]" if budget.unit not in ("", "1") else ""
        for panel in axes[:, 0]:
            panel.set_ylabel("\n".join(textwrap.wrap(f"{flowing(budget.metric)}{unit}", 44)))
        # one of each; not every panel has several seeds
        found: dict[str, Artist] = {}
        for panel in panels[:count]:
            found.update(
                {label: handle for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)}
            )
        figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=len(found))
        return figure


def _scale(budget: Budget) -> tuple[float, float]:
    """Return the ends of the axis, between which the limit and the points near it have room."""
    points = [point for each in budget.series for point in each.points]
    nominal = next(p.value for p in points if p.bus == BusVariation())
    span = abs(nominal - budget.limit) if math.isfinite(nominal) and nominal != budget.limit else 0.0
    span = span or abs(budget.limit) or 1.0
    seen = [budget.limit, *(p.value for p in points if abs(p.value - budget.limit) <= _ROOM * span)]
    low, high = min(seen), max(seen)
    above, below = (0.35, 0.2) if budget.kind == "max" else (0.2, 0.35)
    return low - below * (high - low or span), high + above * (high - low or span)


def _draw_limit(panel: Axes, budget: Budget, low: float, high: float) -> None:
    begin, end = (budget.limit, high) if budget.kind == "max" else (low, budget.limit)
    shade = panel.axhspan(begin, end, facecolor=_SHADE, edgecolor="#E0C090", hatch="//", linewidth=0.0)
    shade.set(zorder=0.1, label="broken")
    panel.axhline(
        budget.limit, color=COLORS[3], linestyle=(0, (5, 1.5)), linewidth=1.2, label=f"limit {budget.limit:g}"
    )


def _draw_points(panel: Axes, budget: Budget, series: Series, low: float, high: float) -> None:
    shown = [(i, p) for i, p in enumerate(series.points) if low <= p.value <= high]
    panel.plot([i for i, _ in shown], [p.value for _, p in shown], color="#7F7F7F", linewidth=1.0, zorder=2)
    for i, point in enumerate(series.points):
        y, marker = _place(point, budget, low, high)
        color = _FAILED if point.failed else _BROKEN if budget.broken(point) else _HOLDS
        panel.plot([i], [y], marker=marker, color=color, markersize=8.0, linestyle="none", zorder=3)
        if i == series.nominal:
            panel.plot(
                [i], [y], marker="o", markersize=14.0, linestyle="none", markerfacecolor="none",
                markeredgecolor=COLORS[3], zorder=3, label="as it is",
            )  # fmt: skip # where, then how
        inside = [v for v in point.values if low <= v <= high]
        if inside:
            panel.plot(
                [i] * len(inside), inside, marker="_", color=color, markersize=12.0, linestyle="none",
                zorder=3, label="each seed",
            )  # fmt: skip # where, then how
        text = _text(point)
        # not over the edge, and not over the line of the limit, nor a steep one to the next point
        under = y > low + 0.85 * (high - low) or 0.0 <= budget.limit - y < 0.1 * (high - low)
        under = under or any(p.value - y > 0.2 * (high - low) for k, p in shown if abs(k - i) == 1)
        panel.annotate(
            text, (i, y), xytext=(0, -11 if under else 11), textcoords="offset points", ha="center",
            va="top" if under else "bottom", fontsize=8.5, zorder=4,
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
        )  # fmt: skip # where, then how


def _place(point: Point, budget: Budget, low: float, high: float) -> tuple[float, str]:
    """Return the height at which a point is drawn, and its marker."""
    if low <= point.value <= high:
        return point.value, "X" if budget.broken(point) else "o"
    up = budget.kind == "max" if math.isnan(point.value) else point.value > high
    edge = 0.04 * (high - low)
    y = high - edge if up else low + edge
    return y, "s" if point.failed else "^" if up else "v"


def _text(point: Point) -> str:
    if point.failed:
        return "failed"
    return "no value" if math.isnan(point.value) else f"{point.value:.4g}".replace("-", "\N{MINUS SIGN}")


def _label(panel: Axes, budget: Budget, series: Series) -> None:
    panel.set_title(visible(f"{series.name}\n{budget.summary(series)}"), fontsize=10.0)
    panel.set_xticks(
        range(len(series.points)), [_tick(on_one_line(p.label)) for p in series.points], fontsize=9.0
    )
    panel.set_xlim(-0.6, len(series.points) - 0.4)
    panel.grid(visible=False, axis="x")


def _tick(label: str) -> str:
    return label.replace(" (", "\n(").replace("DBC x", "x").replace("jitter ", "jitter\n")
