"""From a system, a scenario and the units' interfaces to the plan of a run, or what is wrong in them."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
import re
from collections.abc import Mapping
from pathlib import Path

from ..clock import Clock
from ..csv_numbers import CsvFile
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value, VariableInfo
from ..results.results import ResultVariable
from ..system.held_stimuli import held_stimulus
from ..system.run_options import RunOptions
from ..system.scenario import Scenario
from ..system.stimuli import Rows, csv_of, stimulus
from ..system.system import Algorithm, Experiment, System, UnitEntry
from ..system.values import as_double, checked
from ..texts import Texts
from ..units.measure import Affine
from .connections import Network, connect
from .events import scheduled
from .plan import Drive, InputPlan, Plan
from .slots import Slots, allot
from .steps import steps_in
from .unit_maps import End, unit_map
from .unit_plan import UnitPlan
from .unreached import after_stop, before_start

_UNIT_IN_NAME = re.compile(r".*[\[(]([^][()]+)[\])]")

_MOST_VALUES = 2**31
"""Values that a run records at most: 16 GiB, kept in a temporary file (`row_store`); an array of the whole
table, as `Results.data` is, needs that much memory."""


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
    experiment, algorithm = _experiment(system, scenario, options)
    entries = participating(system, scenario)
    path, record = _record_of(system, scenario)
    slots, recorded = allot(interfaces, record, {c.source for c in system.file.connect}, str(path))
    texts, (columns, text_columns) = Texts(), _numbers_and_texts(recorded)
    clock = _clock(experiment, len(columns), _stop_time_in(system, scenario, options))
    experiment = experiment.model_copy(update={"stop_time": clock.stop})
    every = _periods(system, entries, experiment.step_size)
    network = connect(system, interfaces, slots, every, clock, algorithm, options.get("ideal", False))
    drives = _drives(scenario, interfaces, network, slots, clock, texts)
    _mailboxes_of_the_rest(interfaces, network, slots)
    named, started = _by_kind(options.get("parameters") or {}, interfaces, network)
    parameters = _parameters(system, scenario, entries, interfaces, named)
    starts = {u: _starts(system, scenario, u, entries[u], interfaces[u], started.get(u, {})) for u in entries}
    return Plan(
        system=system.file.name,
        scenario=scenario.name,
        experiment=experiment,
        algorithm=algorithm,
        clock=clock,
        ideal=options.get("ideal", False),
        units=tuple(
            UnitPlan(
                name=name,
                fmu=entry.fmu,
                interface=interfaces[name],
                parameters=parameters[name],
                start=starts[name],
                every=every[name],
                substeps=entry.substeps,
                groups=tuple(slots.groups[name]),
                routes=tuple(network.routes[name]),
                texts=texts,
                free=_free(name, interfaces[name], network, scenario),
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
        warnings=(*network.warnings, *before_start(scenario, drives, clock)),
        unreached=tuple(after_stop(scenario, drives, network.messages, network.inputs, every, clock)),
        text_columns=tuple(itertools.starmap(result_variable, text_columns)),
        text_slots=slots.shown(text_columns),
        texts=texts,
    )


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
        difference=v.difference,
    )


def _record_of(system: System, scenario: Scenario) -> tuple[Path, list[str]]:
    """Return the patterns of what is recorded, and the file that they stand in."""
    if scenario.file.record is not None and scenario.path is not None:
        return scenario.path, scenario.file.record
    return system.path, system.file.record


def _experiment(system: System, scenario: Scenario, options: RunOptions) -> tuple[Experiment, Algorithm]:
    changes = scenario.file.experiment.model_dump(exclude_none=True)
    if options.get("stop_time") is not None:
        changes["stop_time"] = options.get("stop_time")
    experiment = system.file.experiment.model_copy(update=changes)
    algorithm = options.get("algorithm") or experiment.algorithm
    if algorithm not in ("gauss_seidel", "jacobi"):
        raise ConfigError(f"algorithm is gauss_seidel or jacobi, not {algorithm!r}")
    return experiment, algorithm


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
    if steps * (columns + 1) > _MOST_VALUES:
        raise ConfigError(
            f"{place}: {steps:.3g} steps of {step:g} s with {columns} recorded variables are "
            f"more than the {_MOST_VALUES:.3g} values that a run keeps; stop earlier, take longer steps or "
            "`record` less"
        )
    return Clock.counted(start, step, steps, experiment.stop_time)


def _periods(system: System, entries: Mapping[str, UnitEntry], step_size: float) -> dict[str, int]:
    """Return the units' periods in communication steps [s]; one without a period steps at each."""
    return {
        unit: steps_in(entry.period or step_size, step_size, f"{system.keys_of(unit)}period", least=1)
        for unit, entry in entries.items()
    }


def _parameters(
    system: System,
    scenario: Scenario,
    entries: Mapping[str, UnitEntry],
    interfaces: Mapping[str, UnitInterface],
    named: Mapping[str, Value],
) -> dict[str, dict[str, Value]]:
    """Return every unit's parameters by name: the user's, else the scenario's, else the system's.

    Each value is in its parameter's own type and unit. Raises ConfigError as `checked` does.
    """
    given: list[tuple[str, str, str, Value]] = []
    for unit, entry in entries.items():
        given += [(unit, k, f"{system.keys_of(unit)}parameters.{k}", x) for k, x in entry.parameters.items()]
    for unit, values in scenario.file.parameters.items():
        given += [(unit, k, f"{scenario.path}: parameters.{unit}.{k}", x) for k, x in values.items()]
    for name, value in named.items():
        unit, _, parameter = name.partition(".")
        given.append((unit, parameter, f"parameter {name}", value))
    result: dict[str, dict[str, Value]] = {unit: {} for unit in entries}
    for unit, name, place, value in given:
        if unit not in interfaces:
            raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, interfaces)}")
        variable = interfaces[unit].require(unit, name, ("parameter",), place)
        result[unit][name] = checked(value, variable, place)
    return result


def _by_kind(
    given: Mapping[str, Value], interfaces: Mapping[str, UnitInterface], network: Network
) -> tuple[dict[str, Value], dict[str, dict[str, Value]]]:
    """Return the parameters among the values by "unit.variable", and by unit the start values.

    Raises ConfigError for an input that something drives, in which a start value would not stay.
    """
    named, started = dict(given), dict[str, dict[str, Value]]()
    for name in given:
        unit, _, variable = name.partition(".")
        known = interfaces[unit].variables.get(variable) if unit in interfaces else None
        if known is None or not known.takes_start:
            continue
        if name in network.inputs and network.inputs[name].driver:
            raise ConfigError(f"parameter {name}: the input is driven by {network.inputs[name].driver}")
        started.setdefault(unit, {})[variable] = named.pop(name)
    return named, started


def _starts(
    system: System,
    scenario: Scenario,
    unit: str,
    entry: UnitEntry,
    interface: UnitInterface,
    started: Mapping[str, Value],
) -> dict[str, Value]:
    """Return the start values of a unit's variables by name: the option's, scenario's or system's."""
    starts = {}
    given = {name: (f"{system.keys_of(unit)}start.{name}", value) for name, value in entry.start.items()}
    for name, value in scenario.file.start.get(unit, {}).items():
        given[name] = (f"{scenario.path}: start.{unit}.{name}", value)
    given |= {name: (f"parameter {unit}.{name}", value) for name, value in started.items()}
    for name, (place, value) in given.items():
        variable = interface.require(unit, name, ("input", "output", "local"), place)
        if not variable.takes_start:
            raise ConfigError(
                f"{place}: {unit}.{name} is a {variable.variability} {variable.causality} whose initial "
                "value the FMU computes or fixes; a start is given to an input, or where the FMU declares "
                'initial = "exact" or "approx"'
            )
        starts[name] = checked(value, variable, place)
        as_double(variable, starts[name], place, Texts())
    return starts


def _drives(
    scenario: Scenario,
    interfaces: Mapping[str, UnitInterface],
    network: Network,
    slots: Slots,
    clock: Clock,
    texts: Texts,
) -> tuple[Drive, ...]:
    """Return the stimuli of a scenario, each noted as what drives its input in `network`.

    Raises ConfigError when an input is driven already, or its unit measures another quantity.
    """
    drives = []
    for number, entry in enumerate(scenario.file.stimuli, 1):
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
        elif entry.csv is not None:
            where = "the stimulus" if scenario.path else "a stimulus of a system"
            _note_unit_of_column(csv_of(entry, place, scenario.path), target, where, network.warnings)
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
    return tuple(drives)


def _note_unit_of_column(column: tuple[CsvFile, Rows], target: End, where: str, warnings: list[str]) -> None:
    """Add a warning where the name of a CSV column says another unit than its input's, as `speed [km/h]`.

    `where` can a unit of measure be given.
    """
    file, rows = column
    name = file.names[rows.value]
    said = _UNIT_IN_NAME.fullmatch(name)
    if said is None or target.bare:
        return
    try:
        map_ = unit_map(dataclasses.replace(target, unit=said[1]), target, (), "", [])
    except ConfigError:
        return  # it is no unit of measure, or of another quantity
    if not map_.identity:
        warnings.append(
            f"{file.path}: column '{name}': its values are taken in [{target.unit}], the unit of "
            f'{target.name}; `unit = "{said[1]}"` in {where} converts them'
        )


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
