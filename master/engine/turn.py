"""A unit's turn in the schedule: its actions, and what events do to its inputs."""

from __future__ import annotations

import dataclasses
import math
from typing import Literal, assert_never

import numpy as np
from numpy.typing import NDArray

from ...cosim.clock import Clock
from ...cosim.errors import RunError
from ...cosim.plan.turns import TurnTimes
from ...cosim.plan.unit_plan import UnitPlan
from ...cosim.visible import on_one_line
from ..unit import Unit
from .ending import Ending
from .routes import compile_routes


@dataclasses.dataclass(frozen=True, eq=False)
class Effect:
    """The effect of an event on an input: `value` replaces the received one, or is added to it.

    Or its `course` does, shape (n,), one value for each step from `first` on, and the last one from then on.
    Both engines match all kinds, so that mypy names them where a new one is missing.
    """

    kind: Literal["replace", "add", "follow"]
    value: float = 0.0
    course: NDArray[np.float64] = dataclasses.field(default_factory=lambda: np.zeros(1))
    first: int = 0

    def over(self, k: int, count: int) -> NDArray[np.float64]:
        """Return the values of the course at steps k to k + count - 1, shape (count,)."""
        return self.course[np.clip(np.arange(k, k + count) - self.first, 0, len(self.course) - 1)]

    def changes(self, k: int) -> bool:
        """Return True if the course has another value at step k than at the one before."""
        before, now = self.over(k - 1, 2)
        return bool(before != now)

    def steps_to_change(self, k: int) -> int | None:
        """Return the number of steps from step k to the next one at which the course changes, or None."""
        left = self.over(k, max(1, self.first + len(self.course) - k))
        changed = np.flatnonzero(left != left[0])
        return int(changed[0]) if len(changed) else None


class Turn:
    """One unit in the schedule: its actions, and the overrides and biases of its inputs by slot.

    `memory` has shape (size,); `times` are those of the unit's FMU steps. `ending` gets its request for the
    end of the run.
    """

    def __init__(
        self, unit: Unit, plan: UnitPlan, memory: memoryview[float], clock: Clock, ending: Ending
    ) -> None:
        self.unit, self.plan, self.memory, self.ending = unit, plan, memory, ending
        self.take = compile_routes(plan.routes, memory)
        self.times = TurnTimes(clock, plan.every, plan.substeps, plan.first)
        outputs = [group for group in plan.groups if group.kind != "input"]
        self.continuous = [group for group in outputs if group.kind == "continuous"]
        self.published = [
            (slice(g.slot, g.slot + len(g.variables)), memory[g.latest : g.latest + len(g.variables)])
            for g in self.continuous
        ]
        self.read = [
            (memory[slot : slot + len(g.variables)], g)
            for g in outputs
            if g.type == "Real"
            for slot in [g.latest if g.kind == "continuous" else g.slot]
        ]
        self.has_feedthrough = any(group.feedthrough for group in outputs)
        self.effects: dict[int, Effect] = {}  # by input slot

    def begin(self, k: int) -> None:
        """Apply overrides and biases to the inputs, set them, and begin the unit's step."""
        if self.effects:
            self.apply_effects(k)
        self.unit.set_inputs()
        if self.has_feedthrough:
            self.unit.get_feedthrough()
        self.unit.start_step(self.times.steps(k))

    def end(self, k: int) -> None:
        """Wait for the step and read the outputs.

        Raises RunError when one is NaN or infinite, EndedWithin when the unit ended within the step.
        """
        self.unit.finish_step()
        if self.unit.asked_end is not None:
            self._request_end(k, self.unit.asked_end)
        self.unit.get_outputs()
        self.check_finite()

    def _request_end(self, k: int, asked: float) -> None:
        clock, end = self.times.clock, k + self.plan.every
        if clock.told:
            end = min(end, clock.steps)
        self.ending.request(self.unit.name, asked, (k, end), (clock.at(k), clock.at(end)))

    def publish(self, k: int) -> None:
        """Make the outputs after the step, but for the sampled ones, those valid at the next point."""
        for valid, latest in self.published:
            self.memory[valid] = latest

    def apply_effects(self, k: int) -> None:
        """Override and bias the slots of inputs in step k."""
        for slot in self.effects:
            self.memory[slot] = self.affected(slot, self.memory[slot], k)

    def affected(self, slot: int, value: float, k: int) -> float:
        """Return what the input of a slot receives in place of a value in step k."""
        effect = self.effects.get(slot)
        if effect is None:
            return value
        match effect.kind:
            case "replace":
                return effect.value
            case "add":
                return value + effect.value
            case "follow":
                return float(effect.over(k, 1)[0])
            case _:
                assert_never(effect.kind)

    def check_finite(self) -> None:
        """Raise RunError when an output that was just read is NaN or infinite."""
        for values, group in self.read:
            # the fastest check: NaN and infinity survive the sum, which huge finite values can reach as well
            if not math.isfinite(sum(values)):
                for v, value in zip(group.variables, values, strict=True):
                    if not math.isfinite(value):
                        unit = f" {v.unit}" if v.unit else ""
                        name = f"{self.unit.name}.{v.name}"
                        raise RunError(on_one_line(f"{name} = {value}{unit}: an output must be finite"))
