"""Figures of results: stacked panels over one time axis, shaded by the states of an enumeration.

What a figure shows is a `FigureSpec`, which stands in a system or scenario file or is made from the results
(`default_spec`). The names in `__all__` are what a figure is drawn and written with elsewhere.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from ..results.results import Results
from ..system.figure_spec import FigureSpec
from ..visible import flowing
from .axes import TimeAxis
from .canvas import canvas, grid
from .check import check
from .comparison import draw_comparison
from .default_figure import default_spec, title_of
from .end import until
from .panels import draw_panel, panel_height
from .saving import save, write
from .states import draw_states
from .style import look, style
from .thinning import points_per_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["canvas", "check", "draw", "draw_comparison", "look", "save", "write"]


def draw(results: Results, spec: FigureSpec | None = None, *, title: str | None = None) -> Figure:
    """Draw the figure of some results; without a spec, that of `default_spec(results)`.

    Raises ConfigError when the spec names a variable that is not there or measures something else.
    """
    spec = spec or default_spec(results)
    check(spec, {v.name: v for v in (*results.variables, *results.text_table.variables)}, "figure")
    results = until(results, spec.until)
    heights = [panel_height(panel) for panel in spec.panels]
    with style():
        shown = title or spec.title or title_of(results)
        figure, axes = grid(len(heights), 1, 1.9 * sum(heights) + 1.1, shown, share_x=True, heights=heights)
        panels = list(axes[:, 0])
        time_axis = TimeAxis.of(results)
        limit = points_per_line(sum(len(p.signals) for p in spec.panels))
        if spec.shade is not None:
            draw_states(panels, results, spec.shade, time_axis)
        for panel_axes, panel in zip(panels, spec.panels, strict=True):
            draw_panel(panel_axes, results, panel, time_axis, limit)
        time_axis.finish(panels)
        if spec.note:
            note = "\n".join(textwrap.wrap(flowing(spec.note), 130))
            figure.supxlabel(note, x=0.01, ha="left", fontsize=8.5, color="#505050")
        figure.align_ylabels(panels)
        return figure
