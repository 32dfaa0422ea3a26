"""The choice how the processes of isolated units wait for their turns: asleep, or looking on other cores.

One that sleeps takes no core from anybody, and is woken for each turn. One that looks is there at once, but
only if it does not stand in the way of the master, and nobody else wants the core: the processes look on the
cores that the master is not on, since all that look on one core pass it on to each other. Which is faster
depends on the machine and on who else uses it, and is measured: after each chunk of steps the time of a turn
is compared with that of the other way.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
from collections.abc import Sequence

from ...machine.hands import LOOK_TIME, HandedOver

_SHORT = LOOK_TIME / 2  # s; beyond it a turn is so long that waking counts little
_LEAST = 20  # turns of which the time says something
_BETTER = 0.9  # of the time asleep, so that looking is worth two busy cores
_MOST_CHUNKS = 256  # between two trials


class Placement:
    """The units whose turns machine code hands over. At first they sleep."""

    def __init__(self, units: Sequence[HandedOver]) -> None:
        self.units = units
        self.looking = False
        self._cores = os.sched_getaffinity(0) if units else set()
        self._asleep = 0.0  # s, the time of a turn
        self._chunks = self._pause = 1  # until the next trial, and from one to the next

    def judge(self, seconds: float, turns: int) -> None:
        """Choose for the next chunk after one of so many turns that took `seconds` [s]."""
        if turns < _LEAST or len(self._cores) < 2:
            return
        time = seconds / turns
        if self.looking and time > _BETTER * self._asleep:
            self._chunks = self._pause = min(2 * self._pause, _MOST_CHUNKS)
            self._settle(False)
        elif not self.looking:
            self._asleep = time
            self._chunks -= 1
            if self._chunks <= 0 and time < _SHORT:
                self._settle(True)

    def _settle(self, looking: bool) -> None:
        """Let the processes look, on all cores but the master's, or sleep, wherever they like."""
        self.looking = looking
        cores, look = self._cores, 0.0
        if looking:
            cores = cores - {ctypes.CDLL(None).sched_getcpu()}
            look = LOOK_TIME + 2 * len(self.units) * self._asleep  # until its turn comes round again
        with contextlib.suppress(OSError):  # one has just ended, as its next turn shows
            for unit in self.units:
                unit.settle(cores, look)
