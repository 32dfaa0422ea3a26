"""The curves of a drawn chart as panels of a page: what is over time in it can be zoomed into."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from ..figures.axes import TimeAxis
from ..figures.style import COLORS, DASHES, Stroke
from ..row_store import Array
from .charts import element
from .columns import Columns
from .panels import line_data, panel_data
from .recorded import array_column

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_LABEL = re.compile(r"time \[s\]")
_WITH_UNIT = re.compile(r"(?s)(.*?)\s*\[([^\[\]]+)\]\s*")  # "speed [m/s]"


def redrawn(figure: Figure) -> str:
    """Return the lines of a figure as panels in HTML, one for each axes; "" where one is not over time.

    A panel begins with the part of the time that the figure shows. What is no line is left out. Panels stand
    below each other: each has the title of its column and the label of its row.
    """
    axes = [each for each in figure.axes if _curves(each)]
    if not axes or not all(_over_time(each, axes) for each in axes):
        return ""
    columns = Columns()
    times = np.concatenate([_numbers(line.get_xdata()) for each in axes for line in _curves(each)])
    if not len(times):
        return ""
    whole = TimeAxis(1.0, "s", float(times.min()), float(times.max()))
    panels = [_panel(each, figure.axes, whole, columns) for each in axes]
    low, high = (float(end) for end in axes[-1].get_xlim())
    shown = (max(low, whole.begin), min(high, whole.end))
    return element(whole, columns, panels=panels, signals=[], shown=shown if shown[0] < shown[1] else None)


def _curves(axes: Axes) -> list[Line2D]:
    """Return the curves of a chart; a line of two points is a mark."""
    return [line for line in axes.get_lines() if len(_numbers(line.get_xdata())) > 2]


def _over_time(axes: Axes, all_axes: list[Axes]) -> bool:
    """Return True where a chart has the time below it, or below one that shares its axis."""
    shared = axes.get_shared_x_axes()
    return any(_LABEL.fullmatch(other.get_xlabel()) for other in all_axes if shared.joined(axes, other))


def _numbers(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def _panel(axes: Axes, all_axes: list[Axes], whole: TimeAxis, columns: Columns) -> dict[str, Any]:
    above, beside = _texts(axes, all_axes)
    found = _WITH_UNIT.fullmatch(beside)
    label, unit = found.groups() if found else (beside, "")
    title = ": ".join(text for text in (above, label.strip()) if text)
    curves = [(line, _numbers(line.get_xdata()), _numbers(line.get_ydata())) for line in _curves(axes)]
    ends = np.array([whole.begin, whole.end])
    levels = [(line, ends, _numbers(line.get_ydata())) for line in _levels(axes)]
    lines = [
        line_data(
            array_column(columns, times, values),
            _name(line),
            line.get_drawstyle() == "steps-post",
            _stroke(line),
        )
        for line, times, values in curves + levels
    ]
    low, high = (float(end) for end in axes.get_ylim())
    given = not axes.get_autoscaley_on() and low < high
    return panel_data(title, "" if unit == "1" else unit, lines, (), (low, high) if given else None)


def _texts(axes: Axes, all_axes: list[Axes]) -> tuple[str, str]:
    """Return the text above the column of a chart, and that beside its row: its own ones, if it has them."""
    place = axes.get_subplotspec()
    above, beside = axes.get_title(), axes.get_ylabel()
    for other in all_axes:
        there = other.get_subplotspec()
        if place is None or there is None:
            continue
        if there.colspan == place.colspan and there.rowspan.start <= place.rowspan.start:
            above = above or other.get_title()
        if there.rowspan == place.rowspan and there.colspan.start <= place.colspan.start:
            beside = beside or other.get_ylabel()
    return above, beside


def _levels(axes: Axes) -> list[Line2D]:
    """Return the lines across a whole chart that have a name."""
    return [
        line
        for line in axes.get_lines()
        if _name(line)
        and list(_numbers(line.get_xdata())) == [0.0, 1.0]
        and len(set(_numbers(line.get_ydata()))) == 1
    ]


def _name(line: Line2D) -> str:
    text = str(line.get_label())
    return "" if text.startswith("_") else text


def _stroke(line: Line2D) -> Stroke:
    """Return the stroke of a line; its dashes are those of its color, as in all our charts."""
    from matplotlib.colors import to_hex

    color = to_hex(line.get_color()).upper()
    dashes = DASHES[COLORS.index(color)] if color in COLORS and line.is_dashed() else "solid"
    return Stroke(color, dashes, line.get_linewidth())
