"""What is measured: a ring of equal units, and the reference solution that every result is compared with.

Unit i receives the outputs of unit i - 1. The first one has gain -1, so that the loop is a stable oscillation
round the constant that the biases make: values stay in a range of a few units and never fade to denormals.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

import numpy as np
from numpy.typing import NDArray

STEP_SIZE = 0.01  # s

Kind = Literal["c", "python"]
Array = NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Case:
    """A ring of `units` units with `signals` signals from each to the next, over `steps` steps.

    `channel`: each connection crosses a CAN bus (quantized to 2^-10, in [-30, 30]); `record`: every
    output is recorded at every step.
    """

    kind: Kind
    units: int
    steps: int
    signals: int = 1
    channel: bool = False
    record: bool = True

    @property
    def name(self) -> str:
        """For tables and messages."""
        parts = [f"{self.units} {self.kind} units", f"{self.signals} signals" if self.signals > 1 else ""]
        parts += ["channel" if self.channel else "", "recorded" if self.record else "not recorded"]
        return ", ".join(part for part in parts if part)

    def gain(self, unit: int) -> float:
        """The gain of a unit."""
        return -1.0 if unit == 0 else 1.0

    def parameters(self, unit: int) -> dict[str, float]:
        """All parameters of a unit."""
        return {"gain": self.gain(unit)} | {f"bias{s}": self.bias(unit, s) for s in range(self.signals)}

    def bias(self, unit: int, signal: int) -> float:
        """The bias of a lag."""
        return 1.0 + 0.25 * unit / self.units + 0.125 * signal / self.signals


def reference(case: Case, order: Literal["jacobi", "gauss_seidel"]) -> Array:
    """The outputs y of all units after each step, shape (steps, units, signals), computed with numpy.

    `jacobi`: all units receive what was there at the start of the step; `gauss_seidel`: a unit receives what
    its predecessor has just computed.
    """
    gain = np.array([case.gain(i) for i in range(case.units)])
    bias = np.array([[case.bias(i, s) for s in range(case.signals)] for i in range(case.units)])
    y = np.zeros((case.units, case.signals))
    found = np.empty((case.steps, *y.shape))
    for k in range(case.steps):
        if order == "jacobi":
            u = np.roll(y, 1, axis=0)
            u = quantized(u) if case.channel else u
            y = y + STEP_SIZE * (gain[:, None] * u + bias - y)
        else:
            for i in range(case.units):
                u = quantized(y[i - 1]) if case.channel else y[i - 1]
                y[i] = y[i] + STEP_SIZE * (gain[i] * u + bias[i] - y[i])
        found[k] = y
    return found


def quantized(x: Array) -> Array:
    """What the bus makes of a value: saturated to [-30, 30], rounded to 2^-10, a half away from zero."""
    return np.copysign(np.floor(np.abs(np.clip(x, -30.0, 30.0)) * 1024.0 + 0.5) / 1024.0, x)
