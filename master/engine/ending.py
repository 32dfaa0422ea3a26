"""The end of a run at the request of a unit.

A unit that gets to the end of its turn and asks to end the simulation ends the run at that communication
point: the others step up to it. One that asks within its turn, and does not get to the end, ends the run at
the communication point at which the turn began: the row there is the last.
"""

from __future__ import annotations

import sys

_CLOSE = 1e-6  # of a step: a time so close to its end is its end


class EndedWithin(Exception):
    """A unit asked to end the simulation within a step, which is not completed."""


class Ending:
    """The step at which the run ends, since `unit` asked for it at `time` [s]; "" without a request."""

    def __init__(self) -> None:
        self.step, self.unit, self.time = sys.maxsize, "", 0.0

    @property
    def text(self) -> str:
        """A sentence for the user; "" without a request."""
        return f"unit '{self.unit}' asked to end the simulation at t = {self.time:.9g} s" if self.unit else ""

    def request(self, unit: str, asked: float, turn: tuple[int, int], span: tuple[float, float]) -> None:
        """Note the request of a unit that got to the time `asked` [s]; NaN: it does not tell.

        `turn` are the steps at which its turn begins and ends, `span` the times of these [s]. Raises
        EndedWithin where it did not get to the end.
        """
        begin, end = span
        within = not asked >= end - _CLOSE * (end - begin)
        step = turn[0] if within else turn[1]
        if step < self.step:
            self.step, self.unit = step, unit
            self.time = max(begin, asked) if within else end  # begin for NaN
        if within:
            raise EndedWithin
