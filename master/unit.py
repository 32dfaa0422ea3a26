"""What the algorithms ask of a unit. A loaded FMU is one; tests use units written in Python."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..cosim.errors import RunError
from ..cosim.interface import UnitInterface, Value
from ..cosim.plan.unit_plan import UnitPlan


def floats(memory: NDArray[np.float64]) -> memoryview[float]:
    """The memory as a view whose items are Python floats: three times faster than numpy's one by one."""
    return memory.data.cast("B").cast("d")


class UnitError(RunError):
    """A unit failed. The message names the unit, what was asked, the status and the unit's own last words."""


class Unit(Protocol):
    """A unit in a run. The calls come in this order:

    1. `bind` once, then `set` of parameters and starts, then `enter_initialization(start, stop)`
    2. `set` of inputs and `get` of outputs, any number, then `exit_initialization`
    3. for each of its turns: `set_inputs`, `get_feedthrough`, `start_step`, `finish_step`, `get_outputs`
    4. `terminate`, then `free`; after an error `free` alone

    Every call raises UnitError when the unit reports anything worse than a warning.
    """

    name: str
    interface: UnitInterface

    @property
    def warnings(self) -> int:
        """How often a call ended with a warning or a message of status Warning came."""

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """Keep the run's memory, shape (size,), and the slots of this unit's slot groups in it."""

    def enter_initialization(self, start_time: float, stop_time: float | None) -> None:
        """Set the experiment up (times in s) and enter initialization mode."""

    def exit_initialization(self) -> None:
        """Leave initialization mode: parameters are fixed from now on."""

    def get(self, name: str) -> Value:
        """The value of any variable."""

    def set(self, name: str, value: Value) -> None:
        """Set any variable that may be set now."""

    def set_inputs(self) -> None:
        """Give the unit its inputs from the slots of its input slot groups."""

    def get_feedthrough(self) -> None:
        """Read the outputs that depend on inputs at the same instant into their slots, valid and latest.

        A unit in a process of its own does so with the step that follows: they are there when that is done.
        """

    def start_step(self, time: float, step_size: float, count: int) -> None:
        """Begin `count` steps of `step_size`, the first from `time` on, both in s.

        A unit in this process does them at once, one in a process of its own while the caller goes on.
        """

    def finish_step(self) -> None:
        """Wait until the steps that were begun are done."""

    def get_outputs(self) -> None:
        """Read the discrete outputs into their slots, the continuous ones into their latest slots."""

    def terminate(self) -> None:
        """End the run orderly."""

    def free(self) -> None:
        """Release everything; may be called twice."""
