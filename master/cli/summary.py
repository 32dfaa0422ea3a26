"""The summary of a run at its end, as text and as data."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from ...cosim.errors import counted
from ...cosim.results.text_table import shown_text
from ...cosim.visible import on_one_line
from . import interrupts
from .console import number, print_fields, print_next, print_paragraph, print_table

if TYPE_CHECKING:
    from ...cosim.interface import Value
    from ...cosim.results.variable import ResultVariable
    from .run import FinishedRun

_FINAL_VALUES = 8


def show(finished: FinishedRun) -> None:
    """Print a run's summary in a few lines."""
    manifest = finished.results.manifest
    fields = [
        ("run", _name(manifest)),
        ("time", _time(finished)),
        *([("ended", manifest["ended"])] if "ended" in manifest else []),
        ("units", f"{', '.join(manifest['order'])} ({_algorithm(manifest)})"),
    ]
    fields += [("native" if i == 0 else "", text) for i, text in enumerate(_native(manifest["units"]))]
    fields.append(("isolated", _isolated(manifest["units"])))
    fields += [("reads" if i == 0 else "", text) for i, text in enumerate(manifest["outside"])]
    for i, (signal, about) in enumerate(manifest["saturations"].items()):
        times = counted(int(about["count"]), "time")
        fields.append(
            ("saturated" if i == 0 else "", f"{signal} {times}, first at {about['first_time']:g} s")
        )
    for i, fault in enumerate(manifest["faults"]):
        fields.append(("faults" if i == 0 else "", _fault(fault)))
    fields += [("warning", remark) for remark in finished.remarks]
    print_fields(fields)
    print()
    if finished.metrics:
        print_fields([(m.name, m.text) for m in finished.metrics])
    elif final := _final_values(finished):
        print_paragraph(f"values at t = {number(finished.results.span[1])} s")
        print_fields(final)
    if profile := finished.simulation.profile:
        print()
        _show_profile(profile)
    print()
    print_paragraph(f"in {on_one_line(str(finished.folder.path))}: {', '.join(finished.files)}")
    print_next(_next(finished))


def _fault(fault: dict[str, Any]) -> str:
    """Return what a fault on a bus did."""
    duration = f" for {fault['duration']:g} s" if "duration" in fault else ""
    hit = counted(int(fault["frames"]), "frame") if fault["frames"] else "no frame"
    return f"{fault['action']} {fault['on']} at {fault['time']:g} s{duration}: {hit}"


def _isolated(units: dict[str, Any]) -> str:
    """Return which units have a process of their own."""
    isolated = [name for name, unit in units.items() if unit["isolation"] == "process"]
    each = "each " if len(isolated) > 1 else ""
    return f"{', '.join(isolated)} ({each}in a process of its own)" if isolated else "none"


def _native(units: dict[str, Any]) -> list[str]:
    """Return which units are machine code of our own, and where that came from."""
    origins = {name: unit["library"] for name, unit in units.items() if "library" in unit}
    return [
        f"{', '.join(name for name, each in origins.items() if each == origin)} ({origin})"
        for origin in dict.fromkeys(origins.values())
    ]


def _next(finished: FinishedRun) -> list[str]:
    """Return commands that go on from here: another picture, another scenario, what the system is."""
    from ...cosim.system.scenario import scenario_names

    simulation, target = finished.simulation, shlex.quote(finished.target)
    sources = [connection.source for connection in simulation.system.file.connect]
    folder = shlex.quote(str(finished.folder.path))
    unit = sources[0].partition(".")[0] if sources else simulation.plan.units[0].name
    others = [name for name in scenario_names(simulation.system) if name != simulation.scenario.name]
    return [
        f"evcosim plot {folder} --signals '{unit}.*'",
        *(f"evcosim run {target} --scenario {shlex.quote(name)}" for name in others[:1]),
        f"evcosim info {target}",
    ]


def as_data(finished: FinishedRun) -> dict[str, Any]:
    """Return the summary as data; `final` holds the last value of every recorded variable."""
    results, manifest = finished.results, finished.results.manifest
    keys = (
        "system",
        "scenario",
        "status",
        "order",
        "ideal",
        "steps",
        "saturations",
        "faults",
        "loop_seconds",
    )
    return {key: manifest[key] for key in keys} | {
        "algorithm": manifest["experiment"]["algorithm"],
        "error": manifest.get("error"),
        "ended": manifest.get("ended"),
        "simulated_seconds": _simulated(finished),
        "real_time_factor": _factor(finished),
        "warnings": finished.remarks,
        "isolation": {name: unit["isolation"] for name, unit in manifest["units"].items()},
        "outside": manifest["outside"],
        "profile": finished.simulation.profile,
        "metrics": manifest.get("metrics", {}),
        "final": results.final(),
        "folder": str(finished.folder.path),
        "files": finished.files,
    }


def _show_profile(profile: list[dict[str, Any]]) -> None:
    rows = [
        (
            p["name"],
            p["what"],
            f"{p['seconds']:.4f}",
            f"{p['microseconds_per_step']:.3f}",
            f"{p['share']:.1%}",
        )
        for p in profile
    ]
    headers = ("part", "at", "s", "us a step", "share")
    print_table(headers, rows, right=headers[2:])


def of_failure(finished: FinishedRun) -> str:
    """Return the reason why a run failed or was interrupted, and the place of its recorded rows."""
    results = finished.results
    if isinstance(finished.error, KeyboardInterrupt):
        words = interrupts.words(interrupts.exit_code(finished.error) - 128)
        why = f"{words} at t = {number(finished.simulation.time)} s"
    else:
        why = str(finished.error)
    if finished.unwritten:
        return finished.unwritten if why == finished.unwritten else f"{why}\n{finished.unwritten}"
    kept = f"results up to t = {number(results.span[1])} s" if len(results) else "no step was recorded"
    folder = on_one_line(str(finished.folder.path))
    return f"{why}\n{kept}; in {folder}: {', '.join(finished.files)}"


def _name(manifest: dict[str, Any]) -> str:
    return " ".join(name for name in (manifest["system"], manifest["scenario"]) if name) + (
        ", ideal (no buses)" if manifest["ideal"] else ""
    )


def _algorithm(manifest: dict[str, Any]) -> str:
    experiment = manifest["experiment"]
    return f"{experiment['algorithm']}, {manifest['steps']} steps of {experiment['step_size']:g} s"


def _simulated(finished: FinishedRun) -> float:
    return finished.simulation.time - finished.simulation.plan.experiment.start_time


def _factor(finished: FinishedRun) -> float:
    seconds = finished.simulation.loop_seconds
    return _simulated(finished) / seconds if seconds > 0.0 else 0.0


def _time(finished: FinishedRun) -> str:
    seconds = finished.simulation.loop_seconds
    factor = float(f"{_factor(finished):.3g}")  # three digits, and no exponent up to a million
    return f"{number(_simulated(finished))} s simulated in {seconds:.3g} s: {number(factor)} times real time"


def _final_values(finished: FinishedRun) -> list[tuple[str, str]]:
    """Return the last values of a few outputs, first of those that other units receive."""
    results = finished.results
    sent = {connection.source for connection in finished.simulation.system.file.connect}
    described = (*results.variables, *results.text_table.variables)
    outputs = [v for v in described if v.causality == "output"]
    outputs.sort(key=lambda v: v.name not in sent)
    final = results.final()
    return [(v.name, _shown(v, final[v.name])) for v in outputs[:_FINAL_VALUES]] if final else []


def _shown(variable: ResultVariable, value: Value) -> str:
    """Return a value as a line shows it: with its unit of measure, the name of an item, a text in quotes."""
    if isinstance(value, str):
        return shown_text(value)
    items = (name for number, name in variable.items if number == value)
    text = next(items, str(value)) if variable.items else number(value)
    return text if variable.unit in ("", "1") else f"{text} {variable.unit}"
