"""A recorded variable: its name, unit of measure, type and states."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class ResultVariable:
    """A column of results: its name `unit.variable` and what its FMU declares of it.

    `type` is Real, Integer, Boolean, Enumeration or String; `unit` a name of a unit of measure ("" for none);
    `items` the (value, name) pairs of an enumeration; `difference` says that it is a difference of absolute
    quantities, as of two temperatures.
    """

    name: str
    unit: str = ""
    type: str = "Real"
    causality: str = "output"
    variability: str = "continuous"
    description: str = ""
    items: tuple[tuple[int, str], ...] = ()
    difference: bool = False

    @property
    def held(self) -> bool:
        """Return whether it keeps its value from one communication point to the next.

        So do inputs (nobody writes them in between) and all that is sampled or not Real.
        """
        return self.type != "Real" or self.causality == "input" or self.variability != "continuous"
