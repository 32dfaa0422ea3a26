"""The look of all figures: colors, dash patterns, and settings of matplotlib.

Colors are those of Okabe and Ito (Color Universal Design, 2008), which color-blind readers distinguish; the
lines of a panel also differ in dash pattern and width, for print in black and white. The user's matplotlibrc
is ignored, so that equal results give equal bytes.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import Any

COLORS = ("#0072B2", "#D55E00", "#009E73", "#000000", "#CC79A7", "#56B4E9", "#E69F00", "#7F7F7F")
DASHES: tuple[Any, ...] = (
    "solid",
    (0, (5, 1.5)),
    (0, (1.2, 1.2)),
    (0, (7, 1.5, 1.2, 1.5)),
    (0, (2.5, 1.5)),
    (0, (9, 3)),
    (0, (4, 1.2, 1.2, 1.2, 1.2, 1.2)),
    (0, (1.2, 3)),
)
NAMED_DASHES = {"solid": DASHES[0], "dashed": DASHES[1], "dotted": DASHES[2], "dashdot": DASHES[3]}
# Backgrounds of the states: pale; the first three differ in gray as well.
SHADES = ("#FFFFFF", "#FBE3C0", "#BBD7EE", "#F3CDE0", "#BFE3CF", "#D9D9D9")

WIDTH = 10.0  # inches; at _DPI 1440 pixels
_DPI = 144

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
    "text.parse_math": False,  # names and units are no formulas, whatever signs stand in them
}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Set matplotlib's own defaults with ours on top, whatever the user's matplotlibrc says."""
    from matplotlib.style import context

    with context(["default", _RC]):
        yield


def look(i: int) -> dict[str, Any]:
    """Return color, dashes and width of the i-th line of a chart, as matplotlib's `plot` takes them."""
    return {"color": COLORS[i % len(COLORS)], "linestyle": DASHES[i % len(DASHES)], "linewidth": 1.7}


@dataclasses.dataclass(frozen=True)
class Stroke:
    """Color, dash pattern and width [points] of a line in a panel over time."""

    color: str
    dashes: Any
    width: float

    @classmethod
    def of(cls, place: int, dashes: Any) -> Stroke:
        """Return the stroke of a panel's line number `place`, from 0."""
        # the first line is the widest: one that the next ones cover is seen on both sides of them
        return cls(COLORS[place % len(COLORS)], dashes, max(1.1, 2.2 - 0.35 * place))
