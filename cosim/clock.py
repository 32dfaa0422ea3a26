"""The communication points of a run, counted: the one place where a count becomes a time.

t_k [s] is the double nearest to start + k * step in decimal arithmetic, so that 0.07 s is the point 7 of
steps of 0.01 s, where 7 * 0.01 is 0.07000000000000001. With start * d and step * d whole numbers, for a power
of ten d up to 10^9 or a part of one, that is

    t_k = (start d + k (step d)) / d

of which only the division is rounded. Any other step, as 1/60 s, has no decimal of its own: there t_k =
start + k * step, in doubles, and d = 1. In both the last point t_N is the stop time exactly.

A time that somebody wrote or computed, as 3 * 0.1, counts as the communication point that it misses by
rounding alone: by no more than 5e-12 of itself, half of its 12th digit, and a thousandth of a step.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # what reads a system file alone, as `evcosim list` does, needs no numpy
    import numpy as np
    from numpy.typing import NDArray

    Times = NDArray[np.float64]
    """Times [s], shape (n,)."""

_FINEST = 10**9  # parts of a second
LATEST = 1e12
"""The greatest time [s] of a run, 32,000 years."""
WHOLE = 2**53  # below it a double holds every whole number
_ROUNDING, _SHARE = 5e-12, 1e-3  # of a time, and of a step


@dataclasses.dataclass(frozen=True)
class Clock:
    """The times t_k = (first + k * advance) / divisor [s] of a run of `steps` steps to the `stop` [s].

    `decimal`: `first`, `advance` and `divisor` are whole numbers; else they are `start`, `step` and 1.
    `told`: units are told the stop time, and are never stepped beyond it.
    """

    start: float
    step: float
    steps: int
    stop: float
    first: float
    advance: float
    divisor: float
    decimal: bool
    told: bool = True

    @classmethod
    def counted(cls, start: float, step: float, steps: int, stop: float | None = None) -> Clock:
        """Return the clock of so many steps of `step` [s] from `start` [s] on.

        `stop` [s] is the time of the last one where steps are no decimals (None: start + steps * step).
        """
        start, step = float(start), float(step)
        begin, length = _decimal(start), _decimal(step)
        parts = math.lcm(begin.denominator, length.denominator)
        first, advance = begin * parts, length * parts
        if _FINEST % parts == 0 and abs(first) + steps * advance < WHOLE:
            stop = float(first + steps * advance) / parts
            return cls(start, step, steps, stop, float(first), float(advance), float(parts), True)
        stop = start + steps * step if stop is None else float(stop)
        return cls(start, step, steps, stop, start, step, 1.0, False)

    @property
    def told_stop(self) -> float | None:
        """The stop time [s] that units are told; None: there is none."""
        return self.stop if self.told else None

    def numerator(self, k: int) -> float:
        """Return t_k times `divisor`."""
        if k == self.steps and not self.decimal:
            return self.stop
        return self.first + k * self.advance

    def at(self, k: int) -> float:
        """Return t_k [s]."""
        return self.numerator(k) / self.divisor

    def times(self, first: int, stop: int) -> Times:
        """Return t_k [s] for k from `first` to before `stop`, shape (max(0, stop - first),)."""
        import numpy as np

        found = (self.first + np.arange(first, stop, dtype=np.float64) * self.advance) / self.divisor
        if first <= self.steps < stop:
            found[self.steps - first] = self.stop
        return found

    def length(self, span: int, parts: int = 1) -> float:
        """Return the length [s] of `span` steps, or of one of the equal parts of them."""
        return span * self.advance / (self.divisor * parts)

    def step_at(self, time: float) -> int:
        """Return the first k whose t_k is `time` [s] or later, where a difference by rounding is none."""
        k, same = nearest_step(time, self.start, self.step)
        return k if same or _decimal(self.start) + k * _decimal(self.step) > _decimal(time) else k + 1

    def on_points(self, times: Times) -> Times:
        """Return times [s], shape (n,), with those that miss a communication point by rounding put there."""
        import numpy as np

        with np.errstate(over="ignore", invalid="ignore"):
            k = np.rint((times - self.start) / self.step)
            within = (k >= 0.0) & (k <= self.steps)
            k = np.where(within, k, 0.0)
            points = np.where(k == self.steps, self.stop, (self.first + k * self.advance) / self.divisor)
            slack = _ROUNDING * np.maximum(np.maximum(np.abs(times), abs(self.start)), self.step)
            same = within & (np.abs(points - times) <= np.minimum(slack, _SHARE * self.step))
        return np.where(same, points, times)


def picoseconds(time: float) -> int:
    """Return a time [s] in whole picoseconds, in which times on a bus count."""
    return round(_decimal(time) * 10**12)


def nearest_step(time: float, start: float, step: float) -> tuple[int, bool]:
    """Return the k with start + k * step nearest to `time`, and True if only rounding is between them.

    All are in s and finite, `step` is above 0, and they stand for the decimals that are written for them.
    """
    at, begin, length = _decimal(time), _decimal(start), _decimal(step)
    k = round((at - begin) / length)
    slack = min(_ROUNDING * max(abs(time), abs(start), step), _SHARE * step)
    return k, abs(begin + k * length - at) <= slack


def point(k: int, start: float, step: float) -> float:
    """Return the time [s] nearest to start + k * step in decimal arithmetic; infinite beyond all doubles."""
    try:
        return float(_decimal(start) + k * _decimal(step))
    except OverflowError:
        return math.inf


def steps_to(delay: float, step: float) -> int:
    """Return the number of steps of `step` [s] after which `delay` [s] has passed, rounding forgiven."""
    return Clock.counted(0.0, step, 0).step_at(delay)


@functools.lru_cache(maxsize=1024)  # a plan asks often for the same few times
def _decimal(seconds: float) -> Fraction:
    """Return the number that was written: 0.01 is 1/100, not the nearest double."""
    return Fraction(repr(float(seconds)))
