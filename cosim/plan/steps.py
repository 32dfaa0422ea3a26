"""Times as counts of communication steps, and how many of them a run may be asked for, in whatever way."""

from __future__ import annotations

import math
from numbers import Integral

from ..clock import LATEST, Clock, nearest_step, point
from ..errors import ConfigError, short

_MOST_VALUES = 2**31
"""Values that a run records at most: 16 GiB, kept in a temporary file (`row_store`); an array of the whole
table, as `Results.data` is, needs that much memory."""
LONGEST_WITH_FRAMES = 4e6
"""The longest run [s] of a bus whose frames have times: 46 days. They are whole picoseconds in 64 bits, which
end at 9.2e6 s; delays come on top, and a fault without an end lasts for 4.6e6 s."""
_PRINTED = 10**300  # greater integers are no floats


def steps_in(
    time: float, step_size: float, place: str, start: float = 0.0, least: int = 0, most: float = math.inf
) -> int:
    """Return how many steps of `step_size` [s] after `start` [s] the finite `time` [s] is.

    Rounding is forgiven, for 0.1 is no binary number. Raises ConfigError, which starts with `place`, for what
    is no multiple, or fewer steps than `least` or more than `most`, naming the nearest ones.
    """
    count, whole = nearest_step(time, start, step_size)
    if whole and least <= count <= most:
        return count
    low = max(count if point(count, start, step_size) < time else count - 1, least - 1)
    found = [f"{point(k, start, step_size)!r} s" for k in (low, low + 1) if least <= k <= most]
    after = f" after start_time {start} s" if start else ""
    raise ConfigError(
        f"{place} = {time} s is not a multiple of the communication step {step_size} s{after}; "
        f"the nearest {'multiple is' if len(found) == 1 else 'are'} {' and '.join(found)}"
    )


def check_kept(steps: int, step_size: float, columns: int, place: str) -> None:
    """Raise ConfigError, which starts with `place`, where a run keeps more values than it may.

    It has `steps` steps of `step_size` [s] and records so many columns.
    """
    if steps * (columns + 1) > _MOST_VALUES:
        count = f"{steps:.3g}" if steps < _PRINTED else short(steps)
        raise ConfigError(
            f"{place}: {count} steps of {step_size:g} s with {columns} recorded variables are "
            f"more than the {_MOST_VALUES:.3g} values that a run keeps; stop earlier, take longer steps or "
            "`record` less"
        )


def whole_steps(steps: object) -> int:
    """Return a number of steps that somebody asked for. Raises ConfigError for what is none."""
    if not isinstance(steps, Integral) or isinstance(steps, bool) or steps < 0:
        raise ConfigError(f"steps = {short(steps)}: a run does 0 steps or more, a whole number")
    return int(steps)


def check_framed(bus: str, span: float, place: str) -> None:
    """Raise ConfigError, which starts with `place`, where a bus has frames for longer than their times count.

    `span` [s] is from the start of the run; "" is no bus.
    """
    if bus and not span <= LONGEST_WITH_FRAMES:
        raise ConfigError(
            f"{place}: bus {bus} has frames whose times count in picoseconds, for {LONGEST_WITH_FRAMES:g} s "
            f"after the start at most, not {span:g} s; stop earlier, or send plain values on it: "
            'timing = "instant", no protection, no timeout, no send type but cyclic, no fault and no log'
        )


def check_steps(steps: int, done: int, left: int, clock: Clock, columns: int, framed: str = "") -> None:
    """Raise ConfigError for more steps than a run may do that has `done` some, and records so many columns.

    `left` of them are left to the stop time, which bounds them where the units were told it. `framed` is a
    bus with frames, "" where there is none.
    """
    place = f"steps = {short(steps)}"
    if clock.told and steps > left:
        raise ConfigError(
            f"{place}: {left} are left to the stop time {clock.stop} s, "
            "which the units were told; without to_stop a simulation can be stepped beyond it"
        )
    check_kept(done + steps, clock.step, columns, place if not done else f"{place} after {done}")
    check_framed(framed, clock.length(done + steps), place)
    if not clock.at(done + steps) <= LATEST:
        raise ConfigError(f"{place}: a run goes up to {LATEST:g} s")
