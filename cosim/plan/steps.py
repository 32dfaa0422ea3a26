"""Times as counts of communication steps."""

from __future__ import annotations

from ..clock import nearest_step, point
from ..errors import ConfigError


def steps_in(time: float, step_size: float, place: str, start: float = 0.0, least: int = 0) -> int:
    """Return how many steps of `step_size` [s] after `start` [s] the finite `time` [s] is.

    Rounding is forgiven, for 0.1 is no binary number. Raises ConfigError, which starts with `place`, for what
    is no multiple, or fewer steps than `least`, naming the nearest ones.
    """
    count, whole = nearest_step(time, start, step_size)
    if whole and count >= least:
        return count
    low = max(count if point(count, start, step_size) < time else count - 1, least - 1)
    found = [f"{point(k, start, step_size)!r} s" for k in (low, low + 1) if k >= least]
    after = f" after start_time {start} s" if start else ""
    raise ConfigError(
        f"{place} = {time} s is not a multiple of the communication step {step_size} s{after}; "
        f"the nearest {'is' if len(found) == 1 else 'are'} {' and '.join(found)}"
    )
