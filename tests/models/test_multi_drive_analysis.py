"""The analysis of the two-motor car: numbers of made-up runs, and why printed ones are not reproducible."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.models import multi_drive_analysis as analysis
from evcosim.models.two_motor_vehicle import TwoMotorVehicle, friction, resistance_torques
from evcosim.models.wheel_speed_controller import TORQUE_LIMIT

P = TwoMotorVehicle.Parameters()
V = 60.0 / 3.6
TIME = np.arange(1001) * 0.01


def test_dip_overshoot_error_and_distance_of_a_made_up_run() -> None:
    speed = V + np.where(TIME < 5.0, -0.25, 0.5) * (TIME > 3.0)
    error = np.where(TIME < 2.0, 9.0, 0.3)  # before the first curve it does not count
    found = analysis.maneuver(TIME, speed, V, error, 10.0 + V * TIME)
    assert found == pytest.approx((0.9, 1.8, 0.3, 10.0 * V))


def test_a_run_that_ends_before_the_first_curve_is_refused() -> None:
    short = TIME[:100]
    with pytest.raises(ValueError, match=r"ends at 0.99 s, before the first curve at 2 s"):
        analysis.maneuver(short, 0.0 * short, V, 0.0 * short, 0.0 * short)


def test_the_time_to_a_speed_is_between_samples() -> None:
    assert analysis.time_to_speed(TIME, 3.0 * TIME, 10.0, 0.99) == pytest.approx(3.3)
    assert analysis.time_to_speed(TIME, 3.0 * TIME, 10.0, 0.0) == 0.0
    assert math.isnan(analysis.time_to_speed(TIME, 0.0 * TIME, 10.0))


def test_the_printed_torque_of_the_air_needs_another_density() -> None:
    density = analysis.density_for(93.2, P, V)
    assert density == pytest.approx(1.164, abs=5e-4)
    other = TwoMotorVehicle.Parameters(air_density=density)
    assert resistance_torques(other, V, 0.0)[0] == pytest.approx(93.2, rel=1e-9)


def test_the_printed_rise_needs_2_7_g_and_the_motors_give_a_third_of_one() -> None:
    assert analysis.acceleration_of_rise(V, 0.5) == pytest.approx(2.72, abs=0.01)
    assert analysis.grip_limit(P, TORQUE_LIMIT) == pytest.approx(0.324, abs=1e-3)


def test_friction_is_highest_at_the_peak_slip() -> None:
    peak = analysis.peak_slip(P)
    assert peak == pytest.approx(0.170, abs=5e-4)
    highest = friction(P, peak)
    assert all(friction(P, s) < highest for s in (0.9 * peak, 1.1 * peak))


def test_the_printed_derivative_gain_grows_at_any_sampling_of_a_control_unit() -> None:
    """The bound of (D7) is 118 kHz behind a lag of 3 ms; without a lag there is none."""
    growth = [analysis.derivative_growth(P, 2500.0, 0.003, 1.0 / rate) for rate in (100.0, 1e3, 1e4, 125e3)]
    assert growth == sorted(growth, reverse=True)
    assert growth[2] > 10.0
    assert growth[3] < 1.0
    assert analysis.derivative_growth(P, 2500.0, 1e-9, 1.0) == pytest.approx(2500.0 / P.wheel_inertia)
