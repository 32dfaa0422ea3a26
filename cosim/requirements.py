"""What a system needs from a unit: the inputs it gives, the outputs it takes, the parameters it sets."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Literal

from .interface import UnitInterface, VariableInfo
from .scenario import Scenario
from .system import System

Role = Literal["input", "output", "parameter"]


@dataclasses.dataclass(frozen=True)
class Requirement:
    """A variable that the system needs: its `role` at the unit, and `why` (who gives, takes or sets it).

    `variable` is what the unit that is there now declares: unit of measure, type, range, description.
    """

    name: str
    role: Role
    why: tuple[str, ...]
    variable: VariableInfo


def requirements(
    system: System, scenario: Scenario, unit: str, present: UnitInterface
) -> tuple[Requirement, ...]:
    """What the system in this scenario needs from a unit whose present FMU has the interface `present`.

    Inputs first, then outputs, then parameters, each in the order in which the system names them.
    """
    found: dict[tuple[Role, str], list[str]] = {}
    for role, name, why in _uses(system, scenario, unit):
        found.setdefault((role, name), []).append(why)
    order: tuple[Role, ...] = ("input", "output", "parameter")
    return tuple(
        Requirement(name, role, tuple(dict.fromkeys(found[role, name])), present.variables[name])
        for wanted in order
        for role, name in found
        if role == wanted and name in present.variables
        # a figure that shows an input of the unit shows what drives it
        if not (role == "output" and present.variables[name].causality == "input")
    )


def _uses(system: System, scenario: Scenario, unit: str) -> Iterable[tuple[Role, str, str]]:
    """(role, name, why) for each place that names a variable of the unit."""
    own = f"{unit}."
    for c in system.file.connect:
        via = f" over {c.via}" if c.via else ""
        for to in c.to:
            if to.startswith(own):
                yield "input", to.removeprefix(own), f"from {c.source}{via}"
        if c.source.startswith(own):
            yield (
                "output",
                c.source.removeprefix(own),
                f"to {', '.join(c.to) or c.via}{via if c.to else ''}",
            )
    for stimulus in scenario.file.stimuli:
        if stimulus.to.startswith(own):
            yield "input", stimulus.to.removeprefix(own), f"stimulus of {scenario.name}"
    for name in _shown(system, scenario):
        if name.startswith(own):
            yield "output", name.removeprefix(own), "figure or metrics"
    given: tuple[tuple[str, Mapping[str, object]], ...] = (
        ("set by the system", system.file.units[unit].parameters),
        (f"set by {scenario.name}", scenario.file.parameters.get(unit, {})),
    )
    for why, values in given:
        for name, value in values.items():
            yield "parameter", name, f"{why}: {value}"


def _shown(system: System, scenario: Scenario) -> Iterable[str]:
    for file in (system.file, scenario.file):
        if file.figure is not None:
            yield from (s.name for panel in file.figure.panels for s in panel.signals)
        for spec in file.metrics:
            yield from spec.all_signals
