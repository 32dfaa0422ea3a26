"""A system file as a picture: units in the order of their steps, direct connections above, buses below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..system.system import SystemFile
from .canvas import drawing
from .diagram_content import content_of
from .diagram_layout import BOX, LINE, NAME, TITLE, UNIT, Arc, Box, Drop, laid_out

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK, _PALE, _DIRECT, _BUS = "#1a1a1a", "#505050", "#0072B2", "#D55E00"
_EDGE = 0.12  # inches around the picture


def draw_diagram(system: SystemFile) -> Figure:
    """Draw the units and connections of a system: direct ones as arrows above the units, messages below.

    A connection is named by the sender's variable, `variable → receiver's` where the names differ. The
    picture is as large as its content needs.
    """
    content = content_of(system)
    layout = laid_out(content)
    edges = (layout.left - _EDGE, layout.right + _EDGE, layout.bottom - _EDGE, layout.top + _EDGE)
    with drawing(*edges) as (figure, axes):
        for box, (name, fmu) in zip(layout.boxes, content.units, strict=True):
            _draw_unit(axes, box, name, fmu)
        for arc in layout.arcs:
            _draw_arc(axes, arc)
        for bar, bus in zip(layout.bars, content.buses, strict=True):
            axes.plot([bar.left, bar.right], [bar.y, bar.y], color=_BUS, lw=4, solid_capstyle="round")
            _write(axes, bar.left, bar.y - 0.06, bus.title, "left", size=TITLE, color=_BUS, bold=True)
        for drop in layout.drops:
            _draw_drop(axes, drop)
    return figure


def _write(
    axes: Axes,
    x: float,
    y: float,
    text: str,
    align: str = "center",
    *,
    vertical: str = "top",
    size: float = NAME,
    color: str = _INK,
    bold: bool = False,
) -> None:
    axes.text(
        x,
        y,
        text,
        ha=align,
        va=vertical,
        fontsize=size,
        color=color,
        fontweight="bold" if bold else "normal",
    )


def _draw_unit(axes: Axes, box: Box, name: str, fmu: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    corner = (box.x - box.width / 2.0, -BOX / 2.0)
    style = "round,pad=0,rounding_size=0.05"
    axes.add_patch(
        FancyBboxPatch(corner, box.width, BOX, boxstyle=style, facecolor="#F4F6F8", edgecolor=_INK, lw=1.2)
    )
    _write(axes, box.x, 0.08, name, vertical="center", size=UNIT, bold=True)
    _write(axes, box.x, -0.1, fmu, vertical="center", color=_PALE)


def _draw_arc(axes: Axes, arc: Arc) -> None:
    axes.plot([arc.begin, arc.begin, arc.end], [BOX / 2.0, arc.y, arc.y], color=_DIRECT, lw=1.4)
    _arrow(axes, (arc.end, arc.y), (arc.end, BOX / 2.0), _DIRECT)
    for i, name in enumerate(reversed(arc.names)):
        _write(axes, arc.label, arc.y + 0.03 + LINE * i, name, vertical="bottom")


def _draw_drop(axes: Axes, drop: Drop) -> None:
    high, low = (drop.x, -BOX / 2.0), (drop.x, drop.y)
    _arrow(axes, high, low, _BUS) if drop.sends else _arrow(axes, low, high, _BUS)
    for i, name in enumerate(drop.names):
        aside, align = (-0.05, "right") if drop.sends else (0.05, "left")
        _write(axes, drop.x + aside, drop.top - LINE * i, name, align)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    style = {"arrowstyle": "-|>", "color": color, "lw": 1.4, "shrinkA": 0.0, "shrinkB": 1.5}
    axes.annotate("", xy=end, xytext=start, arrowprops=style)
