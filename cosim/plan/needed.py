"""Connections that a run may do without, unless the values of its parameters need them (`needed_where`)."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value
from ..system.scenario import Scenario
from ..system.system import Connection, System
from ..system.values import of_type
from .plan import Plan
from .unit_plan import UnitPlan


def check_needed(system: System, plan: Plan, scenario: Scenario, others: Collection[str]) -> None:
    """Raise ConfigError for an input without a driver that the parameters of this run need.

    `system` has the connections as its file names them, the left-out ones among them; `others` are the units
    with an FMU that is not the system's own: a parameter that it lacks needs nothing. An input that an event
    of the scenario sets, or that has a start value of the run's, is known to be without. Raises ConfigError
    too for names and values of `needed_where` that are none.
    """
    events = {name for event in scenario.file.events for name in event.needs}
    units = {unit.name: unit for unit in plan.units}
    for i, connection in enumerate(system.file.connect, 1):
        place = f"{system.path}: connect {i}.needed_where"
        met = list(_met(connection, system, units, others, place))
        if not met:
            continue
        for name in connection.to:
            driven = plan.inputs.get(name)
            unit, _, variable = name.partition(".")
            if driven is None or driven.driver or name in events or variable in units[unit].start:
                continue
            start = _start(units[unit].interface, variable)
            raise ConfigError(
                f"nothing drives {name}, since {connection.source} is left out: it would be {start} for the "
                f"whole run, and with {met[0]} it is needed; map {connection.source}, or set another "
                f"{met[0].partition(' = ')[0]}"
            )


def _met(
    connection: Connection,
    system: System,
    units: Mapping[str, UnitPlan],
    others: Collection[str],
    place: str,
) -> Iterator[str]:
    """Yield "unit.parameter = value" for each condition of a connection that the run's values meet."""
    for name, wanted in connection.needed_where.items():
        unit, _, parameter = name.partition(".")
        if unit not in system.file.units:
            raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, system.file.units)}")
        known = units.get(unit)
        if known is None or (unit in others and parameter not in known.interface.variables):
            continue
        variable = known.interface.require(unit, parameter, ("parameter",), place)
        value: Value | None = known.parameters.get(parameter, variable.start)
        if value is not None and of_type(value, variable, place) == of_type(wanted, variable, place):
            yield f"{name} = {wanted}"


def _start(interface: UnitInterface, name: str) -> str:
    variable = interface.variables[name]
    start = "its FMU's own start value" if variable.start is None else str(variable.start)
    return f"{start} {variable.unit}".rstrip()
