"""The slot of each value of a run in memory."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping

from ..interface import UnitInterface, VariableInfo
from .recorded import Record, recorded_names
from .unit_plan import SlotGroup


@dataclasses.dataclass
class Slots:
    """The `size` slots given out so far. `valid` and `latest` map (unit, variable) to slots (see `plan`)."""

    size: int = 0
    valid: dict[tuple[str, str], int] = dataclasses.field(default_factory=dict)
    latest: dict[tuple[str, str], int] = dataclasses.field(default_factory=dict)
    groups: dict[str, list[SlotGroup]] = dataclasses.field(default_factory=dict)

    def take(self, count: int) -> int:
        """Return the first of `count` new slots."""
        first = self.size
        self.size += count
        return first

    def shown(self, columns: Iterable[tuple[str, VariableInfo]]) -> tuple[int, ...]:
        """Return the slots that show these variables at the communication point."""
        return tuple(self.valid[unit, v.name] for unit, v in columns)

    def source(self, unit: str, name: str, every: int) -> int:
        """Return the slot that a receiver reads of an output of a unit with a period of `every` steps.

        Within the same step it is the latest value. A unit with every > 1 has stepped beyond the next
        communication point, so receivers read the valid value.
        """
        return self.latest.get((unit, name), self.valid[unit, name]) if every == 1 else self.valid[unit, name]


def allot(
    interfaces: Mapping[str, UnitInterface], record: Record, needed: set[str]
) -> tuple[Slots, list[tuple[str, VariableInfo]]]:
    """Return slots for every input, and every recorded or `needed` (connected) output; and what is recorded.

    The second are pairs of a unit's name and a variable, in the units' order. Raises ConfigError as
    `recorded_names` does.
    """
    recorded = recorded_names(interfaces, record)
    slots = Slots()
    variables = {unit: _slotted(unit, interface, recorded | needed) for unit, interface in interfaces.items()}
    for unit, (inputs, outputs) in variables.items():
        driven = {v.name for v in inputs}
        kinds = [("input", inputs, 0), *_outputs_by_kind(outputs, driven)]
        slots.groups[unit] = [
            group
            for kind, members, feedthrough in kinds
            for group in _slot_groups(slots, unit, kind, members, feedthrough)
        ]
    for unit, groups in slots.groups.items():  # behind all recorded slots, so that a row is one piece
        slots.groups[unit] = [_with_latest(slots, unit, group) for group in groups]
    columns = [
        (unit, v)
        for unit, (inputs, outputs) in variables.items()
        for v in (*inputs, *outputs)
        if f"{unit}.{v.name}" in recorded
    ]
    return slots, columns


def _slotted(
    unit: str, interface: UnitInterface, wanted: set[str]
) -> tuple[list[VariableInfo], list[VariableInfo]]:
    """Return the inputs, and the outputs and local variables that are `wanted` as "unit.variable"."""
    every = interface.variables.values()
    inputs = [v for v in every if v.causality == "input"]
    outputs = [v for v in every if v.causality in ("output", "local") and f"{unit}.{v.name}" in wanted]
    return inputs, outputs


def _outputs_by_kind(
    outputs: list[VariableInfo], inputs: set[str]
) -> list[tuple[str, list[VariableInfo], int]]:
    """Return slot groups to be made: kind, members, and how many members depend on an input at once."""
    sampled = [v for v in outputs if v.sampled]
    continuous = [v for v in outputs if not v.sampled]
    through = [v for v in continuous if v.depends and not inputs.isdisjoint(v.depends)]
    early = {v.name for v in through}
    rest = [v for v in continuous if v.name not in early]
    return [("sampled", sampled, 0), ("continuous", [*through, *rest], len(through))]


def _slot_groups(
    slots: Slots, unit: str, kind: str, variables: list[VariableInfo], feedthrough: int
) -> list[SlotGroup]:
    """Return the groups of one kind, one for each FMI type, with slots that stand side by side.

    The first `feedthrough` variables depend on an input at once; they come first in each group too.
    """
    made = []
    for types in (("Real",), ("Integer", "Enumeration"), ("Boolean",), ("String",)):
        members = tuple(v for v in variables if v.type in types)
        if not members:
            continue
        first = slots.take(len(members))
        slots.valid |= {(unit, v.name): first + i for i, v in enumerate(members)}
        early = sum(v.type in types for v in variables[:feedthrough])
        made.append(SlotGroup(kind, types[0], members, first, feedthrough=early))  # type: ignore[arg-type] # a literal
    return made


def _with_latest(slots: Slots, unit: str, group: SlotGroup) -> SlotGroup:
    """Return the group with slots for its values after the step, if it is continuous."""
    if group.kind != "continuous":
        return group
    latest = slots.take(len(group.variables))
    slots.latest |= {(unit, v.name): latest + i for i, v in enumerate(group.variables)}
    return dataclasses.replace(group, latest=latest)
