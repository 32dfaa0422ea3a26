"""The interface of a unit in a run. A loaded FMU has it; so have the units of tests, written in Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..cosim.errors import RunError
from ..cosim.interface import UnitInterface, Value
from ..cosim.plan.unit_plan import FmuSteps, UnitPlan


def floats(memory: NDArray[np.float64]) -> memoryview[float]:
    """Return the memory, shape (size,), as a view whose items are Python floats.

    One by one they are read and written three times faster than those of a numpy array.
    """
    return memory.data.cast("B").cast("d")


NO_VALUES: Mapping[str, Value] = MappingProxyType({})
"""No variable is set."""


class UnitError(RunError):
    """A call of a unit failed; the message names unit, call, status, and the unit's last log messages."""


class Unit(Protocol):
    """A unit in a run: `bind` gives it memory, of which it reads its inputs and where it writes its outputs.

    The calls come in this order:

    1. `bind` once, then `enter_initialization` with parameters, start values and first inputs
    2. `set` of inputs and `get` of outputs, any number, then `exit_initialization`
    3. for each of its turns: `set_inputs`, `get_feedthrough`, `start_step`, `finish_step`, `get_outputs`
    4. `terminate`, then `free`; after an error `free` alone

    Every call raises UnitError when the unit reports anything worse than a warning. Classes that implement a
    unit document only what they add.
    """

    name: str
    interface: UnitInterface
    apart: bool
    """True for a unit in a process of its own."""

    @property
    def asked_end(self) -> float | None:
        """The time [s] at which it asked to end the simulation, NaN if it does not tell; None: it did not."""

    @property
    def warnings(self) -> int:
        """The number of calls that ended with a warning and of log messages of status Warning."""

    @property
    def warned(self) -> Mapping[str, int]:
        """The first text of each of the first kinds of such messages, and their number (see `warned`)."""

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """Keep the run's memory, shape (size,), and the slots of this unit's slot groups in it."""

    def enter_initialization(
        self,
        start_time: float,
        stop_time: float | None,
        values: Mapping[str, Value] = NO_VALUES,
        inputs: Mapping[str, Value] = NO_VALUES,
    ) -> str:
        """Set up the experiment (times in s), then set variables, and enter initialization mode.

        `values` are parameters and start values, `inputs` the first values of inputs that are known before
        any output is; all inputs are set again afterwards. Return a sentence for the user where the unit
        takes inputs later only, else "".
        """

    def exit_initialization(self) -> None:
        """Leave initialization mode: parameters are fixed from now on."""

    def get(self, name: str) -> Value:
        """Return the value of any variable."""

    def set(self, name: str, value: Value) -> None:
        """Set a variable that may be set now."""

    def set_inputs(self) -> None:
        """Set the inputs of the FMU from the slots of its input slot groups."""

    def get_feedthrough(self) -> None:
        """Read the outputs that depend on inputs at the same instant into their slots, valid and latest.

        A unit in a process of its own reads them with the step that follows, so that they are written when
        that step is done.
        """

    def start_step(self, steps: FmuSteps) -> None:
        """Begin the FMU steps of a turn.

        A unit in this process does them at once, one in a process of its own while the caller goes on.
        """

    def finish_step(self) -> None:
        """Wait until the steps that were begun are done."""

    def get_outputs(self) -> None:
        """Read the sampled outputs into their slots, the others into their latest slots."""

    def terminate(self) -> None:
        """End the run orderly."""

    def free(self) -> None:
        """Release everything; may be called twice."""


def terminate(units: Iterable[Unit]) -> None:
    """Terminate all units, also those behind one that cannot be. Raises the error of the first of these."""
    failures: list[RunError] = []
    for unit in units:
        try:
            unit.terminate()
        except RunError as error:
            failures.append(error)
    if failures:
        raise failures[0]
