"""The communication steps at which a message is sent."""

from __future__ import annotations

import math
from fractions import Fraction

from ..errors import ConfigError
from .database import Message, prefix


def send_steps(message: Message, step_size: float, place: str = "") -> tuple[int, int]:
    """Return (every, first): the message is sent at the steps k >= first with (k - first) % every == 0.

    Steps are communication steps of `step_size` [s]; the first is the first communication point at or after
    the start delay. Exact: 10 ms is once in a step of 0.01 s. Raises ConfigError, which starts with `place`,
    when the message has no cycle time or it is no multiple of the step.
    """
    where = f"{prefix(place)}{message.file}: message '{message.name}'"
    if message.cycle_time is None:
        raise ConfigError(
            f"{where} has no cycle time, and a connection needs a cyclic message; set its attribute "
            "GenMsgCycleTime [ms]"
        )
    step, cycle, delay = (_decimal(t) for t in (step_size, message.cycle_time, message.start_delay))
    if step <= 0 or cycle <= 0 or delay < 0:
        raise ConfigError(
            f"{where}: cycle time {message.cycle_time} s and step size {step_size} s must be positive, "
            f"start delay {message.start_delay} s not negative"
        )
    every = cycle / step
    if every.denominator != 1:
        raise ConfigError(
            f"{where}: its cycle time {message.cycle_time} s is no multiple of the communication step "
            f"{step_size} s"
        )
    return every.numerator, math.ceil(delay / step)


def _decimal(seconds: float) -> Fraction:
    """Return the decimal number that was written: 0.01 is 1/100, not the nearest double."""
    return Fraction(str(float(seconds)))
