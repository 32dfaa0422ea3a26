"""The clock: every time is the double nearest to its decimal, the same for one and for many."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock, nearest_step, point, steps_to

STEPS = ["0.001", "0.002", "0.0025", "0.005", "0.01", "0.02", "0.025", "0.1"]
MANY = 10**6


@pytest.mark.parametrize("start", ["0", "0.7"])
@pytest.mark.parametrize("step", STEPS)
def test_every_time_is_that_of_decimal_arithmetic(step: str, start: str) -> None:
    clock = Clock.counted(float(start), float(step), MANY)
    begin, length = Decimal(start), Decimal(step)
    first, advance = int(begin * 10_000), int(length * 10_000)
    expected = [(first + k * advance) / 10_000 for k in range(MANY + 1)]  # correctly rounded for integers
    assert expected[::97] == [float(begin + k * length) for k in range(0, MANY + 1, 97)]
    assert clock.times(0, MANY + 1).tolist() == expected
    assert [clock.at(k) for k in range(0, MANY + 1, 7)] == expected[::7]
    assert clock.decimal
    assert clock.stop == float(begin + MANY * length)


@pytest.mark.parametrize(("start", "step"), [(0.0, 1 / 60), (0.7, 1 / 3), (0.1 + 0.2, 0.01), (0.0, 1e-10)])
def test_a_step_that_is_no_decimal_is_counted_in_doubles(start: float, step: float) -> None:
    clock = Clock.counted(start, step, MANY)
    expected = start + np.arange(MANY + 1) * step
    assert not clock.decimal
    assert np.array_equal(clock.times(0, MANY + 1), expected)
    assert [clock.at(k) for k in range(0, MANY + 1, 77)] == expected[::77].tolist()


def test_the_last_time_is_the_stop_time() -> None:
    step = 1 / 49
    assert 49 * step != 1.0
    clock = Clock.counted(0.0, step, 49, stop=1.0)
    assert clock.at(49) == clock.times(45, 60)[4] == clock.numerator(49) / clock.divisor == 1.0
    assert clock.at(50) == clock.times(50, 51)[0] == 50 * step


@given(st.integers(-(10**6), 10**6), st.integers(1, 10**6), st.integers(0, 9), st.integers(0, 10**6))
def test_any_decimal(start: int, step: int, digits: int, k: int) -> None:
    begin, length = Decimal(start).scaleb(-digits), Decimal(step).scaleb(-digits)
    clock = Clock.counted(float(begin), float(length), 10**6)
    assert clock.at(k) == float(begin + k * length)
    assert clock.length(k, 1) == float(k * length)
    assert clock.step_at(float(begin + k * length)) == k
    assert clock.on_points(np.array([clock.at(k)]))[0] == clock.at(k)


@given(st.integers(1, 10**5), st.sampled_from([0.01, 0.0025, 1 / 60, 1 / 3]), st.floats(-1.0, 1.0))
def test_what_misses_a_point_by_rounding_is_that_point(k: int, step: float, error: float) -> None:
    clock = Clock.counted(0.7, step, 10**6)
    near = clock.at(k) * (1.0 + 4e-12 * error)
    assert nearest_step(near, 0.7, step) == (k, True)
    assert clock.step_at(near) == k
    assert clock.on_points(np.array([near]))[0] == clock.at(k)


@given(st.integers(0, 10**5), st.sampled_from([0.01, 0.0025, 1 / 60]), st.floats(0.001, 0.999))
def test_what_lies_between_two_points_comes_with_the_later(k: int, step: float, share: float) -> None:
    clock = Clock.counted(0.7, step, 10**6)
    between = clock.at(k) + share * step
    assert clock.step_at(between) == k + 1
    assert clock.on_points(np.array([between]))[0] == between


def test_a_time_far_away_or_none_stays() -> None:
    clock = Clock.counted(0.0, 0.01, 100)
    times = np.array([-0.01, 1.01, 1e300, np.inf, -np.inf, np.nan])
    assert np.array_equal(clock.on_points(times), times, equal_nan=True)


def test_delays_count_in_decimals() -> None:
    assert [steps_to(delay, 0.01) for delay in (0.0, 0.03, 0.07, 0.071, 0.001)] == [0, 3, 7, 8, 1]
    assert steps_to(0.05, 1 / 60) == 3


def test_a_length_is_the_nearest_double_too() -> None:
    clock = Clock.counted(0.0, 0.1, 10)
    assert clock.length(3) == 0.3 != 3 * 0.1
    assert clock.length(3, 4) == 0.075


def test_what_is_beyond_all_doubles_is_infinite() -> None:
    assert point(3, 0.0, 1e308) == np.inf
    assert nearest_step(1e308, 0.0, 5e-324)[0] > 10**600
