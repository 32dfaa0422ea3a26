"""What one unit does in a run, as part of the plan (see `plan`).

It stands apart since it is all that the process of an isolated unit needs to know, which shall start quickly.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Literal

from ..interface import UnitInterface, VariableInfo
from ..units import Affine

if TYPE_CHECKING:
    from ..interface import Value

SlotGroupKind = Literal["input", "discrete", "continuous"]


@dataclasses.dataclass(frozen=True)
class SlotGroup:
    """Variables of one unit, FMI type and kind, in consecutive slots from `slot` on.

    `latest`: the first slot of a continuous group's values after the step. Of a continuous group the
    first `feedthrough` variables depend on an input at the same instant.
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
    """Before a unit's step the value in slot `source`, mapped, is written to the input slot `sink`."""

    source: int
    sink: int
    map: Affine = Affine()  # noqa: RUF009 - Affine is frozen, so a shared default is safe


@dataclasses.dataclass(frozen=True)
class UnitPlan:
    """One unit: what it is given before the start, its slot groups, and its routes.

    It steps at every communication step k with k % every == 0, `substeps` FMU steps each time.
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
