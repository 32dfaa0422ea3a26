"""The needs of a system from a unit: the inputs it drives, the outputs it takes, the parameters it sets."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal

from ..interface import UnitInterface, VariableInfo
from ..system.figure_spec import FigureSpec
from ..system.scenario import Scenario
from ..system.selection import figure_spec, metric_specs
from ..system.system import Connection, System
from .mapping import optional_statuses, without_status

Role = Literal["input", "output", "parameter"]
"""The part that a variable plays at a unit, as the system sees it."""

ROLES: tuple[Role, ...] = ("input", "output", "parameter")


@dataclasses.dataclass(frozen=True)
class Requirement:
    """A variable that the system needs: its `role` at the unit, and who gives, takes or sets it (`needed`).

    `optional`: only connections and lines of a figure need it that say so, and it may be missing.
    `variable` is as the unit that is there now declares it: unit of measure, type, range, description.
    """

    name: str
    role: Role
    needed: tuple[str, ...]
    variable: VariableInfo
    optional: bool = False


def requirements(
    system: System, scenario: Scenario, unit: str, present: UnitInterface
) -> tuple[Requirement, ...]:
    """Return the needs of a system in a scenario from a unit whose present FMU has the interface `present`.

    Inputs first, then outputs, then parameters, each in the order in which the system names them.
    """
    found: dict[tuple[Role, str], list[str]] = {}
    for role, name, needed in _uses(system, scenario, unit):
        found.setdefault((role, name), []).append(needed)
    needed_anyway = {(role, name) for role, name, _ in _uses(*_without_optional(system, scenario), unit)}
    return tuple(
        Requirement(
            name,
            role,
            tuple(dict.fromkeys(found[role, name])),
            present.variables[name],
            (role, name) not in needed_anyway,
        )
        for wanted in ROLES
        for role, name in found
        if role == wanted and name in present.variables
        # a figure that shows an input of the unit shows what drives it
        if not (role == "output" and present.variables[name].causality == "input")
    )


def lacking(system: System, scenario: Scenario, unit: str, offer: UnitInterface) -> list[str]:
    """Return all that a system in this scenario needs of a unit and that `offer` does not have.

    Each is a clause: the variable and who gives or takes it. Units that the scenario leaves out need nothing.
    """
    own, out = f"{unit}.", set(scenario.file.leave_out)
    used: list[tuple[str, str]] = []
    system, scenario = _without_optional(system, scenario)
    for c in system.file.connect:
        takers = [to for to in c.to if _unit(to) not in out]
        if _unit(c.source) not in out and (takers or c.via):
            used += _ends(c, takers)
    used += _statuses(system)
    used += [(stimulus.to, f"stimulus of {scenario.name}") for _, stimulus in scenario.file.stimuli]
    used += [(name, f"CAN log of {scenario.name}") for _, log in scenario.file.can_logs for name in log.to]
    spec = figure_spec(system, scenario)
    shown = [s.name for panel in spec.panels for s in panel.signals] if spec else []
    shown += [name for metric in metric_specs(system, scenario) for name in metric.all_signals]
    used += [(name, "figure or metrics") for name in shown]
    found: dict[str, list[str]] = {}
    for name, needed in used:
        if name.startswith(own) and name.removeprefix(own) not in offer.variables:
            found.setdefault(name.removeprefix(own), []).append(needed)
    return [f"'{name}' ({'; '.join(dict.fromkeys(needed))})" for name, needed in found.items()]


def _without_optional(system: System, scenario: Scenario) -> tuple[System, Scenario]:
    """Return both with those connections and lines of figures only that cannot be left out.

    A connection can where no value in the files needs it.
    """
    tables = ({u: entry.parameters for u, entry in system.file.units.items()}, scenario.file.parameters)
    given = {f"{unit}.{name}": x for table in tables for unit, xs in table.items() for name, x in xs.items()}

    def is_needed(c: Connection) -> bool:
        return not c.optional or any(given.get(name) == value for name, value in c.needed_where.items())

    needed = [c for c in system.file.connect if is_needed(c)]
    free = {name for own in optional_statuses(system.file) for name in own.status}
    of_system = system.file.model_copy(
        update={
            "connect": needed,
            "figure": _needed(system.file.figure),
            "buses": without_status(system.file.buses, free, []),
        }
    )
    of_scenario = scenario.file.model_copy(update={"figure": _needed(scenario.file.figure)})
    return dataclasses.replace(system, file=of_system), dataclasses.replace(scenario, file=of_scenario)


def _needed(spec: FigureSpec | None) -> FigureSpec | None:
    return spec and spec.without(spec.optional().__contains__)


def _ends(c: Connection, takers: Sequence[str]) -> list[tuple[str, str]]:
    """Return the variables at the ends of a connection, each with what is at the other end."""
    via = f" over {c.via}" if c.via else ""
    taken = f"to {', '.join(takers)}{via}" if takers else f"to {c.via}"
    return [*((to, f"from {c.source}{via}") for to in takers), (c.source, taken)]


def _statuses(system: System) -> Iterator[tuple[str, str]]:
    """Yield each input that receives the status of a message, with that."""
    for bus, entry in system.file.buses.items():
        for name, own in entry.messages.items():
            yield from ((full, f"the status of {bus}.{name}") for full in own.status)


def _unit(variable: str) -> str:
    return variable.partition(".")[0]


def _uses(system: System, scenario: Scenario, unit: str) -> Iterable[tuple[Role, str, str]]:
    """Yield role, name and use for each place that names a variable of the unit."""
    own = f"{unit}."
    for c in system.file.connect:
        for name, other_end in _ends(c, c.to):
            if name.startswith(own):
                yield "output" if name == c.source else "input", name.removeprefix(own), other_end
    for name, source in _statuses(system):
        if name.startswith(own):
            yield "input", name.removeprefix(own), source
    for _, log in scenario.file.can_logs:
        for name in log.to:
            if name.startswith(own):
                yield "input", name.removeprefix(own), f"CAN log of {scenario.name}"
    for _, stimulus in scenario.file.stimuli:
        if stimulus.to.startswith(own):
            yield "input", stimulus.to.removeprefix(own), f"stimulus of {scenario.name}"
    for name in _shown(system, scenario):
        if name.startswith(own):
            yield "output", name.removeprefix(own), "figure or metrics"
    given: tuple[tuple[str, Mapping[str, object]], ...] = (
        ("set by the system", system.file.units[unit].parameters),
        (f"set by {scenario.name}", scenario.file.parameters.get(unit, {})),
    )
    for setter, values in given:
        for name, value in values.items():
            yield "parameter", name, f"{setter}: {value}"


def _shown(system: System, scenario: Scenario) -> Iterable[str]:
    for file in (system.file, scenario.file):
        if file.figure is not None:
            yield from (s.name for panel in file.figure.panels for s in panel.signals)
        for spec in file.metrics:
            yield from spec.all_signals
