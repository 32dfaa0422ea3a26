"""Two runs on one page: over each other and their difference, and what differs in how they were made."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import ConfigError
from ..figures.axes import TimeAxis
from ..figures.check import panel_conversion
from ..figures.default_figure import MAX_PANELS
from ..figures.style import COLORS, DASHES, Stroke
from ..figures.text import pretty
from ..results.compare import Comparison, difference, worst
from ..results.results import Results
from ..results.variable import ResultVariable
from ..writing import write_text
from . import facts
from .charts import Event, element
from .columns import Columns
from .manifest_facts import items_of, shown
from .markup import block, escaped, folded, section, table
from .page import page
from .panels import line_data, panel_data, signal_data
from .recorded import Codes, Recorded, array_column, recorded

_STROKES = (Stroke(COLORS[0], DASHES[0], 2.6), Stroke(COLORS[1], DASHES[1], 1.4))
_MADE = (
    "evcosim",
    "versions",
    "system",
    "scenario",
    "experiment",
    "ideal",
    "order",
    "units",
    "buses",
    "events",
)
_ROWS = 20  # of a table that is not folded

Labels = tuple[str, str]
"""The names of the two runs."""


def write_comparison(
    path: Path, found: Comparison, a: Results, b: Results, labels: Labels, names: Sequence[str] | None = None
) -> None:
    """Write the page of a comparison, with panels for the named variables, or the six that differ most.

    Raises ConfigError where the file cannot be written.
    """
    write_text(path, comparison(found, a, b, labels, names))


def comparison(
    found: Comparison, a: Results, b: Results, labels: Labels, names: Sequence[str] | None = None
) -> str:
    """Return the page of a comparison as HTML."""
    about = (facts.plain(a.manifest), facts.plain(b.manifest))
    title = f"{labels[0]} and {labels[1]}"
    return page(
        title,
        f"<header><h1>{escaped(title)}</h1></header>{block(found.summary())}",
        *(_warned(label, each) for label, each in zip(labels, about, strict=True)),
        _panels(found, (a, b), labels, about, names),
        _differences(found),
        _metrics(labels, about),
        _made(labels, about),
        section("Do them again", *(block(shown(each["command"])) for each in about if "command" in each)),
    )


def _warned(label: str, about: Mapping[str, Any]) -> str:
    """Return what a reader has to know of a run before anything else; "" for nothing."""
    if not (about.get("warnings") or about.get("error") or about.get("status") not in (None, "done")):
        return ""
    return f"<h2>{escaped(label)}</h2>{facts.first_of_all(about)}"


def _panels(
    found: Comparison,
    runs: tuple[Results, Results],
    labels: Labels,
    about: Sequence[Mapping[str, Any]],
    names: Sequence[str] | None,
) -> str:
    """Return both runs over each other, and below each panel the second minus the first."""
    if not all(len(run) for run in runs):
        return "<p>One of the runs recorded no row.</p>"
    first, second = runs
    drawn = list(worst(found.rows, MAX_PANELS) if names is None else names)
    columns, codes = Columns(), Codes()
    kept = [recorded(run, [name for name in drawn if name in run], columns, codes) for run in runs]
    panels = []
    for name in drawn:
        panels.append(_both(name, runs, kept, labels))
        if name in first.names and name in second.names:
            panels += _apart(first, second, name, columns)
    every = dict.fromkeys(name for run in runs for name in (*run.names, *run.texts))
    return element(
        TimeAxis.of(*runs),
        columns,
        panels=panels,
        signals=[_both(name, runs, kept, labels) for name in every],
        events=_events(labels, about),
        said=[f"{label}: {each.said}" for label, each in zip(labels, kept, strict=True)],
    )


def _described(run: Results, name: str) -> ResultVariable | None:
    known = (v for v in (*run.variables, *run.text_table.variables) if v.name == name)
    return next(known, None)


def _both(
    name: str, runs: tuple[Results, Results], kept: Sequence[Recorded], labels: Labels
) -> dict[str, Any]:
    """Return the panel of a variable in both runs, in its unit in the first that has one.

    What measures something else there, or is text on one side, is left out of the panel.
    """
    described = [_described(run, name) for run in runs]
    main = next(v for v in described if v is not None)
    unit = next((v.unit for v in described if v is not None and v.unit), "")
    lines = []
    for variable, each, label, stroke in zip(described, kept, labels, _STROKES, strict=True):
        if variable is None or (variable.type == "String") != (main.type == "String"):
            continue
        try:
            convert = panel_conversion(variable, unit, "comparison")
        except ConfigError:
            continue
        line = line_data(each.columns[name], label, variable.held, stroke)
        lines.append(line | {"scale": convert.scale, "offset": convert.offset})
    items = next((each.items[name] for each in reversed(kept) if each.items.get(name)), ())
    panel = signal_data(main, lines, items)
    return panel | {"unit": panel_data("", unit, [], ())["unit"]}


def _apart(first: Results, second: Results, name: str, columns: Columns) -> list[dict[str, Any]]:
    """Return the panel of the second run minus the first; none where they measure different quantities."""
    try:
        times, values = difference(first, second, name)
    except ConfigError:
        return []
    if not len(times):
        return []
    number = array_column(columns, times, values)
    variable = first.variable(name)
    line = line_data(number, "second minus first", variable.held, Stroke(COLORS[3], DASHES[0], 1.2))
    return [panel_data(f"{name}: difference", variable.unit or second.variable(name).unit, [line], ())]


def _events(labels: Labels, about: Sequence[Mapping[str, Any]]) -> list[Event]:
    """Return the events of both runs; where they have the same ones, those."""
    both = [facts.events_of(each) for each in about]
    if both[0] == both[1]:
        return both[0]
    return [
        (time, f"{label}: {text}") for label, some in zip(labels, both, strict=True) for time, text in some
    ]


def _differences(found: Comparison) -> str:
    headers, rows = found.table(all_rows=False)
    printed = [(name, pretty(unit), *rest) for name, unit, *rest in rows]
    made = table((*headers[:-1], "judged"), printed, right=headers[2:6])
    return section("What differs", made if len(rows) <= _ROWS else folded(f"{len(rows)} variables", made))


def _metrics(labels: Labels, about: Sequence[Mapping[str, Any]]) -> str:
    """Return the metrics of both runs beside each other."""
    both = [dict(facts.kept_metrics(each)) for each in about]
    names = dict.fromkeys(name for each in both for name in each)
    rows = [(name, *(each.get(name, "") for each in both)) for name in names]
    return section("Metrics", table(("metric", *labels), rows))


def _made(labels: Labels, about: Sequence[Mapping[str, Any]]) -> str:
    """Return what differs between the manifests, but for what came out of the runs."""
    flat = [dict(_flat("", {key: each.get(key) for key in _MADE})) for each in about]
    keys = dict.fromkeys(key for each in flat for key in each)
    rows = [
        (key, flat[0].get(key, ""), flat[1].get(key, ""))
        for key in keys
        if flat[0].get(key, "") != flat[1].get(key, "")
    ]
    made = table(("", *labels), rows)
    nothing = "<p>Nothing that run.json tells.</p>" if all(about) else ""
    whole = made if len(rows) <= _ROWS else folded(f"{len(rows)} entries", made)
    return section("What differs in how they were made", whole or nothing)


def _flat(place: str, value: Any) -> list[tuple[str, str]]:
    """Return the values in an object by their dotted keys, as texts."""
    if isinstance(value, Mapping):
        return [pair for key, inner in items_of(value) for pair in _flat(f"{place}.{key}".lstrip("."), inner)]
    if isinstance(value, list):
        return [(place, json.dumps(value, ensure_ascii=False))]
    return [(place, shown(value))]
