"""LateralVehicle: its step is exact, linear, and settles where the textbook says."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.lateral_vehicle import LateralVehicle as Vehicle
from evcosim.models.lateral_vehicle import transition

P = Vehicle.Parameters()
numbers = st.floats(-1.0, 1.0)
states = st.builds(Vehicle.State, numbers, numbers, numbers, numbers)
angles = st.builds(Vehicle.Inputs, numbers, numbers)
disturbed = st.builds(Vehicle.Inputs, numbers, numbers, st.floats(-30.0, 30.0), numbers)


def derivative(p: Vehicle.Parameters, x: Vehicle.State, u: Vehicle.Inputs) -> Vehicle.State:
    """From the forces of wind and tires, not A, B and E: slip angles, Newton, Euler, the lane's geometry."""
    lost = abs(u.front_blowout)
    sound, blown = p.front_cornering_stiffness, p.blown_stiffness * p.front_cornering_stiffness
    front_stiffness = sound + (1.0 - lost) * sound + lost * blown
    wheelbase = p.front_axle_distance + p.rear_axle_distance
    drag = p.blown_resistance * p.mass * 9.81 * p.rear_axle_distance / wheelbase / 2.0 * u.front_blowout
    attack = math.atan(u.crosswind / p.speed)
    wind = p.air_density / 2.0 * p.side_area * attack * math.hypot(p.speed, u.crosswind) ** 2
    front_slip = u.front_steering_angle - (x.lateral_velocity + p.front_axle_distance * x.yaw_rate) / p.speed
    rear_slip = u.rear_steering_angle - (x.lateral_velocity - p.rear_axle_distance * x.yaw_rate) / p.speed
    front, rear = (
        front_stiffness * front_slip,
        2.0 * p.rear_cornering_stiffness * rear_slip,
    )
    return Vehicle.State(
        (front + rear + wind) / p.mass - p.speed * x.yaw_rate,
        x.yaw_rate,
        (
            p.front_axle_distance * front
            - p.rear_axle_distance * rear
            + p.wind_distance * wind
            + p.track / 2.0 * drag
        )
        / p.yaw_inertia,
        -x.lateral_velocity - p.speed * x.heading_angle,
    )


def moved(x: Vehicle.State, slope: Vehicle.State, dt: float) -> Vehicle.State:
    """x + dt slope."""
    a, b = dataclasses.astuple(x), dataclasses.astuple(slope)
    return Vehicle.State(*[i + dt * j for i, j in zip(a, b, strict=True)])


def runge_kutta(x: Vehicle.State, u: Vehicle.Inputs, dt: float, steps: int) -> Vehicle.State:
    """Independent of the model's own step: the classical method of order 4."""
    h = dt / steps
    for _ in range(steps):
        k1 = derivative(P, x, u)
        k2 = derivative(P, moved(x, k1, h / 2), u)
        k3 = derivative(P, moved(x, k2, h / 2), u)
        k4 = derivative(P, moved(x, k3, h), u)
        for slope, weight in ((k1, 1), (k2, 2), (k3, 2), (k4, 1)):
            x = moved(x, slope, weight * h / 6)
    return x


def close(a: Vehicle.State, b: Vehicle.State, tolerance: float) -> bool:
    """Whether two states agree."""
    return dataclasses.astuple(a) == pytest.approx(dataclasses.astuple(b), abs=tolerance)


@given(states, st.one_of(angles, disturbed))
def test_a_step_solves_the_forces_of_the_axles(x: Vehicle.State, u: Vehicle.Inputs) -> None:
    assert close(Vehicle.step(P, x, u, 0.1), runge_kutta(x, u, 0.1, 50), 1e-7)


@given(states, st.one_of(angles, disturbed), st.sampled_from([0.001, 0.01, 0.3]))
def test_one_step_is_two_of_half_the_size(x: Vehicle.State, u: Vehicle.Inputs, dt: float) -> None:
    half = Vehicle.step(P, Vehicle.step(P, x, u, dt / 2), u, dt / 2)
    assert close(Vehicle.step(P, x, u, dt), half, 1e-11)


@given(states, states, angles, angles)
def test_effects_add_up(a: Vehicle.State, b: Vehicle.State, u: Vehicle.Inputs, w: Vehicle.Inputs) -> None:
    both = Vehicle.step(
        P,
        moved(a, b, 1.0),
        Vehicle.Inputs(
            u.front_steering_angle + w.front_steering_angle, u.rear_steering_angle + w.rear_steering_angle
        ),
        0.01,
    )
    assert close(both, moved(Vehicle.step(P, a, u, 0.01), Vehicle.step(P, b, w, 0.01), 1.0), 1e-12)


@pytest.mark.parametrize("speed", [5.0, 21.3, 40.0])
def test_a_steady_turn_has_the_yaw_rate_of_the_understeer_gradient(speed: float) -> None:
    """w_z = v delta_f/(L + k v^2), k = (m/L)(l_2/(2 C_f) - l_1/(2 C_r)): Rajamani, Vehicle Dynamics."""
    p = Vehicle.Parameters(speed=speed)
    wheelbase = p.front_axle_distance + p.rear_axle_distance
    gradient = (
        p.mass
        / wheelbase
        * (
            p.rear_axle_distance / (2.0 * p.front_cornering_stiffness)
            - p.front_axle_distance / (2.0 * p.rear_cornering_stiffness)
        )
    )
    x = Vehicle.step(p, Vehicle.initial(p, Vehicle.Inputs()), Vehicle.Inputs(0.01, 0.0), 30.0)
    assert x.yaw_rate == pytest.approx(speed * 0.01 / (wheelbase + gradient * speed**2), rel=1e-9)


def test_going_straight_the_heading_alone_carries_it_across_the_lane() -> None:
    """Without slip, y' = 0, theta constant: beta falls by v_x theta t."""
    x = Vehicle.step(P, Vehicle.State(0.0, 0.01, 0.0, 0.5), Vehicle.Inputs(), 2.0)
    assert x.heading_angle == pytest.approx(0.01)
    assert x.displacement == pytest.approx(0.5 - 21.3 * 0.01 * 2.0)


def test_it_starts_where_the_parameters_say() -> None:
    p = Vehicle.Parameters(
        initial_lateral_velocity=0.1,
        initial_heading_angle=0.2,
        initial_yaw_rate=0.3,
        initial_displacement=-0.4,
    )
    assert Vehicle.outputs(p, Vehicle.initial(p, Vehicle.Inputs())) == Vehicle.Outputs(0.1, 0.2, 0.3, -0.4)


def test_the_exponential_is_computed_once_for_a_step_size(monkeypatch: pytest.MonkeyPatch) -> None:
    p = Vehicle.Parameters()
    x = Vehicle.step(p, Vehicle.State(1.0), Vehicle.Inputs(), 0.01)
    monkeypatch.setattr("evcosim.models.bicycle.exponential", lambda *_: pytest.fail("computed again"))
    assert math.isfinite(Vehicle.step(p, x, Vehicle.Inputs(), 0.01).displacement)


@given(states, angles)
def test_without_wind_and_blow_out_a_step_is_that_of_a_and_b(x: Vehicle.State, u: Vehicle.Inputs) -> None:
    """To the last bit, whatever wind and blown tire would do, and next to nothing of them changes little."""
    given = (*dataclasses.astuple(x), u.front_steering_angle, u.rear_steering_angle)
    plain = np.array(transition(P, 0.01, 0.0))[:, :6] @ given
    other = dataclasses.replace(P, side_area=9.0, blown_stiffness=0.0, blown_resistance=1.0, track=3.0)
    assert dataclasses.astuple(Vehicle.step(other, x, u, 0.01)) == pytest.approx(plain, abs=1e-13)
    assert Vehicle.step(other, x, u, 0.01) == Vehicle.step(P, x, u, 0.01)
    barely = dataclasses.replace(u, crosswind=1e-12, front_blowout=1e-12)
    assert close(Vehicle.step(P, x, barely, 0.01), Vehicle.step(P, x, u, 0.01), 1e-11)


@given(states, disturbed)
def test_in_a_mirror_everything_is_mirrored(x: Vehicle.State, u: Vehicle.Inputs) -> None:
    turned = Vehicle.step(
        P,
        moved(Vehicle.State(), x, -1.0),
        Vehicle.Inputs(-u.front_steering_angle, -u.rear_steering_angle, -u.crosswind, -u.front_blowout),
        0.01,
    )
    assert close(turned, moved(Vehicle.State(), Vehicle.step(P, x, u, 0.01), -1.0), 1e-15)


def test_wind_to_the_left_drifts_to_the_left_and_a_blown_left_tire_turns_left() -> None:
    """To the left is against the displacement."""
    windy = Vehicle.step(P, Vehicle.State(), Vehicle.Inputs(crosswind=10.0), 0.1)
    assert windy.lateral_velocity > 0.0 > windy.displacement
    assert Vehicle.step(P, Vehicle.State(), Vehicle.Inputs(front_blowout=1.0), 0.1).yaw_rate > 0.0


def test_a_blow_out_beyond_its_range_is_a_whole_one() -> None:
    x = Vehicle.State(0.1, 0.02, 0.3, 0.4)
    for whole in (1.0, -1.0):
        beyond = Vehicle.step(P, x, Vehicle.Inputs(front_blowout=2.0 * whole), 0.01)
        assert beyond == Vehicle.step(P, x, Vehicle.Inputs(front_blowout=whole), 0.01)
