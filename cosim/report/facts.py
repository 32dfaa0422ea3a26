"""The sections of a page that say how a run was made and what came of it, from its manifest."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from ..errors import counted
from ..figures.text import pretty
from ..results.manifest import described, manifest_text
from ..results.metrics import Metric
from ..results.variable import ResultVariable
from .assets import UPLOT, text
from .diagram import diagram
from .manifest_facts import items_of, records_of, shown, texts_of
from .markup import block, escaped, folded, listed, section, table
from .order import arrivals, reasons

_OF_ONE_RUN = ("loop_seconds", "process")  # differ from run to run; without them equal runs make equal pages

_RULES = {
    "gauss_seidel": "Units step one after the other, in the order of the system file (gauss_seidel). What a "
    "unit sends reaches the units behind it in the same step, and those before it when the next one begins.",
    "jacobi": "All units receive what was there when the step began, whatever their order (jacobi).",
}


def plain(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Return a manifest as run.json has it, without what differs between two equal runs."""
    about: dict[str, Any] = json.loads(manifest_text(manifest, indent=None))
    return {key: value for key, value in about.items() if key not in _OF_ONE_RUN}


def headline(about: Mapping[str, Any], rows: int, span: tuple[float, float]) -> str:
    """Return system, scenario and status as the head of a page; `span` [s] is that of the rows."""
    name = " · ".join(str(about[key]) for key in ("system", "scenario") if about.get(key)) or "results"
    experiment = dict(items_of(about.get("experiment")))
    parts = [f"status: {shown(about.get('status'))}"] if about.get("status") else []
    parts += [f"{span[0]:g} to {span[1]:g} s"] if rows else []
    parts += [f"{rows:,} row{'s' if rows != 1 else ''}"]
    parts += [f"steps of {shown(experiment['step_size'])} s"] if "step_size" in experiment else []
    parts += [shown(experiment[key]) for key in ("algorithm", "engine") if key in experiment]
    parts += ["ideal: no buses"] if about.get("ideal") else []
    parts += [f"evcosim {shown(about['evcosim'])}"] if "evcosim" in about else []
    return f'<header><h1>{escaped(name)}</h1><p class="about">{escaped(", ".join(parts))}</p></header>'


def first_of_all(about: Mapping[str, Any]) -> str:
    """Return what a reader has to know before anything else: the error, a cut run, warnings."""
    found = ""
    if about.get("error"):
        found += f'<div class="error"><strong>The run failed.</strong>{block(shown(about["error"]))}</div>'
    elif about.get("status") in ("interrupted", "killed", "cut off", "running", "stopped"):
        found += (
            f'<div class="error"><strong>The run was not complete: {escaped(about["status"])}.</strong></div>'
        )
    if about.get("ended"):
        found += f'<div class="warnings">{escaped(shown(about["ended"]))}</div>'
    warnings = texts_of(about.get("warnings"))
    if warnings:
        return f'{found}<div class="warnings"><strong>Warnings</strong>{listed(warnings)}</div>'
    return found or '<p class="good">No warnings.</p>'


def metrics_section(metrics: Iterable[Metric], about: Mapping[str, Any]) -> str:
    """Return the numbers of a run, or those that its manifest has."""
    cells = [(m.name, number_with_unit(m.value, m.unit) if m.value == m.value else m.text) for m in metrics]
    return section("Metrics", table(("metric", "value"), cells or kept_metrics(about)))


def kept_metrics(about: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the names of the metrics that a manifest has, and their values with units."""
    return [(name, number_with_unit(*metric)) for name, metric in numbers_of_metrics(about).items()]


def numbers_of_metrics(about: Mapping[str, Any]) -> dict[str, tuple[float | None, str]]:
    """Return the value and the unit of measure of each metric that a manifest has; None for no number."""
    known = {name: dict(items_of(metric)) for name, metric in items_of(about.get("metrics"))}
    return {
        name: (x if isinstance(x := metric.get("value"), int | float) else None, shown(metric.get("unit")))
        for name, metric in known.items()
    }


def number_with_unit(value: float | None, unit: str) -> str:
    """Return the text of a metric; "-" for one without a number."""
    return "-" if value is None else f"{value:.6g} {_unit(unit)}".strip()


def _unit(unit: str) -> str:
    return "" if unit == "1" else pretty(unit)


def buses_section(about: Mapping[str, Any]) -> str:
    """Return saturated signals, and the settings of the buses."""
    if about.get("ideal"):
        return section(
            "Buses", "<p>Left out in this run: values are converted, nothing else happens to them.</p>"
        )
    buses = items_of(about.get("buses"))
    keys = ("dbc", "bitrate", "rounding", "overflow", "delay", "resolution", "cycle")
    heads = ("DBC", "bit/s", "rounding", "overflow", "delay [s]", "resolution", "cycle")
    rows = [(name, *(shown(dict(items_of(settings)).get(key)) for key in keys)) for name, settings in buses]
    settings = table(("bus", *heads), rows, right=("bit/s", "delay [s]", "resolution", "cycle"))
    return section("Saturations", _saturations(about) if buses else "") + section("Buses", settings)


def _saturations(about: Mapping[str, Any]) -> str:
    found = [(signal, dict(items_of(counts))) for signal, counts in items_of(about.get("saturations"))]
    rows = [(signal, shown(counts.get("count")), shown(counts.get("first_time"))) for signal, counts in found]
    if not rows and "saturations" in about:
        return "<p>No signal was saturated.</p>"
    return table(("signal", "times", "first at [s]"), rows, right=("times", "first at [s]"))


def units_section(about: Mapping[str, Any]) -> str:
    """Return the units in the order of their steps, why, and what connects them."""
    units = {name: dict(items_of(unit)) for name, unit in items_of(about.get("units"))}
    why = reasons(about)
    rows = [
        (
            f"{i} {name}",
            shown(units.get(name, {}).get("fmu")),
            _steps(units.get(name, {})),
            {"process": "its own", "none": "evcosim's"}.get(shown(units.get(name, {}).get("isolation")), ""),
            why.get(name, ""),
        )
        for i, name in enumerate(texts_of(about.get("order")), 1)
    ]
    algorithm = shown(dict(items_of(about.get("experiment"))).get("algorithm"))
    rule = _RULES.get(algorithm, "")
    ways = [
        (a, b, via or "direct", when, _delay(about, via, b.partition(".")[0]))
        for a, b, via, when in arrivals(about)
    ]
    return section(
        "Units, in the order in which they step",
        f"<p>{escaped(rule)}</p>" if rule and rows else "",
        table(("unit", "FMU", "every", "process", "receives from"), rows),
        diagram(about),
        folded(
            f"{len(ways)} connections",
            table(("from", "to", "over", "arrives", "sampled until used [ms]"), ways),
        )
        if ways
        else "",
    )


def _delay(about: Mapping[str, Any], via: str, unit: str) -> str:
    """Return least, mean and greatest time [ms] from the sampling of a bus signal to a unit's use of it.

    A signal of several pages of a message that differ in it has those of each.
    """
    message, _, signal = via.rpartition(".")
    delays = dict(items_of(about.get("effective_delays")))
    if message in delays:
        return _times(dict(items_of(delays[message])).get(unit))
    found: dict[str, list[str]] = {}
    for label, signals in items_of(about.get("pages")):
        page = label.removeprefix(f"{message} ")
        times = _times(dict(items_of(delays.get(label))).get(unit))
        if page != label and signal in texts_of(signals) and times:
            found.setdefault(times, []).append(page)
    if len(found) == 1:
        return next(iter(found))
    return "; ".join(f"{times} where {' or '.join(pages)}" for times, pages in found.items())


def _times(times: Any) -> str:
    if not isinstance(times, Mapping):
        return ""
    least, mean, most = (1e3 * times[key] for key in ("min", "mean", "max"))
    return f"{mean:.3g}" if least == most else f"{mean:.3g} ({least:.3g} to {most:.3g})"


def _steps(unit: Mapping[str, Any]) -> str:
    period = f"{shown(unit['period'])} s" if "period" in unit else ""
    count = unit.get("substeps")
    steps = f"{period} in {count} FMU steps" if isinstance(count, int) and count > 1 else period
    return f"{steps}, from {shown(unit['offset'])} s on" if unit.get("offset") else steps


def parameters_section(about: Mapping[str, Any]) -> str:
    """Return the parameters and start values that differ from those that the FMUs declare."""
    defaults = {unit: dict(items_of(names)) for unit, names in items_of(about.get("defaults"))}
    rows = []
    for unit, facts in items_of(about.get("units")):
        for kind in ("parameters", "start"):
            for name, value in items_of(dict(items_of(facts)).get(kind)):
                declared = dict(items_of(defaults.get(unit, {}).get(name)))
                if "value" in declared and declared["value"] == value:
                    continue
                measure = _unit(shown(declared.get("unit")))
                here, there = (f"{shown(x)} {measure}".strip() for x in (value, declared.get("value")))
                rows.append((f"{unit}.{name}", here, there, shown(declared.get("description"))))
    for_all = table(("name", "here", "the FMU's", "what"), rows, right=("here", "the FMU's"))
    nothing = "<p>Every parameter and start value is the one that its FMU declares.</p>"
    return section("Parameters that differ from the FMUs'", for_all or nothing) if "units" in about else ""


def versions_section(about: Mapping[str, Any]) -> str:
    """Return the versions of programs and the digests of files."""
    programs = [("evcosim", shown(about["evcosim"]))] if "evcosim" in about else []
    programs += [(name, shown(version)) for name, version in items_of(about.get("versions"))]
    digests = [
        (name, shown(dict(items_of(unit)).get("file")), shown(dict(items_of(unit)).get("sha256")))
        for name, unit in items_of(about.get("units"))
    ]
    digests += (
        [("settings", "what system and scenario say", shown(about["settings"]))]
        if "settings" in about
        else []
    )
    return section(
        "Versions and digests",
        table(("program", "version"), programs),
        table(("of", "file", "SHA-256"), digests),
        f"<p>{escaped('; '.join(texts_of(about.get('outside'))))}</p>"
        if texts_of(about.get("outside"))
        else "",
    )


def repeat_section(about: Mapping[str, Any]) -> str:
    """Return the command that does the run again."""
    command = about.get("command")
    files = [f"{kind}: {shown(path)}" for kind, path in items_of(about.get("files"))]
    if isinstance(command, str) and command:
        return section("Do it again", block(command), listed(files))
    made = "The run was made by a program of its own, by evcosim from Python."
    return section("Do it again", f"<p>{escaped(made)}</p>" if about else "", listed(files))


def manifest_section(about: Mapping[str, Any], variables: Iterable[ResultVariable]) -> str:
    """Return run.json, folded, and the licence of the library that draws."""
    whole = {**about, "variables": [described(v) for v in variables]}
    note = "<p>Without the seconds that the run took: they differ between two equal runs.</p>"
    return folded("run.json", note, block(manifest_text(whole).decode())) + folded(
        f"The curves are drawn by uPlot {UPLOT}", block(text("uPlot.LICENSE.txt"))
    )


def events_of(about: Mapping[str, Any]) -> list[tuple[float, str]]:
    """Return time [s] and text of each event of a run, and behind them of each fault on a bus."""
    found = []
    for event in records_of(about.get("events")):
        time = event.get("time")
        if isinstance(time, int | float):
            value = f" = {shown(event['value'])}" if "value" in event else ""
            found.append((float(time), f"{shown(event.get('action'))} {shown(event.get('variable'))}{value}"))
    for fault in records_of(about.get("faults")):
        time, frames = fault.get("time"), fault.get("frames")
        if isinstance(time, int | float) and isinstance(frames, int):
            hit = counted(frames, "frame")
            found.append((float(time), f"{shown(fault.get('action'))} {shown(fault.get('on'))} ({hit})"))
    return found
