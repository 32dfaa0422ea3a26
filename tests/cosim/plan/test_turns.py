"""The FMU steps of a unit: one after the other without a gap, and none beyond the stop time."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock
from evcosim.cosim.plan.turns import TurnTimes, cut_short
from evcosim.cosim.plan.unit_plan import FmuSteps

STEP = st.sampled_from([0.001, 0.0025, 0.005, 0.01, 0.02, 0.025, 0.1, 1 / 60, 1 / 3])


def open_ended(start: float, step: float, steps: int) -> Clock:
    clock = Clock.counted(start, step, steps)
    return Clock(**vars(clock) | {"told": False})


@given(
    STEP,
    st.sampled_from([0.0, 0.7]),
    st.integers(1, 400),
    st.integers(1, 5),
    st.integers(1, 4),
    st.integers(0, 4),
)
def test_no_step_ends_beyond_the_stop_time_and_the_last_one_there(
    step: float, start: float, count: int, every: int, substeps: int, first: int
) -> None:
    clock = Clock.counted(start, step, count)
    first %= min(every, count)
    times, end = TurnTimes(clock, every, substeps, first), clock.at(first)
    for k in range(first, count, every):
        steps = times.steps(k)
        for (begin, size), after in zip(steps.each(), steps.ends(), strict=True):
            assert begin == pytest.approx(end, abs=1e-12 * max(1.0, end))
            assert begin + size <= clock.stop
            assert begin + size == pytest.approx(after, rel=1e-12)
            end = after
        assert steps.each()[0][0] == clock.at(k)
        assert end == clock.at(min(k + every, count))
    begin, size = steps.each()[-1]
    assert begin + size == clock.stop


@pytest.mark.parametrize("step", [0.01, 0.005])
def test_every_whole_second_up_to_2000_is_reached_and_none_passed(step: float) -> None:
    for seconds in range(1, 2001):
        clock = Clock.counted(0.0, step, round(seconds / step))
        ((begin, size),) = TurnTimes(clock, 1, 1).steps(clock.steps - 1).each()
        assert clock.stop == begin + size == seconds


@given(
    st.sampled_from([0.001, 0.0025, 0.01, 0.1]), st.integers(0, 10**5), st.integers(1, 4), st.integers(1, 7)
)
def test_substeps_begin_at_the_double_nearest_to_their_fraction(
    step: float, turn: int, every: int, substeps: int
) -> None:
    clock = Clock.counted(0.7, step, 10**6)
    exact = Fraction(repr(step))
    begins = [begin for begin, _ in TurnTimes(clock, every, substeps).steps(turn * every).each()]
    assert begins == [
        float(Fraction(7, 10) + turn * every * exact + j * every * exact / substeps) for j in range(substeps)
    ]


def test_all_sizes_are_the_step_where_that_lands_on_the_stop_time() -> None:
    steps = [TurnTimes(Clock.counted(0.0, 0.01, 4000), 1, 1).steps(k) for k in range(4000)]
    assert {size for each in steps for _, size in each.each()} == {0.01}


def test_a_period_that_would_pass_the_stop_time_ends_there_if_it_was_told() -> None:
    told, untold = Clock.counted(0.0, 0.01, 3), open_ended(0.0, 0.01, 3)
    assert TurnTimes(told, 2, 1).steps(2).each() == ((0.02, 0.01),)
    assert TurnTimes(untold, 2, 1).steps(2).each() == ((0.02, 0.02),)
    assert TurnTimes(untold, 1, 1).steps(7).each() == ((0.07, 0.01),)
    assert told.told_stop == 0.03
    assert untold.told_stop is None


@given(st.integers(1, 60), st.integers(1, 9), st.integers(0, 8))
def test_a_stop_time_cuts_a_turn_short_if_the_last_one_is_not_as_long_as_the_others(
    count: int, every: int, first: int
) -> None:
    first %= min(every, count)
    times = TurnTimes(Clock.counted(0.7, 0.01, count), every, 1, first)
    begin, size = times.steps(times.last_k).each()[0]
    assert cut_short(times.clock, every, first) == (size < times.size - 1e-9)
    assert begin + size == times.clock.stop
    assert not cut_short(open_ended(0.7, 0.01, count), every, first)


def test_equal_steps() -> None:
    steps = FmuSteps.equal(1.0, 0.5, 3)
    assert steps.each() == [(1.0, 0.5), (1.5, 0.5), (2.0, 0.5)]
    assert steps.ends() == [1.5, 2.0, 2.5]
