"""Rows of the kernel's tables that come from the plan."""

from __future__ import annotations

import math

from evcosim.cosim.clock import Clock
from evcosim.cosim.plan.turns import TurnTimes
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.compiled.rows import mapped, times_row
from evcosim.master.machine import tables as L


def test_a_map_without_an_offset_changes_no_zero() -> None:
    row = mapped(Affine(1.0, 0.0))
    for value in (0.0, -0.0):
        assert math.copysign(1.0, row[L.SCALE] * value + row[L.ADD]) == math.copysign(1.0, value)
    assert mapped(Affine(3.6, -1.0)) == {L.SCALE: 3.6, L.ADD: -1.0}


def test_the_times_of_a_unit_are_those_of_its_turns() -> None:
    times = TurnTimes(Clock.counted(0.0, 0.01, 10), 4, 2)  # the last turn has two of its four steps
    row, last = times_row(times), times.last
    assert last is not None
    assert (row[L.STEPS], row[L.STEP_SIZE], row[L.LAST_TURN]) == (2, 0.02, 8)
    assert (row[L.LAST_ADVANCE], row[L.LAST_SIZE], row[L.LANDING_SIZE]) == (
        last.advance, last.size, last.last,
    )  # fmt: skip # beside their columns
    assert last.size == 0.01
