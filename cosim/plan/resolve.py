"""From a system, a scenario and the units' interfaces to the plan of a run, or what is wrong in them."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Mapping

from ..clock import Clock
from ..csv_thousands import thousands_note
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value, VariableInfo
from ..results.results import ResultVariable
from ..system.held_stimuli import held_stimulus
from ..system.run_options import RunOptions
from ..system.scenario import Scenario
from ..system.stimuli import csv_of, stimulus
from ..system.system import Algorithm, Experiment, System, UnitEntry
from ..system.values import as_double
from ..texts import Texts
from ..units.definition import names_difference
from ..units.measure import Affine
from .bus_load import bus_loads, check_load
from .column_units import note_units
from .connections import connect
from .events import scheduled
from .faults import with_faults
from .given_values import all_parameters, all_starts, by_kind
from .idle_settings import check_codes, idle_settings
from .initials import check_initials
from .log_receivers import LogReceivers
from .network import Network
from .plan import Drive, InputPlan, Plan
from .recorded import Record
from .replay import with_replays
from .slots import Slots, allot
from .steps import check_framed, check_kept, steps_in
from .unit_maps import End, unit_map
from .unit_plan import UnitPlan
from .unreached import after_stop, out_of_time


def participating(system: System, scenario: Scenario) -> dict[str, UnitEntry]:
    """Return the units that take part, in the order in which they step.

    Raises ConfigError when the scenario leaves out a unit that there is not, or all.
    """
    units = dict(system.file.units)
    for name in scenario.file.leave_out:
        if name not in units:
            raise ConfigError(
                f"{scenario.path}: leave_out: no unit '{name}' in {system.path}{nearest(name, units)}"
            )
        del units[name]
    if not units:
        raise ConfigError(f"{scenario.path}: leave_out leaves no unit")
    return units


def resolve(
    system: System, scenario: Scenario, interfaces: Mapping[str, UnitInterface], options: RunOptions
) -> Plan:
    """Return the plan of a run. `interfaces` are those of the participating units, in their order.

    Raises ConfigError naming place, rule and values, before any unit is instantiated.
    """
    plan = _resolved(system, scenario, interfaces, options)
    plan = with_faults(plan, system, scenario, options.get("bus"))
    place = f"{_stop_time_in(system, scenario, options)} = {plan.clock.stop} s"
    check_framed(plan.framed_bus, plan.clock.length(plan.steps), place)
    for message in plan.messages:
        if message.framing is not None:
            check_framed(message.bus, message.settings.delay, f"{system.path}: buses.{message.bus}.delay")
    return plan


def _resolved(
    system: System, scenario: Scenario, interfaces: Mapping[str, UnitInterface], options: RunOptions
) -> Plan:
    """Return the plan of a run without faults; the rest is as in `resolve`."""
    experiment, algorithm = _experiment(system, scenario, options)
    entries, ideal = participating(system, scenario), options.get("ideal", False)
    record = _record_of(system, scenario, options)
    slots, recorded = allot(interfaces, record, {c.source for c in system.file.connect})
    texts, (columns, text_columns) = Texts(), _numbers_and_texts(recorded)
    clock = _clock(experiment, len(columns), _stop_time_in(system, scenario, options))
    turns = _turns(system, entries, clock)
    network = connect(system, interfaces, slots, turns, clock, algorithm, ideal)
    replays = with_replays(system, scenario, LogReceivers(system, interfaces, slots, network, ideal), clock)
    network.warnings += _about_settings(system, network, interfaces, options)
    drives = _drives(scenario, interfaces, network, slots, clock, texts)
    named, started = by_kind(options, interfaces, network)
    parameters = all_parameters(system, scenario, entries, interfaces, named)
    starts = {u: all_starts(system, scenario, u, entries[u], interfaces[u], started) for u in entries}
    return Plan(
        system=system.file.name,
        scenario=scenario.name,
        experiment=experiment.model_copy(update={"stop_time": clock.stop}),
        algorithm=algorithm,
        clock=clock,
        ideal=ideal,
        units=tuple(
            UnitPlan(
                name=name,
                fmu=entry.fmu,
                interface=interfaces[name],
                parameters=parameters[name],
                start=starts[name],
                every=turns[name][0],
                substeps=entry.substeps,
                groups=tuple(slots.groups[name]),
                routes=tuple(network.routes[name]),
                texts=texts,
                free=_free(name, interfaces[name], network, scenario),
                first=turns[name][1],
            )
            for name, entry in entries.items()
        ),
        links=tuple(network.links),
        messages=tuple(network.messages),
        drives=drives,
        events=scheduled(scenario, interfaces, network.inputs, clock, texts),
        inputs=network.inputs,
        columns=tuple(itertools.starmap(result_variable, columns)),
        column_slots=slots.shown(columns),
        initial=_initial(interfaces, starts, network, drives, experiment.start_time, texts),
        memory_size=slots.size,
        warnings=(*network.warnings, *_loads(system, network, clock), *out_of_time(scenario, drives, clock)),
        unreached=tuple(after_stop(scenario, drives, network.messages, network.inputs, turns, clock)),
        text_columns=tuple(itertools.starmap(result_variable, text_columns)),
        text_slots=slots.shown(text_columns),
        texts=texts,
        replays=tuple(replays),
    )


def _about_settings(
    system: System, network: Network, interfaces: Mapping[str, UnitInterface], options: RunOptions
) -> list[str]:
    """Return what is to be said of the settings of buses. Raises ConfigError for one that does not fit."""
    said = check_initials(system, network.databases, network.messages)
    check_codes(system, network, interfaces)
    return said if options.get("ideal") else said + idle_settings(system, network, options.get("bus"))


def _loads(system: System, network: Network, clock: Clock) -> list[str]:
    """Return a warning for each bus that its messages could fill. Raises ConfigError as `check_load` does."""
    loads = bus_loads(network.messages, clock.step)
    buses = system.file.buses
    said = [check_load(load, buses[bus].timing, f"{system.path}: buses.{bus}") for bus, load in loads.items()]
    return [warning for warning in said if warning]


_Columns = list[tuple[str, VariableInfo]]


def _numbers_and_texts(recorded: _Columns) -> tuple[_Columns, _Columns]:
    """Return the recorded variables that have numbers, and the Strings."""
    return [c for c in recorded if c[1].type != "String"], [c for c in recorded if c[1].type == "String"]


def result_variable(unit: str, v: VariableInfo) -> ResultVariable:
    """Return the description that results give of a variable of a unit."""
    return ResultVariable(
        name=f"{unit}.{v.name}",
        unit=v.unit,
        type=v.type,
        causality=v.causality,
        variability="discrete" if v.sampled else v.variability,  # it holds until the next point
        description=v.description,
        items=v.items,
        difference=v.difference or names_difference(v.unit),
    )


def _record_of(system: System, scenario: Scenario, options: RunOptions) -> Record:
    """Return the patterns of what is recorded.

    An option that only leaves out, as `!battery.*`, leaves that out of what the files record.
    """
    if scenario.file.record is not None and scenario.path is not None:
        place, patterns = str(scenario.path), scenario.file.record
    else:
        place, patterns = str(system.path), system.file.record
    changed = {*system.swaps, *(options.get("fmus") or {}), *scenario.file.leave_out}
    given = list(options.get("record") or [])
    if all(pattern.startswith("!") for pattern in given):
        return Record(place, patterns, given, changed)
    return Record("", given)


def _experiment(system: System, scenario: Scenario, options: RunOptions) -> tuple[Experiment, Algorithm]:
    changes = scenario.file.experiment.model_dump(exclude_none=True)
    for name, value in (("stop_time", options.get("stop_time")), ("step_size", options.get("step_size"))):
        if value is not None:
            changes[name] = float(value)
    experiment = system.file.experiment.model_copy(update=changes)
    algorithm = options.get("algorithm") or experiment.algorithm
    if algorithm not in ("gauss_seidel", "jacobi"):
        raise ConfigError(f"algorithm is gauss_seidel or jacobi, not {algorithm!r}")
    return experiment, algorithm


def step_size_of(system: System, scenario: Scenario, options: RunOptions) -> float:
    """Return the communication step [s] of a run: the option's, else the scenario's or the system's."""
    given = (options.get("step_size"), scenario.file.experiment.step_size)
    return next((step for step in given if step is not None), system.file.experiment.step_size)


def _stop_time_in(system: System, scenario: Scenario, options: RunOptions) -> str:
    """Return the place of the stop time that counts: a file and its key, or the option."""
    if options.get("stop_time") is not None:
        return "stop_time"
    path = system.path if scenario.file.experiment.stop_time is None else scenario.path
    return f"{path}: experiment.stop_time"


def _clock(experiment: Experiment, columns: int, place: str) -> Clock:
    """Return the clock of a run that records so many columns; `place` is that of the stop time.

    Raises ConfigError when the stop time is no whole number of steps after the start, or too much is
    recorded.
    """
    if not -math.inf < experiment.stop_time < math.inf:
        raise ConfigError(f"{place} {experiment.stop_time} s is not finite")
    duration = experiment.stop_time - experiment.start_time
    if not (math.isfinite(duration) and duration > 0.0):
        raise ConfigError(
            f"{place} {experiment.stop_time} s is not after start_time {experiment.start_time} s"
        )
    start, step = experiment.start_time, experiment.step_size
    steps = steps_in(experiment.stop_time, step, place, start, least=1)
    check_kept(steps, step, columns, place)
    return Clock.counted(start, step, steps, experiment.stop_time)


def _turns(system: System, entries: Mapping[str, UnitEntry], clock: Clock) -> dict[str, tuple[int, int]]:
    """Return the period and the offset of each unit in communication steps.

    Raises ConfigError for one that is no multiple of the step, and for an offset that is not less than the
    period, or leaves no turn before the stop time.
    """
    found = {}
    for unit, entry in entries.items():
        period, offset = entry.period or clock.step, entry.offset or 0.0
        every = steps_in(period, clock.step, f"{system.keys_of(unit)}period", least=1)
        place, most = f"{system.keys_of(unit)}offset", clock.length(every - 1)
        if offset >= clock.length(every):
            raise ConfigError(
                f"{place} = {offset} s is not less than the period of the unit, {period} s; the "
                f"greatest offset is {most} s{'' if most else ', or the unit needs a longer `period`'}"
            )
        first = steps_in(offset, clock.step, place, most=every - 1)
        if first >= clock.steps:
            raise ConfigError(
                f"{place} = {offset} s: the unit starts at {clock.at(first)} s, not before the stop "
                f"time {clock.stop} s; stop later"
            )
        found[unit] = every, first
    return found


def _drives(
    scenario: Scenario,
    interfaces: Mapping[str, UnitInterface],
    network: Network,
    slots: Slots,
    clock: Clock,
    texts: Texts,
) -> tuple[Drive, ...]:
    """Return the stimuli of a scenario, each noted as what drives its input in `network`.

    The inputs that nothing drives have a mailbox then. Raises ConfigError when an input is driven already,
    or its unit measures another quantity.
    """
    drives = []
    for number, entry in scenario.file.stimuli:
        place = f"{scenario.path}: stimulus {number}" if scenario.path else f"input {entry.to}"
        unit, name = network.input_of(entry.to, interfaces, f"{place}.to")
        variable, interface = interfaces[unit].variables[name], interfaces[unit]
        map_ = Affine()
        if entry.unit is not None and variable.type == "String":
            raise ConfigError(f"{place}.unit: {entry.to} is a String, which has no unit of measure")
        target = End(entry.to, variable.unit, interface.units_of_measure, variable.difference)
        if entry.unit is not None:
            advice = "say what it is in: the stimulus' own `unit`"
            given = dataclasses.replace(
                target, name=f"the stimulus of {entry.to}", unit=entry.unit, advice=advice
            )
            map_ = unit_map(given, target, (), f"{place}.unit", network.warnings)
        if entry.csv is not None:
            file, rows = csv_of(entry, place, scenario.path)
            columns, where = (
                (rows.time, rows.value),
                "the stimulus" if scenario.path else "a stimulus of a system",
            )
            network.warnings += note_units(file, columns, target, entry.unit, where)
            notes = [thousands_note(file, columns)]
            if entry.time_column is None and (note := file.time_note()):
                notes.append(f"{note}; `time_column` says which is meant")
            network.warnings += filter(None, notes)
        slot = slots.valid[unit, name]
        network.drive(
            entry.to, InputPlan(slot, None, f"a stimulus of {scenario.path or 'this run'}"), f"{place}.to"
        )
        if variable.type == "Real":
            signal = stimulus(entry, place, scenario.path, variable, clock)
            drives.append(Drive(entry.to, slot, signal, map_))
        else:
            to_double = functools.partial(as_double, variable, texts=texts)
            signal = held_stimulus(entry, place, scenario.path, variable, map_, clock, to_double)
            drives.append(Drive(entry.to, slot, signal, Affine()))
    _mailboxes_of_the_rest(interfaces, network, slots)
    return tuple(drives)


def _mailboxes_of_the_rest(interfaces: Mapping[str, UnitInterface], network: Network, slots: Slots) -> None:
    """Give a mailbox to every input that nothing drives."""
    for unit, interface in interfaces.items():
        for v in interface.of_causality("input"):
            if f"{unit}.{v.name}" not in network.inputs:
                network.add_mailbox(unit, v.name, slots, "")


def _free(unit: str, interface: UnitInterface, network: Network, scenario: Scenario) -> frozenset[str]:
    """Return the inputs of another tool's FMU that nothing drives and no event acts on.

    Some FMUs change such an input themselves, or refuse to have it set. Ours do neither, and all their inputs
    are set as one piece of memory.
    """
    if interface.ours:
        return frozenset()
    acted_on = {event.variable for event in scenario.file.events}
    inputs = {v.name: f"{unit}.{v.name}" for v in interface.of_causality("input")}
    return frozenset(
        name for name, full in inputs.items() if not network.inputs[full].driver and full not in acted_on
    )


def _initial(
    interfaces: Mapping[str, UnitInterface],
    starts: Mapping[str, Mapping[str, Value]],
    network: Network,
    drives: tuple[Drive, ...],
    start_time: float,
    texts: Texts,
) -> dict[int, float]:
    """Return the values of the inputs' slots and mailboxes before anything was computed or received.

    A value is that of the stimulus at the start time, else the connection's `initial`, else the start given
    in a file, else the FMU's. Raises ConfigError for a whole number that no double holds.
    """
    values = {}
    for name, plan in network.inputs.items():
        unit, _, of_unit = name.partition(".")
        variable = interfaces[unit].variables[of_unit]
        start = starts[unit].get(of_unit, variable.default)
        value = network.initial.get(name, start)
        number = as_double(variable, value, interfaces[unit].place, texts)
        values[plan.slot] = number
        if plan.mailbox is not None:
            values[plan.mailbox] = number
    return values | {drive.sink: drive.first(start_time) for drive in drives}
