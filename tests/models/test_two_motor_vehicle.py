"""TwoMotorVehicle: the paper's torques, equilibrium, energy, symmetry, stiff slip, standstill, odd cars."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.models.base import violations
from evcosim.models.two_motor_vehicle import TwoMotorVehicle, friction, resistance_torques, slip

P = TwoMotorVehicle.Parameters()
CRUISE = TwoMotorVehicle.Parameters(initial_speed=60.0 / 3.6)
HOLDING = 0.5 * (96.048 + 137.873664)  # N.m at each wheel
SLOPE = math.atan(0.1)
NOTHING = TwoMotorVehicle.Inputs()
torques = st.floats(-2300.0, 2300.0)


def drive(
    x: TwoMotorVehicle.State, u: TwoMotorVehicle.Inputs, seconds: float, steps: int | None = None
) -> TwoMotorVehicle.State:
    """The state after `seconds` of constant inputs, in steps of 10 ms unless their number is given."""
    n = steps or round(seconds / 0.01)
    for _ in range(n):
        x = TwoMotorVehicle.step(P, x, u, seconds / n)
    return x


def cruising() -> TwoMotorVehicle.State:
    """60 km/h in equilibrium."""
    return TwoMotorVehicle.initial(CRUISE, NOTHING)


# -- the paper's numbers -----------------------------------------------------------------------------------


def test_torques_at_60_kmh() -> None:
    aero, slope, rolling = resistance_torques(P, 60.0 / 3.6, 0.0)
    assert aero == pytest.approx(0.5 * 1.2 * 3.48 * 0.46 * 0.36 * (60.0 / 3.6) ** 2, rel=1e-9)  # (2)
    assert rolling == pytest.approx(3904.0 * 9.81 * 0.36 * 0.01, rel=1e-9)  # (4)
    assert slope == 0.0
    climb = resistance_torques(P, 60.0 / 3.6, SLOPE)[1]
    assert climb == pytest.approx(3904.0 * 9.81 * 0.36 * math.sin(SLOPE), rel=1e-9)  # (3)
    assert (aero, rolling, climb) == pytest.approx((96.05, 137.9, 1372.0), abs=0.11)


def test_outputs_show_the_papers_torques() -> None:
    y = TwoMotorVehicle.outputs(P, cruising(), TwoMotorVehicle.Inputs(road_grade=SLOPE))
    assert y.aerodynamic_torque == pytest.approx(96.05, abs=0.005)
    assert y.slope_torque == pytest.approx(1372.0, abs=0.5)
    assert y.rolling_torque == pytest.approx(137.9 * math.cos(SLOPE), abs=0.05)


def test_rate_of_the_slip() -> None:
    """The number by which the inner step is chosen is the one that the equations have."""
    x, small = cruising(), 1e-4
    at_rest = TwoMotorVehicle.outputs(P, x, NOTHING).left_force
    faster = TwoMotorVehicle.State(x.left_wheel_speed + small, x.right_wheel_speed, x.speed, 0.0)
    rate = (TwoMotorVehicle.outputs(P, faster, NOTHING).left_force - at_rest) * 0.36 / 7.07 / small
    assert rate == pytest.approx(P.stiffness / x.speed, rel=0.05)
    assert P.stiffness / x.speed == pytest.approx(318.0, abs=1.0)


# -- balances ----------------------------------------------------------------------------------------------


def test_a_start_in_equilibrium_stays_there() -> None:
    x = cruising()
    u = TwoMotorVehicle.Inputs(HOLDING, HOLDING)
    assert TwoMotorVehicle.outputs(CRUISE, x, u).acceleration == pytest.approx(0.0, abs=1e-12)
    after = drive(x, u, 5.0)
    assert after.speed == pytest.approx(x.speed, abs=1e-9)
    assert after.left_wheel_speed == pytest.approx(x.left_wheel_speed, abs=1e-9)
    assert after.distance == pytest.approx(5.0 * x.speed, rel=1e-9)


def test_energy_over_a_ride() -> None:
    """Work of the drives = kinetic energy of car and wheels + air, rolling, climbing, slip of the tires."""
    x = start = cruising()
    dt, work, lost = 1e-3, 0.0, 0.0
    for k in range(3000):
        u = TwoMotorVehicle.Inputs(
            600.0 + 400.0 * math.sin(k / 200), 500.0, 0.0, SLOPE if 1000 <= k < 2000 else 0.0
        )
        after = TwoMotorVehicle.step(P, x, u, dt)
        for s in (x, after):
            y = TwoMotorVehicle.outputs(P, s, u)
            work += 0.5 * dt * (u.left_torque * s.left_wheel_speed + u.right_torque * s.right_wheel_speed)
            resisting = (y.aerodynamic_torque + y.slope_torque + y.rolling_torque) / 0.36 * s.speed
            left = y.left_force * (0.36 * s.left_wheel_speed - s.speed)
            right = y.right_force * (0.36 * s.right_wheel_speed - s.speed)
            lost += 0.5 * dt * (resisting + left + right)
            assert left >= 0.0 <= right  # a tire takes energy whichever way it slips
        x = after

    def kinetic(s: TwoMotorVehicle.State) -> float:
        wheels = 0.5 * 7.07 * (s.left_wheel_speed**2 + s.right_wheel_speed**2)
        return 0.5 * 3904.0 * s.speed**2 + wheels

    assert work == pytest.approx(kinetic(x) - kinetic(start) + lost, rel=2e-4)


@given(torques, torques, st.floats(-0.7, 0.7), st.floats(-0.2, 0.2))
@settings(max_examples=30)
def test_left_and_right_are_mirror_images(t_1: float, t_2: float, angle: float, grade: float) -> None:
    a = drive(cruising(), TwoMotorVehicle.Inputs(t_1, t_2, angle, grade), 0.2)
    b = drive(cruising(), TwoMotorVehicle.Inputs(t_2, t_1, -angle, grade), 0.2)
    assert (a.left_wheel_speed, a.right_wheel_speed) == pytest.approx(
        (b.right_wheel_speed, b.left_wheel_speed), rel=1e-12
    )
    assert a.speed == pytest.approx(b.speed, rel=1e-12)


@given(torques, torques)
@settings(max_examples=30)
def test_on_a_level_road_backward_is_forward_mirrored(t_1: float, t_2: float) -> None:
    a = drive(TwoMotorVehicle.State(), TwoMotorVehicle.Inputs(t_1, t_2), 0.3)
    b = drive(TwoMotorVehicle.State(), TwoMotorVehicle.Inputs(-t_1, -t_2), 0.3)
    assert (b.speed, b.left_wheel_speed) == (-a.speed, -a.left_wheel_speed)


@given(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0))
def test_slip_is_odd_bounded_at_speed_and_friction_has_its_sign(rim: float, ground: float) -> None:
    s = slip(rim, ground)
    assert slip(-rim, -ground) == -s
    assert abs(s) <= 2.0
    assert friction(P, -s) == -friction(P, s)
    assert friction(P, s) * s >= 0.0
    assert abs(friction(P, s)) <= 1.2801


def test_in_a_curve_the_wheels_roll_at_their_own_speeds() -> None:
    x = drive(cruising(), TwoMotorVehicle.Inputs(HOLDING, HOLDING, math.radians(1.5)), 1.0)
    assert x.right_wheel_speed / x.left_wheel_speed == pytest.approx(46.660 / 45.933, rel=1e-4)


# -- the step ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "t_1", "t_2", "grade"),
    [(60.0, 900.0, 400.0, SLOPE), (60.0, -1500.0, -1500.0, -SLOPE), (0.0, 2297.0, 2297.0, 0.0)],
)
def test_ten_milliseconds_are_enough(start: float, t_1: float, t_2: float, grade: float) -> None:
    x = TwoMotorVehicle.initial(TwoMotorVehicle.Parameters(initial_speed=start / 3.6), NOTHING)
    u = TwoMotorVehicle.Inputs(t_1, t_2, 0.0, grade)
    coarse, fine = drive(x, u, 1.0), drive(x, u, 1.0, 20_000)
    assert coarse.speed == pytest.approx(fine.speed, abs=2e-3)
    assert coarse.left_wheel_speed == pytest.approx(fine.left_wheel_speed, abs=1e-2)
    assert coarse.distance == pytest.approx(fine.distance, abs=2e-3)


@pytest.mark.parametrize("dt", [0.001, 0.01, 0.05, 0.2])
def test_any_communication_step_gives_the_same_launch(dt: float) -> None:
    x = drive(TwoMotorVehicle.State(), TwoMotorVehicle.Inputs(2297.0, 2297.0), 2.0, round(2.0 / dt))
    inertia = 3904.0 + 2.0 * 7.07 / 0.36**2  # wheels that do not slip
    level = (2.0 * 2297.0 / 0.36 - 3904.0 * 9.81 * 0.01) / inertia * 2.0  # m/s, without air
    assert x.speed == pytest.approx(level, rel=3e-3)
    assert x.speed == pytest.approx(6.159056, abs=1e-6)


# -- standstill, limits, odd inputs ------------------------------------------------------------------------


def test_at_rest_it_rests() -> None:
    assert drive(TwoMotorVehicle.State(), NOTHING, 1.0) == TwoMotorVehicle.State()


def test_it_coasts_to_a_stop_without_moving_backward() -> None:
    x = TwoMotorVehicle.initial(TwoMotorVehicle.Parameters(initial_speed=1.0), NOTHING)
    halfway = drive(x, NOTHING, 9.0)
    assert halfway.speed == pytest.approx(1.0 - 9.81 * 0.01 * 9.0 * 3904.0 / (3904.0 + 109.1), abs=5e-3)
    end = drive(halfway, NOTHING, 10.0)
    assert 0.0 <= end.speed < 1e-3


def test_on_a_slope_without_torque_it_rolls_back() -> None:
    x = drive(TwoMotorVehicle.State(), TwoMotorVehicle.Inputs(road_grade=0.05), 2.0)
    assert x.speed == pytest.approx(-9.81 * (math.sin(0.05) - 0.01) * 2.0 * 3904.0 / 4013.1, rel=0.02)


def test_more_torque_than_the_tire_holds_spins_the_wheel_alone() -> None:
    x = drive(cruising(), TwoMotorVehicle.Inputs(8000.0, HOLDING), 0.5)
    y = TwoMotorVehicle.outputs(P, x, NOTHING)
    assert y.left_slip > 0.5
    assert y.right_slip < 0.02
    assert y.left_force == pytest.approx(9574.0 * friction(P, y.left_slip), rel=1e-3)


@given(st.floats(-8000.0, 8000.0), st.floats(-8000.0, 8000.0), st.floats(-10.0, 10.0), st.floats(-1.5, 1.5))
@settings(max_examples=25)
def test_whatever_is_asked_it_stays_finite(t_1: float, t_2: float, angle: float, grade: float) -> None:
    x, u = cruising(), TwoMotorVehicle.Inputs(t_1, t_2, angle, grade)
    for _ in range(20):
        x = TwoMotorVehicle.step(P, x, u, 0.1)
    assert violations(x) == []
    assert violations(TwoMotorVehicle.outputs(P, x, u)) == []


@given(st.floats(-70.0, 70.0))
def test_every_speed_has_its_equilibrium(speed: float) -> None:
    p = TwoMotorVehicle.Parameters(initial_speed=speed)
    x = TwoMotorVehicle.initial(p, NOTHING)
    y = TwoMotorVehicle.outputs(p, x, NOTHING)
    assert y.acceleration == pytest.approx(0.0, abs=1e-9)
    assert (y.left_force >= 0.0) == (speed >= 0.0) or abs(y.left_force) < 1e-9


def test_a_speed_that_the_tires_cannot_hold_is_refused() -> None:
    p = TwoMotorVehicle.Parameters(initial_speed=170.0, air_density=2.0)
    with pytest.raises(ValueError, match=r"initial_speed = 170.0 m/s needs a friction of 2\.4"):
        TwoMotorVehicle.initial(p, NOTHING)


def test_a_car_that_cannot_turn_so_far_is_refused() -> None:
    with pytest.raises(ValueError, match="must be above track/2"):
        TwoMotorVehicle.initial(TwoMotorVehicle.Parameters(wheelbase=0.5), NOTHING)
    assert violations(TwoMotorVehicle.Parameters(wheelbase=0.0)) == [
        "wheelbase = 0.0 m is below its minimum 0.1 m"
    ]
