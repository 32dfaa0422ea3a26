"""Events: the communication step at which each happens, and the check that it can act on what it names."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import assert_never

from ..clock import Clock
from ..errors import ConfigError, nearest
from ..interface import UnitInterface
from ..system.scenario import Bias, Event, Override, Reset, Scenario
from .plan import InputPlan


def scheduled(
    scenario: Scenario,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    clock: Clock,
) -> tuple[tuple[int, Event], ...]:
    """Return the events of a scenario in the order in which they happen, each with its communication step.

    Events of one step stay in the order of the file. Raises ConfigError as `check_event` does.
    """
    events = []
    for number, event in enumerate(scenario.file.events, 1):
        check_event(event, interfaces, inputs, f"{scenario.path}: event {number}", in_file=True)
        events.append((max(clock.step_at(event.time), 0), event))
    return tuple(sorted(events, key=lambda event: event[0]))


def check_event(
    event: Event,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    place: str,
    in_file: bool = False,
) -> None:
    """Raise ConfigError, which starts with `place`, unless the event can act on what it names.

    With `in_file` the event is a table at `place`, and the key in it follows. A value beyond the input's
    minimum or maximum is allowed: faults are what events are for.
    """

    def at(key: str) -> str:
        return f"{place}.{key}" if in_file else place

    kind = _type_of_input(event, interfaces, inputs, at("variable"))
    match event:
        case Override() | Bias():
            _check_value(event, kind, at)
        case Reset():
            pass
        case _:
            assert_never(event)


def _type_of_input(
    event: Override | Bias | Reset,
    interfaces: Mapping[str, UnitInterface],
    inputs: Mapping[str, InputPlan],
    place: str,
) -> str:
    """Return the FMI type of the event's input. Raises ConfigError when there is no such input."""
    name = event.variable
    if name not in inputs:
        raise ConfigError(
            f"{place}: there is no input '{name}'{nearest(name, inputs)}; "
            f"{event.action} acts on what a unit receives"
        )
    unit, _, variable = name.partition(".")
    return interfaces[unit].variables[variable].type


def _check_value(event: Override | Bias, kind: str, at: Callable[[str], str]) -> None:
    """Raise ConfigError unless an input of the FMI type `kind` can receive the event's value.

    `at` returns the place of a key of the event.
    """
    action, name, value = event.action, event.variable, event.value
    if not math.isfinite(value):
        raise ConfigError(f"{at('value')}: {name} needs a finite number, not {value}")
    if kind == "Boolean" and (isinstance(event, Bias) or value not in (0, 1)):
        place = at("action" if isinstance(event, Bias) else "value")
        raise ConfigError(
            f"{place}: {name} is a Boolean; it can be overridden by 0 or 1, not {action} {value}"
        )
    if kind != "Real" and value != int(value):
        raise ConfigError(f"{at('value')}: {name} is an {kind}; {action} needs a whole number, not {value}")
