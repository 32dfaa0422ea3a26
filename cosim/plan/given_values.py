"""The values that units start with: of parameters and of start values, from options, scenario and system."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import ConfigError, nearest, short
from ..interface import UnitInterface, Value
from ..system.run_options import RunOptions
from ..system.scenario import Scenario
from ..system.system import System, UnitEntry
from ..system.values import as_double, checked
from ..texts import Texts
from .network import Network

Started = dict[str, dict[str, tuple[str, Value]]]
"""Start values that options give, by unit and variable, each with its place in messages."""


def all_parameters(
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


def by_kind(
    options: RunOptions, interfaces: Mapping[str, UnitInterface], network: Network
) -> tuple[dict[str, Value], Started]:
    """Return the parameters among the values by "unit.variable" that options give, and the start values.

    The option `parameters` may give both, `start` those alone. Raises ConfigError for a variable that both
    give, and for an input that something drives, in which a start value would not stay.
    """
    named, started = dict(options.get("parameters") or {}), Started()
    for name in tuple(named):
        unit, _, variable = name.partition(".")
        known = interfaces[unit].variables.get(variable) if unit in interfaces else None
        if known is not None and known.takes_start:
            _check_undriven(name, f"parameter {name}", network)
            started.setdefault(unit, {})[variable] = (f"parameter {name}", named.pop(name))
    for name, value in (options.get("start") or {}).items():
        unit, _, variable = name.partition(".")
        place = f"start {name}"
        if unit not in interfaces:
            raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, interfaces)}")
        if variable in started.get(unit, {}):
            before = started[unit][variable][1]
            raise ConfigError(
                f"{place}: {short(value)} is for {name}, which is given among the parameters already: "
                f"{short(before)}"
            )
        _check_is_none(unit, variable, interfaces[unit], place)
        _check_undriven(name, place, network)
        started.setdefault(unit, {})[variable] = (place, value)
    return named, started


def _check_is_none(unit: str, name: str, interface: UnitInterface, place: str) -> None:
    """Raise ConfigError for a parameter, which has a value in the whole run and not a start alone."""
    found = interface.variables.get(name)
    if found is not None and found.causality == "parameter":
        raise ConfigError(f"{place}: {unit}.{name} is a parameter, which --set sets, in Python `parameters`")


def _check_undriven(name: str, place: str, network: Network) -> None:
    if name in network.inputs and network.inputs[name].driver:
        raise ConfigError(f"{place}: the input is driven by {network.inputs[name].driver}")


def all_starts(
    system: System,
    scenario: Scenario,
    unit: str,
    entry: UnitEntry,
    interface: UnitInterface,
    started: Started,
) -> dict[str, Value]:
    """Return the start values of a unit's variables by name: an option's, else the scenario's or system's.

    Raises ConfigError naming place, rule and value.
    """
    starts = {}
    given = {name: (f"{system.keys_of(unit)}start.{name}", value) for name, value in entry.start.items()}
    for name, value in scenario.file.start.get(unit, {}).items():
        given[name] = (f"{scenario.path}: start.{unit}.{name}", value)
    given |= started.get(unit, {})
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
