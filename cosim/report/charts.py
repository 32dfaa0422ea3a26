"""The interactive panels of a run as a part of a page: its HTML, with the numbers in it.

`assets.py` has what a page needs once, however many of these parts stand in it.
"""

from __future__ import annotations

import html
import json
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import ConfigError
from ..figures.axes import TimeAxis
from ..figures.check import check
from ..figures.default_figure import MAX_PANELS, default_spec
from ..figures.end import until
from ..results.results import Results
from ..system.figure_spec import FigureSpec
from ..visible import flowing
from .columns import Columns
from .panels import any_signals, figure_panels, states_data
from .recorded import recorded

Event = tuple[float, str]
"""The time [s] of an event, and the text of its mark."""


def charts(
    results: Results, spec: FigureSpec | None = None, events: Sequence[Event] = (), *, search: bool = True
) -> str:
    """Return the panels of a figure as HTML, with a search for all other signals, or those of it alone.

    Without a spec the figure is that of `default_spec(results)`. Raises ConfigError for a spec that names a
    variable that is not there or measures something else.
    """
    if not len(results):
        return "<p>No row was recorded.</p>"
    if spec is None:
        spec = _default(results)
    else:
        check(spec, {v.name: v for v in (*results.variables, *results.text_table.variables)}, "figure")
    page = Columns()
    panels = spec.panels if spec else []
    drawn = list(dict.fromkeys(signal.name for panel in panels for signal in panel.signals))
    if spec is not None and not search:
        results = results.part(slice(None), list(dict.fromkeys([*drawn, *_others(spec)])))
    found = recorded(results, drawn, page)
    signals = any_signals(results, found)
    end = until(results, spec.until if spec else None).span[1]
    said = [found.said, *([flowing(spec.note)] if spec and spec.note else [])]
    if end < results.span[1]:
        said.append(f"The figure ends at {end:g} s; 'all' shows the run to its end.")
    return element(
        TimeAxis.of(results),
        page,
        panels=figure_panels(results, spec, found) if spec else signals[:MAX_PANELS],
        signals=signals if search else [],
        states=states_data(results, spec.shade if spec else None, found.items),
        events=events,
        said=said,
        shown=(results.span[0], end),
    )


def _others(spec: FigureSpec) -> list[str]:
    """Return the variables that a figure needs beside those of its lines."""
    return [name for name in (spec.shade, spec.until.signal if spec.until else None) if name]


def _default(results: Results) -> FigureSpec | None:
    try:
        return default_spec(results)
    except ConfigError:  # there are texts alone, or parameters
        return None


def element(
    axis: TimeAxis,
    page: Columns,
    *,
    panels: list[dict[str, Any]],
    signals: list[dict[str, Any]],
    states: Mapping[str, Any] | None = None,
    events: Sequence[Event] = (),
    said: Sequence[str] = (),
    shown: tuple[float, float] | None = None,
) -> str:
    """Return panels over a time axis as HTML; `said` are the lines of text below them.

    They show the time from `shown[0]` to `shown[1]` [s] at first (None: all of it).
    """
    part = [axis.begin, axis.end] if shown is None else [axis.scale * end for end in shown]
    ends = {"begin": axis.begin, "end": axis.end, "shown": part}
    data = {
        "time": {"scale": axis.scale, "unit": axis.unit, **ends},
        **page.as_data(),
        "panels": panels,
        "signals": signals,
        "states": states,
        "events": [{"time": time, "text": flowing(text)} for time, text in events],
    }
    notes = "".join(f'<p class="note">{html.escape(text)}</p>' for text in said)
    return (
        '<section class="charts"><p class="wait">This page draws its curves by a script of its own. '
        "The browser has not run it.</p>"
        f'<script type="application/json">{as_json(data)}</script>{notes}</section>'
    )


def as_json(data: Any) -> str:
    """Return data as JSON in ASCII, without a sign that could end the element that it stands in."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
