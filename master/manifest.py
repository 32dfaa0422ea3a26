"""The manifest of a run: a JSON-able record of what made its results, written as run.json."""

from __future__ import annotations

import functools
import importlib.metadata
import platform
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from ..cosim.plan.bus_load import bus_loads
from ..cosim.plan.faults import described
from ..cosim.plan.unit_plan import UnitPlan
from ..cosim.swap.sampled import sampled_in
from ..cosim.system.system import Isolation, System
from .builtin import library_of
from .engine.bus_statistics import bus_statistics
from .engine.effective_delays import effective_delays
from .engine.engine import Engine
from .engine.fault_tables import hits_of
from .fmi.tolerance import tolerance_of
from .prepare import Prepared


def manifest(
    prepared: Prepared,
    engine: Engine,
    isolation: Mapping[str, Isolation],
    warnings: Sequence[str],
    loop_seconds: float,
) -> dict[str, Any]:
    """Return versions, FMU digests, parameters, settings and counts of a run.

    `isolation` is how each unit runs, by name; `loop_seconds` [s] is the time spent in steps.
    """
    plan, system = prepared.plan, prepared.system
    experiment = plan.experiment
    return {
        "evcosim": _version("evcosim"),
        "versions": {p: _version(p) for p in ("fmpy", "pythonfmu", "numpy")}
        | {"python": platform.python_version(), "platform": sys.platform},
        "system": plan.system,
        "scenario": plan.scenario,
        "files": dict(prepared.files),
        "settings": prepared.digest,
        "options": dict(prepared.options),
        "command": prepared.command,
        "experiment": experiment.model_dump() | {"algorithm": plan.algorithm, "engine": engine.name},
        "ideal": plan.ideal,
        "order": [unit.name for unit in plan.units],
        "units": {unit.name: _unit(unit, prepared, isolation[unit.name]) for unit in plan.units},
        "defaults": {unit.name: _defaults(unit) for unit in plan.units},
        "connect": _connected(system, {unit.name for unit in plan.units}),
        "connections": _scaled(system),
        "buses": {name: bus.model_dump() for name, bus in system.file.buses.items()},
        "frames": bus_statistics(engine.frames, engine.k),
        "effective_delays": effective_delays(plan, engine.frames, engine.k),
        "pages": {f"{m.bus}.{m.label}": [r.signal.name for r in m.routes] for m in plan.messages if m.page},
        "faults": described(plan.faults, hits_of(engine.frames.arrays, plan.faults)),
        "bus_load": [load.as_data() for load in bus_loads(plan.messages, plan.clock.step).values()],
        "events": [
            {"time": plan.clock.at(k), **event.model_dump(exclude={"time"})} for k, event in plan.events
        ],
        "steps": engine.k,
        "replays": [replay.as_data() for replay in plan.replays],
        "saturations": saturations(engine),
        "outside": list(prepared.outside),
        "warnings": list(warnings),
        "loop_seconds": round(loop_seconds, 6),
    } | ({"ended": engine.ending.text} if engine.ending.text else {})


@functools.cache  # reading the metadata of a distribution takes a millisecond
def _version(distribution: str) -> str:
    return importlib.metadata.version(distribution)


def _unit(unit: UnitPlan, prepared: Prepared, isolation: Isolation) -> dict[str, Any]:
    fmu = prepared.fmus[unit.name]
    tolerance, origin = tolerance_of(fmu, prepared.system.file.units[unit.name].tolerance)
    return {
        "fmu": unit.fmu,
        "file": fmu.path.name,
        "sha256": fmu.digest,
        "parameters": unit.parameters,
        "start": unit.start,
        "period": prepared.plan.clock.length(unit.every),
        "offset": prepared.plan.clock.length(unit.first),
        "substeps": unit.substeps,
        "sampled": list(sampled_in(unit.interface)),
        "interface": fmu.interface_type,
        "tolerance": tolerance,
        "tolerance_from": origin,
        "isolation": isolation,
        "map": prepared.system.file.units[unit.name].map.model_dump(exclude_defaults=True),
    } | ({"library": library} if (library := library_of(fmu.digest)) else {})


def _defaults(unit: UnitPlan) -> dict[str, Any]:
    """Return of each parameter and start value that is set what the FMU declares: value, unit, text."""
    declared = {name: unit.interface.variables[name] for name in (*unit.parameters, *unit.start)}
    return {
        name: {"value": v.default, "unit": v.unit, "description": v.description}
        for name, v in declared.items()
    }


def _connected(system: System, units: set[str]) -> list[dict[str, Any]]:
    """Return the connections between these units as the file has them; over a bus also those to nobody."""
    found = []
    for connection in system.file.connect:
        ends = [receiver for receiver in connection.to if receiver.partition(".")[0] in units]
        if connection.source.partition(".")[0] in units and (ends or connection.via):
            found.append(connection.model_dump(by_alias=True, exclude_defaults=True) | {"to": ends})
    return found


def _scaled(system: System) -> list[dict[str, Any]]:
    """Return the connections with a factor, an offset or `convert`, as the file has them."""
    return [
        connection.model_dump(by_alias=True, exclude_defaults=True)
        for connection in system.file.connect
        if connection.written
    ]


def saturations(engine: Engine) -> dict[str, dict[str, float]]:
    """Return `count` and `first_time` [s] of each bus signal that was saturated, by bus.message.signal."""
    found: dict[str, dict[str, float]] = {}
    for sender in engine.senders:
        for signal, saturation in sender.channel.saturations.items():
            if not saturation.count:
                continue
            name = f"{sender.plan.bus}.{sender.plan.message.name}.{signal}"
            first = engine.time_at(saturation.first_step)
            page = found.get(name, {"count": 0, "first_time": first})  # of several, which hold it too
            found[name] = {
                "count": page["count"] + saturation.count,
                "first_time": min(page["first_time"], first),
            }
    return found
