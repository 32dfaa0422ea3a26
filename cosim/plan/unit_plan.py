"""The part of one unit in the plan of a run (see `plan`).

It stands apart since it is all that the process of an isolated unit loads of the plan, which must start
quickly.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..interface import UnitInterface, VariableInfo
from ..texts import Texts
from ..units.measure import Affine

if TYPE_CHECKING:
    from ..interface import Value

SlotGroupKind = Literal["input", "sampled", "continuous"]


@dataclasses.dataclass(frozen=True)
class SlotGroup:
    """Variables of one unit, FMI type and kind, in consecutive slots from `slot` on.

    An output that is not sampled is of the kind continuous, whatever its variability. `latest`: the first
    slot of a continuous group's values after the step. Of such a group the first `feedthrough` variables
    depend on an input at the same instant.
    """

    kind: SlotGroupKind
    type: str
    variables: tuple[VariableInfo, ...]
    slot: int
    latest: int = -1
    feedthrough: int = 0

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the variables."""
        return tuple(v.name for v in self.variables)


@dataclasses.dataclass(frozen=True)
class Route:
    """The way of a value into a unit: before its step, slot `source`, converted by `map`, goes to `sink`."""

    source: int
    sink: int
    map: Affine = Affine()  # noqa: RUF009 - Affine is frozen, so a shared default is safe


@dataclasses.dataclass(frozen=True)
class UnitPlan:
    """One unit: its values before the start by variable name, its slot groups, and its routes.

    It steps at every communication step k >= first with (k - first) % every == 0, `substeps` FMU steps each
    time. No step sets the inputs `free`: they keep the FMU's own values, or what they were given before the
    steps.
    """

    name: str
    fmu: str
    interface: UnitInterface
    parameters: dict[str, Value]
    start: dict[str, Value]
    every: int
    substeps: int
    groups: tuple[SlotGroup, ...]
    routes: tuple[Route, ...]
    texts: Texts = dataclasses.field(default_factory=Texts, compare=False)
    free: frozenset[str] = frozenset()
    first: int = 0

    def set_in_steps(self, group: SlotGroup) -> list[tuple[int, VariableInfo]]:
        """Return slot and variable of the inputs of a group that every step sets."""
        places = enumerate(group.variables, group.slot)
        return [(slot, v) for slot, v in places if group.kind == "input" and v.name not in self.free]


class FmuSteps(NamedTuple):
    """The FMU steps of one turn: step j begins at (first + j * advance) / divisor [s], j = 0 ... total - 1.

    They are `size` [s] long, the last one `last`; it ends at `end` [s].
    """

    first: float
    advance: float
    divisor: float
    total: int
    size: float
    last: float
    end: float

    @classmethod
    def equal(cls, time: float, size: float, count: int = 1) -> FmuSteps:
        """Return `count` steps of `size` [s], one after the other from `time` [s] on."""
        return cls(time, size, 1.0, count, size, size, time + count * size)

    def each(self) -> Sequence[tuple[float, float]]:
        """Return the time [s] at which each begins, and its size [s]."""
        if self.total == 1:
            return ((self.first / self.divisor, self.last),)
        begins = [(self.first + j * self.advance) / self.divisor for j in range(self.total)]
        return [*((begin, self.size) for begin in begins[:-1]), (begins[-1], self.last)]

    def ends(self) -> Sequence[float]:
        """Return the time [s] at which each ends."""
        return [*((self.first + j * self.advance) / self.divisor for j in range(1, self.total)), self.end]
