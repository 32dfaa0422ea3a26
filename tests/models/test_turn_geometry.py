"""Turn geometry and the electronic differential: the paper's formulas, their symmetry, the stop, odd cars."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.electronic_differential import ElectronicDifferential
from evcosim.models.turn_geometry import check_steering, wheel_ratios

P = ElectronicDifferential.Parameters()
LIMIT = P.steering_limit
angles = st.floats(-LIMIT, LIMIT)
speeds = st.floats(-150.0, 150.0)


def references(speed: float, angle: float, p: ElectronicDifferential.Parameters = P) -> tuple[float, float]:
    """References [rad/s] of the left and the right wheel for a speed [km/h] and a steering angle [rad]."""
    x = ElectronicDifferential.initial(p, ElectronicDifferential.Inputs(speed, angle))
    return x.left_reference, x.right_reference


def test_the_papers_references_at_60_kmh_and_a_degree_and_a_half() -> None:
    left, right = references(60.0, math.radians(1.5))
    wheels = 60.0 / 3.6 / 0.36
    shift = 0.75 * math.tan(math.radians(1.5)) / 2.5
    assert left == pytest.approx(wheels * (1.0 - shift), rel=1e-9, abs=0.0)
    assert right == pytest.approx(wheels * (1.0 + shift), rel=1e-9, abs=0.0)
    assert (left, right) == pytest.approx((45.933, 46.660), abs=5e-4)


@given(speeds, angles)
def test_the_mean_is_the_speed_and_the_quotient_that_of_the_radii(speed: float, angle: float) -> None:
    left, right = references(speed, angle)
    assert 0.5 * (left + right) * 0.36 == pytest.approx(speed / 3.6, rel=1e-9, abs=1e-12)  # (13)
    if abs(angle) > 1e-6:
        radius = P.wheelbase / math.tan(angle)  # (9)
        assert left * (radius + 0.75) == pytest.approx(right * (radius - 0.75), rel=1e-9, abs=1e-6)


@given(speeds, angles)
def test_steering_the_other_way_swaps_the_wheels(speed: float, angle: float) -> None:
    assert references(speed, angle) == references(speed, -angle)[::-1]


def test_index_one_is_the_left_wheel_slow_in_a_left_hand_curve() -> None:
    left, right = references(60.0, 0.1)
    assert left < right
    assert references(60.0, 0.0) == (60.0 / 3.6 / 0.36,) * 2


@given(st.floats(LIMIT, 1e6), st.sampled_from([1, -1]))
def test_an_angle_beyond_the_stop_is_the_stop(angle: float, side: int) -> None:
    assert references(60.0, side * angle) == references(60.0, side * LIMIT)
    assert min(references(60.0, side * angle)) > 0.0


def test_no_number_stays_no_number() -> None:
    assert all(math.isnan(r) for r in references(60.0, math.nan))


@pytest.mark.parametrize(
    ("wheelbase", "track", "limit"), [(2.5, 1.5, 1.29), (0.5, 1.5, 0.7), (2.5, 10.0, 0.5)]
)
def test_a_radius_below_half_the_track_is_refused_with_the_values(
    wheelbase: float, track: float, limit: float
) -> None:
    with pytest.raises(ValueError, match=rf"steering_limit = {limit} rad .* must be above track/2") as error:
        check_steering(wheelbase, track, limit)
    assert f"wheelbase = {wheelbase} m, track = {track} m" in str(error.value)
    p = ElectronicDifferential.Parameters(wheelbase=wheelbase, track=track, steering_limit=limit)
    with pytest.raises(ValueError, match="turns the car about a point between its rear wheels"):
        references(60.0, 0.0, p)


@given(st.floats(0.1, 10.0), st.floats(0.1, 5.0), st.floats(0.0, 1.57))
def test_whatever_is_accepted_turns_both_wheels_forward(wheelbase: float, track: float, limit: float) -> None:
    try:
        check_steering(wheelbase, track, limit)
    except ValueError:
        assert min(wheel_ratios(wheelbase, track, limit, limit)) <= 1e-12
    else:
        assert min(wheel_ratios(wheelbase, track, limit, limit)) > 0.0
