"""Two runs over each other, and their difference beside that."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..errors import ConfigError
from ..results.compare import compare, difference, worst
from ..results.results import Results
from ..system.figure_spec import SignalSpec
from .axes import TimeAxis, fit_value_axis, label_value_axis
from .canvas import grid
from .default_figure import MAX_PANELS, title_of
from .lines import draw_signal, is_band
from .style import COLORS, DASHES, Stroke, style
from .text import pretty
from .thinning import points_per_line, thinned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTHS = (1.7, 1.0)  # of the runs and of their difference, in proportion
_STROKES = (Stroke(COLORS[0], DASHES[0], 2.6), Stroke(COLORS[1], DASHES[1], 1.2))


def draw_comparison(
    a: Results, b: Results, names: Sequence[str] | None = None, labels: tuple[str, str] = ("a", "b")
) -> Figure:
    """Draw a row for each variable: both runs over each other, and beside that b - a.

    The variables are those named, or the six that differ most. Raises ConfigError when the runs have no
    variable in common, or one is named that they have not.
    """
    if names is None:
        names = worst(compare(a, b).rows, MAX_PANELS)
    if not names:
        raise ConfigError("the two results have no variable in common that can be compared")
    with style():
        figure, panels = grid(
            len(names), 2, 1.9 * len(names) + 1.3, _title(a, b), share_x=True, widths=_WIDTHS
        )
        time_axis = TimeAxis.of(a, b)
        limit = points_per_line(3 * len(names))
        for (axes, beside), name in zip(panels, names, strict=True):
            unit = a.variable(name).unit or b.variable(name).unit
            for results, label, stroke in zip((a, b), labels, _STROKES, strict=True):
                draw_signal(axes, results, SignalSpec(name=name, label=label), unit, time_axis, limit, stroke)
            fit_value_axis(axes)
            label_value_axis(axes, name, unit)
            _draw_difference(beside, a, b, name, unit, time_axis, limit)
        handles, shown = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, shown, loc="outside lower center", ncols=2)
        panels[0, 1].set_title("second run minus first", fontsize=10)
        for column in (0, 1):
            stacked = list(panels[:, column])
            time_axis.finish(stacked)
            figure.align_ylabels(stacked)
        return figure


def _title(a: Results, b: Results) -> str:
    titles = [title_of(a), title_of(b)]
    return titles[0] if titles[0] == titles[1] else " and ".join(filter(None, titles))


def _draw_difference(
    axes: Axes, a: Results, b: Results, name: str, unit: str, time_axis: TimeAxis, limit: int
) -> None:
    times, values = difference(a, b, name)
    keep = thinned(values, limit)
    held = a.variable(name).held
    axes.plot(
        time_axis.scale * times[keep],
        values[keep],
        color=COLORS[3],
        linewidth=0.6 if is_band(values[keep]) else 1.0,
        drawstyle="steps-post" if held else "default",
    )
    fit_value_axis(axes)
    axes.set_ylabel(f"[{pretty(unit)}]" if unit else "")
