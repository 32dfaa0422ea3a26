"""A panel of a figure over time: lines in one unit of measure, their axis and their legend."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..results.results import Results
from ..system.figure_spec import PanelSpec
from ..visible import on_one_line
from .axes import TimeAxis, fit_value_axis, label_value_axis
from .lines import draw_signal
from .style import DASHES, NAMED_DASHES, Stroke

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def panel_height(panel: PanelSpec) -> float:
    """Return how tall a panel is, 1 for the usual one, so that the legend fits beside it."""
    return max(1.0, 0.12 * len(panel.signals) + 0.2)


def draw_panel(axes: Axes, results: Results, panel: PanelSpec, time_axis: TimeAxis, limit: int) -> None:
    """Draw the signals of a panel, of about `limit` points each. Raises ConfigError as `draw_signal` does."""
    for signal, stroke in zip(panel.signals, strokes(panel), strict=True):
        draw_signal(axes, results, signal, panel.unit, time_axis, limit, stroke)
    _name_states(axes, results, panel)
    if panel.limits is None:
        fit_value_axis(axes)
    else:
        axes.set_ylim(*panel.limits)
    label_value_axis(axes, panel.label, "" if _counts(results, panel) else panel.unit)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)


def _counts(results: Results, panel: PanelSpec) -> bool:
    """Return whether a panel shows numbers of things, whose unit 1 nobody writes, and no ratio."""
    kinds = {results.variable(signal.name).type for signal in panel.signals}
    return panel.unit == "1" and not kinds & {"Real", "Float32", "Float64"}


def strokes(panel: PanelSpec) -> list[Stroke]:
    """Return the strokes of a panel's lines, in their order."""
    unused = _unnamed_dashes(panel)
    return [
        Stroke.of(place, NAMED_DASHES[signal.style] if signal.style else next(unused))
        for place, signal in enumerate(panel.signals)
    ]


def _unnamed_dashes(panel: PanelSpec) -> Iterator[Any]:
    """Yield, without end, dash patterns that no signal of the panel has by name: no two lines look alike."""
    named = {signal.style for signal in panel.signals}
    free = [dashes for name, dashes in NAMED_DASHES.items() if name not in named]
    return itertools.cycle(free + list(DASHES[len(NAMED_DASHES) :]))


def _name_states(axes: Axes, results: Results, panel: PanelSpec) -> None:
    """Put the names of states at the left where all signals have the same ones."""
    shown = {(v.type, v.items) for signal in panel.signals for v in [results.variable(signal.name)]}
    if len(shown) == 1:
        kind, states = next(iter(shown))
        states = ((0, "false"), (1, "true")) if kind == "Boolean" else states
        if states:
            axes.set_yticks([value for value, _ in states], [on_one_line(name) for _, name in states])
