"""A signal as a line over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..results.results import Results
from ..row_store import Array
from ..system.figure_spec import SignalSpec
from ..units.measure import Affine
from .axes import TimeAxis
from .check import panel_conversion
from .style import Stroke
from .text import broken
from .thinning import thinned_variable

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Drawing(NamedTuple):
    """A signal as a line: the map to the unit of its panel, True if it is held, and its label."""

    convert: Affine
    held: bool
    label: str


def drawing_of(results: Results, signal: SignalSpec, unit: str) -> Drawing:
    """Return how a signal is drawn in a panel's `unit`.

    Raises ConfigError for a variable that there is not, or that measures something else.
    """
    variable = results.variable(signal.name)
    label = signal.label or signal.name
    if not variable.unit and unit not in ("", "1"):
        label += " (no unit declared)"
    held = variable.held if signal.step is None else signal.step
    return Drawing(panel_conversion(variable, unit, "figure"), held, label)


def draw_signal(
    axes: Axes,
    results: Results,
    signal: SignalSpec,
    unit: str,
    time_axis: TimeAxis,
    limit: int,
    stroke: Stroke,
) -> None:
    """Draw a signal in the panel's `unit`, of about `limit` points, as steps where it is held.

    Raises ConfigError as `drawing_of` does.
    """
    convert, held, label = drawing_of(results, signal, unit)
    # a step has two points for each value
    time, values = thinned_variable(results, signal.name, limit // 2 if held else limit)
    axes.plot(
        time_axis.scale * time,
        convert.scale * values + convert.offset,
        color=stroke.color,
        linestyle=stroke.dashes,
        linewidth=signal.weight or (0.6 * stroke.width if is_band(values) else stroke.width),
        drawstyle="steps-post" if held else "default",
        label=broken(label, 26),
    )


def is_band(values: Array) -> bool:
    """Return True if a line through the values, shape (n,), goes up and down so often that it fills an area.

    Drawn thin, it shows what lies behind.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        way, span = float(np.sum(np.abs(np.diff(values)))), float(np.ptp(values)) if len(values) else 0.0
    return span > 0.0 and way > 60.0 * span
