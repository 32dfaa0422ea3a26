"""The panels of a page over time: those of a figure, and a panel that each recorded signal can have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..figures.lines import drawing_of
from ..figures.panels import strokes
from ..figures.states import course
from ..figures.style import COLORS, SHADES, Stroke
from ..figures.text import pretty
from ..results.results import Results
from ..results.variable import ResultVariable
from ..system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ..visible import flowing, on_one_line
from .recorded import Items, Recorded

_SPANS = 20_000  # shaded stretches at most


def figure_panels(results: Results, spec: FigureSpec, found: Recorded) -> list[dict[str, Any]]:
    """Return the panels of a figure as data. Raises ConfigError as `drawing_of` does."""
    return [_panel(results, panel, found) for panel in spec.panels]


def _panel(results: Results, panel: PanelSpec, found: Recorded) -> dict[str, Any]:
    lines = [
        _line(results, signal, panel.unit, stroke, found)
        for signal, stroke in zip(panel.signals, strokes(panel), strict=True)
    ]
    names = {found.items[signal.name] for signal in panel.signals}
    title = panel.label or (panel.signals[0].name if len(panel.signals) == 1 else "")
    return panel_data(title, panel.unit, lines, names.pop() if len(names) == 1 else (), panel.limits)


def panel_data(
    title: str,
    unit: str,
    lines: list[dict[str, Any]],
    items: Items,
    limits: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Return a panel as data; `items` name the values of all its lines, `limits` are in its unit."""
    return {
        "title": flowing(title),
        "unit": "" if unit == "1" else pretty(unit),
        "limits": limits,
        "items": items_data(items),
        "lines": lines,
    }


def items_data(items: Items) -> list[tuple[int, str]]:
    """Return the names of values as data."""
    return [(value, on_one_line(name)) for value, name in items]


def _line(results: Results, signal: SignalSpec, unit: str, stroke: Stroke, found: Recorded) -> dict[str, Any]:
    convert, held, label = drawing_of(results, signal, unit)
    line = line_data(found.columns[signal.name], label, held, stroke, signal.weight)
    return line | {"scale": convert.scale, "offset": convert.offset}


def line_data(
    column: int, label: str, held: bool, stroke: Stroke, width: float | None = None
) -> dict[str, Any]:
    """Return a line through a column as data, in its own unit; `width` is in place of the stroke's."""
    width = width or stroke.width
    dashes = () if isinstance(stroke.dashes, str) else stroke.dashes[1]  # "solid", or (0, lengths in widths)
    return {
        "column": column,
        "label": flowing(label),
        "held": held,
        "color": stroke.color,
        "dash": [round(length * width, 2) for length in dashes],
        "width": width,
        "scale": 1.0,
        "offset": 0.0,
    }


def any_signals(results: Results, found: Recorded) -> list[dict[str, Any]]:
    """Return a panel for each variable and text of a run, as data."""
    stroke = Stroke(COLORS[0], "solid", 1.6)
    return [
        signal_data(v, [line_data(found.columns[v.name], v.name, v.held, stroke)], found.items[v.name])
        for v in (*results.variables, *results.text_table.variables)
    ]


def signal_data(variable: ResultVariable, lines: list[dict[str, Any]], items: Items) -> dict[str, Any]:
    """Return the panel of a variable as data, with its description."""
    return panel_data(variable.name, variable.unit, lines, items) | {"about": flowing(variable.description)}


def states_data(results: Results, name: str | None, items: Mapping[str, Items]) -> dict[str, Any] | None:
    """Return the states of an enumeration as data: their colors, and where each begins; None for no name."""
    if name is None:
        return None
    times, values = course(results, name, _SPANS)
    changed = np.concatenate(([True], values[1:] != values[:-1]))
    changed[-1] = True  # the end of the last stretch
    return {
        "name": on_one_line(name),
        "times": times[changed].tolist(),
        "values": [int(value) if np.isfinite(value) else None for value in values[changed]],
        "items": [
            (value, text, SHADES[place % len(SHADES)], place >= len(SHADES))
            for place, (value, text) in enumerate(items_data(items[name]))
        ],
    }
