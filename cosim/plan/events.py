"""Events: the communication step at which each happens, and the check that it can act on what it names."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import assert_never

import numpy as np

from ..clock import Clock
from ..errors import ConfigError, nearest, short
from ..interface import UnitInterface, VariableInfo
from ..row_store import Array
from ..system.scenario import Bias, Event, Override, Reset, Scenario, Set
from ..system.values import as_double, checked, of_type
from ..texts import Texts
from .plan import InputPlan


def scheduled(
    scenario: Scenario,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    clock: Clock,
    texts: Texts,
) -> tuple[tuple[int, Event], ...]:
    """Return the events of a scenario in the order in which they happen, each with its communication step.

    Events of one step stay in the order of the file. Raises ConfigError as `check_event` does.
    """
    events = []
    for number, event in enumerate(scenario.file.events, 1):
        place = f"{scenario.path}: event {number}"
        event = check_event(event, interfaces, inputs, texts, place, in_file=True)
        events.append((max(clock.step_at(event.time), 0), event))
    return tuple(sorted(events, key=lambda event: event[0]))


def check_event(
    event: Event,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    texts: Texts,
    place: str,
    in_file: bool = False,
) -> Event:
    """Return the event with its value as a run keeps it: a double, or that of a parameter in its type.

    The double of a text is its number in `texts`.

    Raises ConfigError, which starts with `place`, unless it can act on what it names. With `in_file` the
    event is a table at `place`, and the key in it follows. A value beyond the input's minimum or maximum is
    allowed, for faults are what events are for, but not what is set.
    """

    def at(key: str) -> str:
        return f"{place}.{key}" if in_file else place

    match event:
        case Override():
            variable = _input_of(event, interfaces, inputs, at("variable"))
            return _with_value(event, variable, at("value"), texts)
        case Bias():
            _check_bias(event, _input_of(event, interfaces, inputs, at("variable")), at)
            return event
        case Reset():
            _input_of(event, interfaces, inputs, at("variable"))
            return event
        case Set():
            variable = _settable(event, interfaces, inputs, at("variable"))
            return _with_set_value(event, variable, at("value"), texts)
        case _:
            assert_never(event)


def checked_course(
    name: str,
    values: Sequence[float] | Array,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
) -> Array:
    """Return the values that an input is to receive, one in each step, as doubles, shape (n,).

    Raises ConfigError unless it is a Real input, and all are finite numbers that it can have.
    """
    variable = _named_input(name, "follow", interfaces, inputs, "follow")
    if variable.type != "Real":
        raise ConfigError(f"follow: {name} is of type {variable.type}; override sets one value of it")
    try:
        course: Array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ConfigError(f"follow: {name} needs a list of numbers, not {short(values)}") from error
    if course.ndim != 1 or not course.size:
        raise ConfigError(f"follow: {name} needs at least one number, in one row: shape {course.shape}")
    full = dataclasses.replace(variable, name=name)
    for extreme in (course.min(), course.max()):  # NaN is both
        of_type(float(extreme), full, "follow")
    return course


def _input_of(
    event: Override | Bias | Reset,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    place: str,
) -> VariableInfo:
    """Return the event's input. Raises ConfigError when there is none of its name."""
    return _named_input(event.variable, event.action, interfaces, inputs, place)


def _named_input(
    name: str,
    action: str,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    place: str,
) -> VariableInfo:
    if name not in inputs:
        raise ConfigError(
            f"{place}: there is no input '{name}'{nearest(name, inputs)}; "
            f"{action} acts on what a unit receives"
        )
    unit, _, variable = name.partition(".")
    return interfaces[unit].variables[variable]


def _with_value(event: Override, variable: VariableInfo, place: str, texts: Texts) -> Override:
    """Return the event with its value as a double. Raises ConfigError for one that the input cannot have."""
    value = of_type(event.value, dataclasses.replace(variable, name=event.variable), place)
    return event.model_copy(update={"value": as_double(variable, value, place, texts)})


def _settable(
    event: Set, interfaces: Mapping[str, UnitInterface], inputs: Mapping[str, InputPlan], place: str
) -> VariableInfo:
    """Return the tunable parameter or free input that is set. Raises ConfigError for any other variable."""
    name = event.variable
    unit, _, of_unit = name.partition(".")
    if unit not in interfaces:
        raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, interfaces)}")
    known = interfaces[unit].variables.get(of_unit)
    settable = ("input", "parameter") if known is None else (known.causality,)
    variable = interfaces[unit].require(unit, of_unit, settable, place)
    if variable.causality == "input" and inputs[name].driver:
        raise ConfigError(
            f"{place}: {name} is driven by {inputs[name].driver}; use override to take its place"
        )
    if variable.causality == "parameter" and variable.variability != "tunable":
        raise ConfigError(
            f"{place}: {name} is a {variable.variability} parameter, which no run changes; inputs that "
            "nothing drives and parameters that the FMU declares tunable can be set in a run"
        )
    if variable.causality not in ("input", "parameter"):
        raise ConfigError(
            f"{place}: {name} is of causality {variable.causality}; inputs that nothing drives and tunable "
            "parameters can be set in a run"
        )
    return variable


def _with_set_value(event: Set, variable: VariableInfo, place: str, texts: Texts) -> Set:
    """Return the event with its value, an input's as a double. Raises ConfigError for one out of range."""
    value = checked(event.value, dataclasses.replace(variable, name=event.variable), place)
    if variable.causality == "input":
        value = as_double(variable, value, place, texts)
    return event.model_copy(update={"value": value})


def _check_bias(event: Bias, variable: VariableInfo, at: Callable[[str], str]) -> None:
    """Raise ConfigError unless a bias can act on the input. `at` returns the place of a key of the event."""
    name, value, kind = event.variable, event.value, variable.type
    if kind in ("Boolean", "String"):
        raise ConfigError(f"{at('action')}: {name} is a {kind}, to which nothing can be added")
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not (number and abs(value) <= sys.float_info.max):
        raise ConfigError(f"{at('value')}: {name} needs a finite number, not {short(value)}")
    if kind != "Real" and value != int(value):
        raise ConfigError(f"{at('value')}: {name} is an {kind}; bias needs a whole number, not {value}")
