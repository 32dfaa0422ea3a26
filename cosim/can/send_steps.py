"""The communication steps at which a message is sent."""

from __future__ import annotations

from ..clock import nearest_step, steps_to
from ..errors import ConfigError
from .database import Message, prefix


def send_steps(message: Message, step_size: float, place: str = "") -> tuple[int, int]:
    """Return (every, first): the message is sent at the steps k >= first with (k - first) % every == 0.

    Steps are communication steps of `step_size` [s]; the first is the first communication point at or after
    the start delay. Rounding is forgiven: 50 ms are three steps of 1/60 s. Raises ConfigError, which starts
    with `place`, when the message has no cycle time or it is no multiple of the step.
    """
    where = f"{prefix(place)}{message.file}: message '{message.name}'"
    if message.cycle_time is None:
        raise ConfigError(
            f"{where} has no cycle time, and a connection needs a cyclic message; set its attribute "
            "GenMsgCycleTime [ms]"
        )
    cycle, delay = message.cycle_time, message.start_delay
    if step_size <= 0 or cycle <= 0 or delay < 0:
        raise ConfigError(
            f"{where}: cycle time {cycle} s and step size {step_size} s must be positive, start "
            f"delay {delay} s not negative"
        )
    every, whole = nearest_step(cycle, 0.0, step_size)
    if not (whole and every):
        raise ConfigError(
            f"{where}: its cycle time {cycle} s is no multiple of the communication step {step_size} s"
        )
    return every, steps_to(delay, step_size)
