"""Times as counts of communication steps."""

from __future__ import annotations

from ..errors import ConfigError


def steps_in(time: float, step_size: float, place: str) -> int:
    """Return how many steps of `step_size` [s] the `time` [s] is.

    A thousandth of a step is forgiven, for 0.1 is no binary number. Raises ConfigError, which starts with
    `place`, for what is no multiple.
    """
    count = round(time / step_size)
    if abs(time / step_size - count) > 1e-3:
        raise ConfigError(f"{place} = {time} s is not a multiple of the communication step {step_size} s")
    return count
