"""BoundPlanner: the two laws."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.bound_planner import BoundPlanner

FIG9 = BoundPlanner.Parameters(
    acceleration_minimum=0.3,
    acceleration_at_rest=2.5,
    acceleration_slope=0.05,
    speed_mean=38.0,
    speed_amplitude=6.0,
)
times = st.floats(0.0, 1e4)
speeds = st.floats(0.0, 100.0)


def bounds(p: BoundPlanner.Parameters, time: float, speed: float) -> BoundPlanner.Outputs:
    """The bounds of one sample."""
    x = BoundPlanner.initial(BoundPlanner.Parameters(), BoundPlanner.Inputs())
    return BoundPlanner.outputs(p, BoundPlanner.step(p, x, BoundPlanner.Inputs(time, speed), 0.01))


@given(times, speeds)
def test_the_defaults_are_the_constant_bounds_of_fig_8(time: float, speed: float) -> None:
    assert bounds(BoundPlanner.Parameters(), time, speed) == BoundPlanner.Outputs(30.0, 1.0)


@given(times, speeds, speeds)
def test_the_acceleration_bound_falls_with_the_speed_down_to_its_minimum(
    time: float, one: float, other: float
) -> None:
    slow, fast = sorted((one, other))
    a, b = bounds(FIG9, time, slow).acceleration_bound, bounds(FIG9, time, fast).acceleration_bound
    assert 2.5 >= a >= b >= 0.3


@given(times, speeds)
def test_the_speed_bound_is_periodic_and_in_its_band(time: float, speed: float) -> None:
    v = bounds(FIG9, time, speed).speed_bound
    assert 32.0 - 1e-9 <= v <= 44.0 + 1e-9
    assert bounds(FIG9, time + 60.0, speed).speed_bound == pytest.approx(v, abs=1e-6)
    assert 0.5 * (v + bounds(FIG9, time + 30.0, speed).speed_bound) == pytest.approx(38.0, abs=1e-6)


@given(times)
def test_a_speed_bound_is_not_negative(time: float) -> None:
    p = BoundPlanner.Parameters(speed_mean=5.0, speed_amplitude=20.0)
    assert bounds(p, time, 0.0).speed_bound >= 0.0


@pytest.mark.parametrize(("time", "expected"), [(0.0, 38.0), (15.0, 44.0), (45.0, 32.0)])
def test_values_of_fig_9(time: float, expected: float) -> None:
    y = bounds(FIG9, time, 20.0)
    assert y.speed_bound == pytest.approx(expected)
    assert y.acceleration_bound == pytest.approx(1.5)
