"""The FMU steps of each turn of a unit: their times and sizes."""

from __future__ import annotations

import math

from ..clock import WHOLE, Clock
from .unit_plan import FmuSteps


class TurnTimes:
    """The times of a unit with a turn every `every` communication steps, `substeps` FMU steps in each.

    Its turns are at the steps k >= `first`, which is before the stop time, with (k - first) % every == 0.
    An FMU step begins at (numerator(k) * factor + j * advance) / divisor [s], j = 0 ... substeps - 1, where
    `numerator` is the clock's. All have the same `size` [s], those before the stop time aside: a turn that
    would go beyond it ends there if the units are told it, and the last step is as long as it takes to land
    on it in doubles. This turn is `last`, at the step `last_k` (None and -1: there is none).
    """

    def __init__(self, clock: Clock, every: int, substeps: int, first: int = 0) -> None:
        self.clock, self.every, self.substeps, self.first = clock, every, substeps, first
        self.size = clock.length(every, substeps)
        longest = (abs(clock.first) + clock.steps * clock.advance) * substeps
        self._divides = clock.decimal and longest < WHOLE
        self.factor = float(substeps) if self._divides else 1.0
        self.divisor = clock.divisor * self.factor
        self.advance = self._advance(every)
        self.last, self.last_k = self._last_turn(), -1
        if self.last is not None:
            self.last_k = self._begin_of_last()

    def _advance(self, span: int) -> float:
        """Return what lies between two FMU steps of a turn of `span` communication steps, times `divisor`."""
        if self._divides:
            return span * self.clock.advance
        return self.clock.length(span, self.substeps) * self.divisor

    def steps(self, k: int) -> FmuSteps:
        """Return the FMU steps of the turn at communication step `k`."""
        if k == self.last_k and self.last is not None:
            return self.last
        first, end = self.clock.numerator(k) * self.factor, self.clock.at(k + self.every)
        return FmuSteps(first, self.advance, self.divisor, self.substeps, self.size, self.size, end)

    def _last_turn(self) -> FmuSteps | None:
        clock, every, count = self.clock, self.every, self.substeps
        k = self._begin_of_last()
        span = clock.steps - k
        if span < every and not clock.told:
            return None
        first, advance = clock.numerator(k) * self.factor, self._advance(span)
        size, stop, divisor = clock.length(span, count), clock.stop, self.divisor
        begin = (first + (count - 1) * advance) / divisor
        return FmuSteps(first, advance, divisor, count, size, _landing(begin, size, stop), stop)

    def _begin_of_last(self) -> int:
        """Return the step of the last turn before the stop time."""
        return self.first + (self.clock.steps - 1 - self.first) // self.every * self.every


def turn_from(step: int, every: int, first: int) -> int:
    """Return the first step from `step` on at which a unit with a turn every `every` steps has one."""
    return first + -(-max(step - first, 0) // every) * every


def cut_short(clock: Clock, every: int, first: int = 0) -> bool:
    """Return True if the stop time, of which units are told, ends the last turn of one so often early."""
    return clock.told and (clock.steps - first) % every != 0


def _landing(begin: float, size: float, stop: float) -> float:
    """Return the size [s], `size` if it will do, of a step from `begin` [s] that ends at `stop` [s]."""
    if begin + size == stop:
        return size
    size = stop - begin
    while begin + size > stop:
        size = math.nextafter(size, 0.0)
    return size
