"""An FMU under the names, units of measure and signs of a system, and the system without what it lacks.

`present` renames the variables of an interface as a unit's `map` says; connections, stimuli, figures and
results then work with the names of the system, and convert units of measure as they always do.
`without_absent` takes out of a system and its scenario what needs variables that a unit declares `absent`,
`without_untaken` the connections that are `optional` and that an FMU has no variable for.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterable, Mapping

from ..can.message_settings import MessageSettings
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value, VariableInfo
from ..plan.unit_maps import End, scaled_map
from ..system.can_log_spec import CanLogEntry
from ..system.figure_spec import FigureSpec
from ..system.metric_spec import MetricSpec
from ..system.problems import spelled
from ..system.scenario import Event, Scenario, StimulusEntry
from ..system.system import BusEntry, Connection, MapEntry, System, SystemFile, UnitEntry
from ..units.definition import defined

_FROM: dict[str, tuple[str, ...]] = {
    "input": ("input",),
    "output": ("output", "local", "parameter", "calculatedParameter", "independent"),
    "parameter": ("parameter", "structuralParameter"),
}
"""The causalities that an FMU's variable may have behind an input, output or parameter of the system."""


def present(interface: UnitInterface, entry: UnitEntry, keys: str) -> UnitInterface:
    """Return the interface of a unit's FMU under the system's names; with an empty map, the interface itself.

    A variable that is mapped is known by the system's name alone. `keys` is the beginning of the unit's keys
    in messages (`System.keys_of`). Raises ConfigError for names that the FMU has not, causalities that do
    not fit and unknown units of measure.
    """
    tables = entry.map.by_causality
    if not any(tables.values()):
        return interface
    renamed: dict[str, VariableInfo] = {}
    for causality, table in tables.items():
        for name, mapped in table.items():
            here = keys + spelled(["map", f"{causality}s", name])
            if name in renamed:
                raise ConfigError(f"{here}: '{name}' is mapped twice")
            renamed[name] = _mapped(interface, name, mapped, causality, here)
    taken = {v.declared_name for v in renamed.values()}
    names = {v.declared_name: v.name for v in renamed.values()}
    rest = {n: v for n, v in interface.variables.items() if n not in taken and n not in renamed}
    variables = {n: _with_names(v, names) for n, v in {**renamed, **rest}.items()}
    return dataclasses.replace(interface, variables=variables)


def _mapped(
    interface: UnitInterface, name: str, mapped: MapEntry, causality: str, place: str
) -> VariableInfo:
    if mapped.variable in interface.unusable:
        raise ConfigError(f"{place}: {mapped.variable} {interface.unusable[mapped.variable]}")
    variable = interface.variables.get(mapped.variable)
    if variable is None:
        raise ConfigError(
            f"{place}: {interface.place} has no variable '{mapped.variable}'"
            f"{nearest(mapped.variable, interface.variables)}"
        )
    if variable.causality not in _FROM[causality]:
        allowed = " or ".join(_FROM[causality])
        raise ConfigError(f"{place}: {mapped.variable} is of causality {variable.causality}, not {allowed}")
    if mapped.unit is not None:
        if variable.type == "String":
            raise ConfigError(f"{place}: {mapped.variable} is a String, which has no unit of measure")
        _check_unit(mapped.unit, interface, place)
    if not mapped.linear.identity and variable.type != "Real":
        raise ConfigError(f"{place}: {mapped.variable} is of type {variable.type}: only a Real can be scaled")
    if mapped.invert and variable.type not in ("Real", "Integer"):
        raise ConfigError(f"{place}: {mapped.variable} is a {variable.type}: it has no sign to invert")
    known = dataclasses.replace(
        variable,
        name=name,
        declared=mapped.variable,
        causality=causality,
        unit=variable.unit if mapped.unit is None else mapped.unit,
    )
    if mapped.written:
        return _scaled(known, variable, mapped, interface, place)
    return _inverted(known) if mapped.invert else known


def _scaled(
    known: VariableInfo, variable: VariableInfo, mapped: MapEntry, interface: UnitInterface, place: str
) -> VariableInfo:
    """Return the variable as the system knows it, with the map between it and the FMU's own.

    Range and start are the FMU's, mapped. Raises ConfigError as `scaled_map` does.
    """
    of_fmu = interface.units_of_measure, variable.difference
    ours = End(f"the system's {known.name}", known.unit, *of_fmu, advice="say what it is in: `unit` here")
    instead = f"with `convert = false` no unit of measure of {variable.name} counts"
    own = End(variable.name, variable.unit, *of_fmu, advice=instead)
    ends = (ours, own) if known.causality in ("input", "parameter") else (own, ours)
    changed = dataclasses.replace(known, scaling=scaled_map(*ends, mapped, (), place, []))
    if not math.isfinite(changed.scaling.inverse().scale):
        raise ConfigError(f"{place}: {mapped.in_words}: no number holds the way back")
    back = dataclasses.replace(changed, inverted=False).from_fmu  # range and start have the FMU's own sign
    low, high = (None if x is None else back(x) for x in (known.min, known.max))
    low, high = (low, high) if back.scale > 0.0 else (high, low)
    start = back(known.start) if isinstance(known.start, int | float) else known.start
    return dataclasses.replace(changed, start=start, min=low, max=high)


def _check_unit(unit: str, interface: UnitInterface, place: str) -> None:
    try:
        defined(unit, interface.units_of_measure)
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _inverted(v: VariableInfo) -> VariableInfo:
    """Return the variable with the other sign: range and start with it."""
    start = -v.start if isinstance(v.start, int | float) else v.start
    low, high = (None if x is None else -x for x in (v.max, v.min))
    return dataclasses.replace(v, start=start, min=low, max=high, inverted=not v.inverted)


def _with_names(v: VariableInfo, names: Mapping[str, str]) -> VariableInfo:
    """Return the variable with its dependencies under the names that the system uses."""

    def known(depends: tuple[str, ...] | None) -> tuple[str, ...] | None:
        return None if depends is None else tuple(names.get(n, n) for n in depends)

    return dataclasses.replace(v, depends=known(v.depends), depends_initially=known(v.depends_initially))


def without_open(system: System, allowed: bool) -> tuple[System, tuple[str, ...]]:
    """Return the system with the `open` names of its units as absent ones, and the units that have any.

    Raises ConfigError that names them, unless they are `allowed`.
    """
    units, found = dict(system.file.units), []
    for unit, entry in system.file.units.items():
        mapped = {name for table in entry.map.by_causality.values() for name in table}
        left = [name for name in entry.open if name not in mapped and name not in entry.absent]
        if left and not allowed:
            raise ConfigError(
                f"{system.keys_of(unit)}open: no variable of {entry.fmu} is chosen for {', '.join(left)}; "
                "map each (its guess may stand in the file as a comment), or allow it (--allow-open, in "
                "Python allow_open=True): then what needs them is left out"
            )
        if left:
            units[unit] = entry.model_copy(update={"absent": [*entry.absent, *left], "open": []})
            found.append(unit)
    if not found:
        return system, ()
    return dataclasses.replace(system, file=system.file.model_copy(update={"units": units})), tuple(found)


def without_absent(system: System, scenario: Scenario) -> tuple[System, Scenario, tuple[str, ...]]:
    """Return system and scenario without what needs absent variables, and a sentence for each loss."""
    absent = {f"{unit}.{name}" for unit, entry in system.file.units.items() for name in entry.absent}
    if not absent:
        return system, scenario, ()
    left_out: list[str] = []
    file, driven = system.file, scenario.file
    connect = [c for c in (_connection(c, absent, left_out) for c in file.connect) if c is not None]
    budget = file.budget
    metrics = _metrics(file.metrics, absent, left_out)
    if budget is not None and budget.metric not in {m.name for m in metrics}:
        budget = None
    changed = file.model_copy(
        update={
            "connect": connect,
            "metrics": metrics,
            "figure": _figure(file.figure, absent, left_out),
            "budget": budget,
            "record": _recorded(file.record, absent, left_out),
            "buses": without_status(file.buses, absent, left_out),
        }
    )
    driven = driven.model_copy(
        update={
            "entries": _stimuli(driven.entries, absent, left_out),
            "events": _events(driven.events, absent, left_out),
            "parameters": _known(driven.parameters, absent, left_out),
            "start": _known(driven.start, absent, left_out),
            "metrics": _metrics(driven.metrics, absent, left_out),
            "figure": _figure(driven.figure, absent, left_out),
            "record": driven.record and _recorded(driven.record, absent, left_out),
        }
    )
    sentences = tuple(f"left out, since it is absent: {text}" for text in dict.fromkeys(left_out))
    return dataclasses.replace(system, file=changed), dataclasses.replace(scenario, file=driven), sentences


def without_untaken(
    system: System, interfaces: Mapping[str, UnitInterface]
) -> tuple[System, tuple[str, ...]]:
    """Return the system without the ends of `optional` connections, and the inputs of statuses that are, that
    its FMUs do not have, and a sentence for each. `interfaces` are those of the units that take part."""
    kept, said = [], []
    for connection in system.file.connect:
        ends = (connection.source, *connection.to)
        lost = {name for name in ends if connection.optional and not _there(name, interfaces)}
        losses: list[str] = []
        left = _connection(connection, lost, losses) if lost else connection
        if left is not None:
            kept.append(left)
        said += [f"left out, since the FMU has no {', '.join(sorted(lost))}: {text}" for text in losses]
    losses = []
    readers = {name for own in optional_statuses(system.file) for name in own.status}
    lost = {name for name in readers if not _there(name, interfaces)}
    buses = without_status(system.file.buses, lost, losses)
    said += [f"left out, since the FMU has no such variable: {text}" for text in losses]
    if not said:
        return system, ()
    changed = system.file.model_copy(update={"connect": kept, "buses": buses})
    return dataclasses.replace(system, file=changed), tuple(said)


def optional_statuses(file: SystemFile) -> list[MessageSettings]:
    """Return the settings of the messages whose status need not be read."""
    return [own for bus in file.buses.values() for own in bus.messages.values() if own.status_optional]


def without_status(
    buses: Mapping[str, BusEntry], gone: Collection[str], left_out: list[str]
) -> dict[str, BusEntry]:
    """Return the buses without these inputs of statuses; adds what is lost to `left_out`."""
    found: dict[str, BusEntry] = {}
    for bus, entry in buses.items():
        messages: dict[str, MessageSettings] = {}
        for name, own in entry.messages.items():
            lost = [full for full in own.status if full in gone]
            left_out += [f"the status of {bus}.{name} -> {full}" for full in lost]
            kept = [full for full in own.status if full not in gone]
            messages[name] = own.model_copy(update={"status": kept}) if lost else own
        found[bus] = entry.model_copy(update={"messages": messages})
    return found


def _there(name: str, interfaces: Mapping[str, UnitInterface]) -> bool:
    """Return False for a variable that the FMU of a unit that takes part does not have."""
    unit, _, variable = name.partition(".")
    return unit not in interfaces or variable in interfaces[unit].variables


def _connection(connection: Connection, absent: set[str], left_out: list[str]) -> Connection | None:
    if connection.source in absent:
        to = ", ".join(connection.to) or connection.via
        left_out.append(f"{connection.source} -> {to}; a receiver keeps its start value")
        return None
    kept = [name for name in connection.to if name not in absent]
    if kept == connection.to:
        return connection
    lost = [name for name in connection.to if name in absent]
    left_out.append(f"{connection.source} -> {', '.join(lost)}")
    return connection.model_copy(update={"to": kept}) if kept or connection.via else None


def _stimuli(
    stimuli: Iterable[StimulusEntry | CanLogEntry], absent: set[str], left_out: list[str]
) -> list[StimulusEntry | CanLogEntry]:
    kept: list[StimulusEntry | CanLogEntry] = []
    for stimulus in stimuli:
        if isinstance(stimulus, CanLogEntry):
            to = {name: signal for name, signal in stimulus.to.items() if name not in absent}
            lost = [name for name in stimulus.to if name in absent]
            left_out += [f"the CAN log's {stimulus.to[name]} to {name}" for name in lost]
            kept.append(stimulus.model_copy(update={"to": to}))
        elif stimulus.to in absent:
            left_out.append(f"the stimulus of {stimulus.to}")
        else:
            kept.append(stimulus)
    return kept


def _events(events: Iterable[Event], absent: set[str], left_out: list[str]) -> list[Event]:
    kept = []
    for event in events:
        if absent.isdisjoint(event.needs):
            kept.append(event)
        else:
            left_out.append(f"the event '{event.action}' of {', '.join(event.needs)} at {event.time:g} s")
    return kept


def _metrics(specs: Iterable[MetricSpec], absent: set[str], left_out: list[str]) -> list[MetricSpec]:
    kept = []
    for spec in specs:
        if absent.intersection(spec.all_signals):
            left_out.append(f"metric '{spec.name}'")
        else:
            kept.append(spec)
    return kept


def _recorded(patterns: Iterable[str], absent: set[str], left_out: list[str]) -> list[str]:
    left_out += [f"{pattern} in the record" for pattern in patterns if pattern in absent]
    return [pattern for pattern in patterns if pattern.removeprefix("!") not in absent]


def _figure(spec: FigureSpec | None, absent: set[str], left_out: list[str]) -> FigureSpec | None:
    if spec is None:
        return None
    gone = [s.name for panel in spec.panels for s in panel.signals if s.name in absent]
    left_out += [f"{name} in the figure" for name in gone]
    return spec.without(absent.__contains__)


def _known(
    values: Mapping[str, dict[str, Value]], absent: set[str], left_out: list[str]
) -> dict[str, dict[str, Value]]:
    left_out += [
        f"the value of {u}.{n}" for u, given in values.items() for n in given if f"{u}.{n}" in absent
    ]
    return {u: {n: x for n, x in given.items() if f"{u}.{n}" not in absent} for u, given in values.items()}
