"""Steps in machine code begin when `FmuSteps` says, and stop at a status that is an error."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.plan.turns import TurnTimes
from evcosim.master.machine import tables as L
from evcosim.master.machine.calling import steps
from evcosim.master.machine.surroundings import address

_DO_STEP = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_double, ctypes.c_double, ctypes.c_int)


class Stepped:
    """A unit whose steps are noted as (time, size); `statuses` are what they return, then 0."""

    def __init__(self, *statuses: int) -> None:
        self.seen: list[tuple[float, float]] = []
        self._statuses = list(statuses)
        self._function = _DO_STEP(self._step)
        self.state = np.zeros(L.STATE_SIZE, dtype=np.int64)
        self.unit = np.zeros(L.UNIT, dtype=np.int64)
        self.unit[L.FUNCTION] = address(self._function)
        self.tables = np.zeros(L.TABLES, dtype=np.int64)
        self.tables[L.STATE] = self.state.ctypes.data

    def _step(self, component: int, time: float, size: float, flag: int) -> int:
        assert flag == 1
        self.seen.append((time, size))
        return self._statuses.pop(0) if self._statuses else 0

    def do(self, turn) -> int:
        first, advance, divisor, total, size, last, _ = turn
        begin = first / divisor
        at, row = self.tables.ctypes.data, self.unit.ctypes.data
        return steps(at, row, total, begin, first, advance, divisor, size, last)


@pytest.mark.parametrize(("every", "substeps"), [(1, 1), (1, 3), (4, 1), (7, 10)])
@pytest.mark.parametrize("step", [0.01, 1.0 / 60.0])
def test_steps_begin_and_end_as_the_turn_says(step: float, every: int, substeps: int) -> None:
    times = TurnTimes(Clock.counted(0.7, step, 100), every, substeps)
    for k in (0, 3 * every, times.last_k):
        turn, unit = times.steps(k), Stepped()
        assert unit.do(turn) == L.DONE
        assert unit.seen == list(turn.each())


def test_a_warning_is_counted_and_an_error_ends_the_turn() -> None:
    turn, unit = TurnTimes(Clock.counted(0.0, 0.01, 10), 1, 5).steps(0), Stepped(0, 1, 0, 3)
    assert unit.do(turn) == L.BAD_STATUS
    assert len(unit.seen) == 4
    assert (unit.state[L.DETAIL], unit.unit[L.WARNINGS], unit.state[L.NOTED]) == (3, 1, 1)
