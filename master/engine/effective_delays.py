"""The time from the sampling of a value on a bus to the step of its receiver that uses it first."""

from __future__ import annotations

import numpy as np

from ...cosim.can.wire import tables as T
from ...cosim.clock import picoseconds
from ...cosim.plan.plan import MessagePlan, Plan
from ...cosim.plan.readers import Reader, readers
from .frame_path import FramePath

_PICOSECOND = 1e-12
Delays = dict[str, dict[str, float] | None]
"""Least, mean and greatest time [s] by receiving unit; None: it has used no value."""


def delays_of_frames(frames: FramePath, row: int, steps: int) -> Delays:
    """Return the delays of the message in a row of the frame path, after so many steps."""
    messages, uses = frames.arrays["messages"], frames.arrays["uses"]
    step, found = int(frames.arrays["state"][T.STEP_TIME]), {}
    for i, reader in enumerate(frames.receivers[row], int(messages[row, T.FIRST_USE])):
        at, sampled, count, least, total, most, high = (int(n) for n in uses[i, T.USED_AT :])
        total += high * T.SUM
        if 0 <= at < steps:  # the last value that came was used too
            time = at * step - sampled
            least, most = (min(least, time), max(most, time)) if count else (time, time)
            total, count = total + time, count + 1
        found[reader.unit] = _times(least, total, most, count)
    return found


def delays_of_values(plan: Plan, number: int, steps: int) -> Delays:
    """Return the delays of a message that is no frame, by its number in the plan, after so many steps."""
    message = plan.messages[number]
    return {r.unit: _at_once(message, r, steps, plan.clock.step) for r in readers(plan)[number]}


def _at_once(message: MessagePlan, reader: Reader, steps: int, step: float) -> dict[str, float] | None:
    """Return the delays of a unit that receives each value as many steps after it was sampled."""
    sampled = np.arange(message.first, steps, message.every)
    turns = reader.turns(sampled + message.delay)
    # a turn takes the last one of those before it
    used = (turns < steps) & (turns != np.append(turns[1:], -1))
    waited = (turns - sampled)[used]
    if not len(waited):
        return None
    length = picoseconds(step)
    least, total, most = (int(n) * length for n in (waited.min(), waited.sum(), waited.max()))
    return _times(least, total, most, len(waited))


def _times(least: int, total: int, most: int, count: int) -> dict[str, float] | None:
    if count == 0:
        return None
    return {"min": least * _PICOSECOND, "mean": total / count * _PICOSECOND, "max": most * _PICOSECOND}


def effective_delays(plan: Plan, frames: FramePath, steps: int) -> dict[str, Delays]:
    """Return the delays of all messages that somebody receives, by "bus.message", after so many steps."""
    found = {}
    for number, (message, own) in enumerate(zip(plan.messages, readers(plan), strict=True)):
        if own:
            row = frames.row_of(number)
            found[f"{message.bus}.{message.label}"] = (
                delays_of_values(plan, number, steps) if row is None else delays_of_frames(frames, row, steps)
            )
    return found
