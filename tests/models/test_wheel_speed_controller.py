"""WheelSpeedController: PID and MIMO-PID, limits, conditional integration, the printed gains that fail."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.wheel_speed_controller import TORQUE_LIMIT, WheelSpeedController

P = WheelSpeedController.Parameters()
PID = WheelSpeedController.Parameters(coupling=0.0)
DT = 0.01
errors = st.floats(-0.8, 0.8)


def samples(p: WheelSpeedController.Parameters, *pairs: tuple[float, float]) -> WheelSpeedController.State:
    """The state after samples of the two wheels' errors [rad/s]."""
    x = WheelSpeedController.initial(p, WheelSpeedController.Inputs())
    for left, right in pairs:
        x = WheelSpeedController.step(p, x, WheelSpeedController.Inputs(left, right, 0.0, 0.0), DT)
    return x


def test_the_torque_limit_is_the_motors_through_its_gear() -> None:
    assert P.torque_limit == TORQUE_LIMIT == pytest.approx(2297.1)


@given(errors, errors)
def test_the_first_sample_is_proportional(left: float, right: float) -> None:
    x = samples(P, (left, right))
    assert x.left_torque == pytest.approx(1200.0 * (left + 0.5 * right))
    assert x.right_torque == pytest.approx(1200.0 * (right + 0.5 * left))


@given(errors, errors)
def test_without_coupling_the_wheels_know_nothing_of_each_other(left: float, right: float) -> None:
    both, alone = samples(PID, (left, right)), samples(PID, (left, 0.0))
    assert (both.left_torque, both.left_integral) == (alone.left_torque, alone.left_integral)


@given(st.lists(st.floats(-0.1, 0.1), max_size=20))
def test_common_errors_see_the_pid_with_half_as_much_again(common: list[float]) -> None:
    stronger = dataclasses.replace(PID, proportional_gain=1800.0, integral_gain=600.0)
    mimo, pid = (samples(p, *((e, e) for e in common)) for p in (P, stronger))
    assert mimo.left_torque == pytest.approx(pid.left_torque, abs=1e-9)
    assert mimo.right_torque == mimo.left_torque


@given(st.lists(st.floats(-0.1, 0.1), max_size=20))
def test_differences_of_the_wheels_see_half_the_gain_and_with_full_coupling_none(
    difference: list[float],
) -> None:
    half = dataclasses.replace(PID, proportional_gain=600.0, integral_gain=200.0)
    mimo, pid = (samples(p, *((e, -e) for e in difference)) for p in (P, half))
    assert mimo.left_torque == pytest.approx(pid.left_torque, abs=1e-9)
    full = samples(dataclasses.replace(P, coupling=1.0), *((e, -e) for e in difference))
    assert full.left_torque == 0.0


@given(st.lists(st.tuples(errors, errors), max_size=15))
def test_swapping_the_wheels_swaps_the_torques(pairs: list[tuple[float, float]]) -> None:
    x, y = samples(P, *pairs), samples(P, *((b, a) for a, b in pairs))
    assert (x.left_torque, x.right_torque) == (y.right_torque, y.left_torque)


def test_the_integral_is_the_gain_times_the_error_times_the_time() -> None:
    x = samples(PID, *[(0.2, 0.0)] * 101)
    assert x.left_torque == pytest.approx(1200.0 * 0.2 + 400.0 * 0.2 * 1.0)


def test_the_literal_form_has_next_to_no_integral() -> None:
    x = samples(dataclasses.replace(PID, reciprocal_integral=True), *[(0.2, 0.0)] * 101)
    assert x.left_torque == pytest.approx(1200.0 * 0.2 + 0.2 / 400.0)


def test_the_derivative_is_a_backward_difference_without_a_kick_at_the_start() -> None:
    p = dataclasses.replace(PID, derivative_gain=2.0, integral_gain=1e-6)
    assert samples(p, (0.5, 0.0)).left_torque == pytest.approx(600.0)
    assert samples(p, (0.5, 0.0), (0.7, 0.0)).left_torque == pytest.approx(840.0 + 2.0 * 0.2 / DT)


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_the_torque_keeps_its_limit(left: float, right: float) -> None:
    x = samples(P, (left, right), (right, left))
    assert max(abs(x.left_torque), abs(x.right_torque)) <= TORQUE_LIMIT


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_the_limit_the_integral_rests_and_leaves_at_once(side: float) -> None:
    pressed = samples(P, *[(side * 40.0, side * 40.0)] * 500)
    assert pressed.left_torque == side * TORQUE_LIMIT
    assert pressed.left_integral == 0.0
    u = WheelSpeedController.Inputs(-side * 0.1, -side * 0.1, 0.0, 0.0)
    released = WheelSpeedController.step(P, pressed, u, DT)
    assert released.left_torque == pytest.approx(-side * 0.1 * 1800.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_beyond_the_limit_an_error_may_drive_the_integral_back(side: float) -> None:
    start = dataclasses.replace(WheelSpeedController.State(), left_integral=side * 5000.0)
    u: Any = WheelSpeedController.Inputs(-side * 0.5, 0.0, 0.0, 0.0)
    after = WheelSpeedController.step(PID, start, u, DT)
    assert after.left_torque == side * TORQUE_LIMIT
    assert abs(after.left_integral) < 5000.0


def test_a_start_in_equilibrium_stays_there() -> None:
    x = samples(WheelSpeedController.Parameters(initial_torque=117.0), *[(0.0, 0.0)] * 10)
    assert (x.left_torque, x.right_torque) == (117.0, 117.0)
    x = samples(WheelSpeedController.Parameters(initial_torque=1e9))
    assert x.left_torque == TORQUE_LIMIT
