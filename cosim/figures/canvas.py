"""Empty figures: panels in rows and columns under a title, always equally wide; and empty drawings.

matplotlib is used through its objects alone: no display, no global state.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from ..visible import visible
from .style import WIDTH, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
    """Give an empty figure in the style of all others, for charts that are not over time.

    Gives the figure and its axes, shape (rows, columns); draw inside the `with` block. `height` is that of
    a row in inches, or with `ratios` of the rows their mean; the width is always the same.
    """
    with style():
        yield grid(rows, columns, height * rows + (0.5 if title else 0.2), title, share_x, ratios)


@contextlib.contextmanager
def drawing(left: float, right: float, bottom: float, top: float) -> Iterator[tuple[Figure, Axes]]:
    """Give an empty drawing without axes, whose coordinates are inches, in the style of the figures.

    Gives the figure, as large as the edges say, and what to draw on inside the `with` block.
    """
    from .shown import ShownFigure

    with style():
        figure = ShownFigure(figsize=(right - left, top - bottom))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(left, right)
        axes.set_ylim(bottom, top)
        axes.autoscale(False)
        yield figure, axes


def grid(
    rows: int,
    columns: int,
    height: float,
    title: str,
    share_x: bool,
    heights: Sequence[float] | None = None,
    widths: Sequence[float] | None = None,
) -> tuple[Figure, NDArray[Any]]:
    """Return a figure of `height` inches and its axes, shape (rows, columns).

    `heights` and `widths` are in proportion to each other; None: all equal.
    """
    from .shown import ShownFigure

    figure = ShownFigure(figsize=(WIDTH, height), layout="constrained")
    axes = figure.subplots(
        rows, columns, squeeze=False, sharex=share_x, height_ratios=heights, width_ratios=widths
    )
    if title:
        figure.suptitle(visible(title), fontsize=12, fontweight="bold")
    return figure, axes
