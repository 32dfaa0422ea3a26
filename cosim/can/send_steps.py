"""The communication steps at which a message is sent."""

from __future__ import annotations

from ..clock import nearest_step, point, steps_to
from ..errors import ConfigError
from .database import Message, prefix


def send_steps(message: Message, step_size: float, place: str = "", bus: str = "NAME") -> tuple[int, int]:
    """Return (every, first): the message is sent at the steps k >= first with (k - first) % every == 0.

    Steps are communication steps of `step_size` [s]; the first is the first communication point at or after
    the start delay. Rounding is forgiven: 50 ms are three steps of 1/60 s. Raises ConfigError, which starts
    with `place` and says what the system file can give `bus`, when the message has no cycle time or it is no
    multiple of the step.
    """
    where = f"{prefix(place)}{message.file}: message '{message.name}'"
    own = f"[buses.{bus}.messages.{message.name}]"
    if message.cycle_time is None:
        raise ConfigError(
            f"{where} has no cycle time, and a connection needs a cyclic message; give it one: `cycle_time` "
            f"[s] in {own}, or in [buses.{bus}] for all messages that have none"
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
            f"{where}: its cycle time {cycle} s is no multiple of the communication step {step_size} s; "
            f"{_nearest(cycle, every, step_size)} (`cycle_time` in {own})"
        )
    return every, steps_to(delay, step_size)


def _nearest(cycle: float, count: int, step_size: float) -> str:
    """Return a clause on the multiples of the step around a cycle time [s] that is none."""
    low = count if point(count, 0.0, step_size) < cycle else count - 1
    found = [f"{point(k, 0.0, step_size)!r} s" for k in (low, low + 1) if k > 0]
    return f"the nearest {'multiple is' if len(found) == 1 else 'are'} {' and '.join(found)}"
