"""TwoWheelerBraking: equations, convergence, energy, standstill, locked and lifted wheels, odd parameters."""

from __future__ import annotations

import itertools
import math
from dataclasses import asdict, astuple, replace

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from evcosim.models.base import violations
from evcosim.models.constants import GRAVITY
from evcosim.models.road_friction import Road, friction_coefficient
from evcosim.models.two_wheeler_braking import TwoWheelerBraking, loads, slip

P = TwoWheelerBraking.Parameters()
Parameters, Inputs, State = TwoWheelerBraking.Parameters, TwoWheelerBraking.Inputs, TwoWheelerBraking.State
DT = 0.01
speeds = st.floats(0.0, 60.0)
roads = st.sampled_from(list(Road))


def start(p: Parameters = P) -> State:
    return TwoWheelerBraking.initial(p, Inputs())


def stop(p: Parameters, u: Inputs, dt: float = DT) -> list[State]:
    """The states down to standstill under constant torques."""
    found = [start(p)]
    while found[-1].speed > 0.0 and len(found) < 20_000:
        found.append(TwoWheelerBraking.step(p, found[-1], u, dt))
    return found


# -- equations ---------------------------------------------------------------------------------------------


@given(roads, speeds, speeds, speeds)
@example(Road.DRY, 3.0, 0.0, 4.0)  # front wheel locked, rear wheel driving: the front wheel lifts
def test_newton_and_the_loads(road: Road, v: float, front: float, rear: float) -> None:
    """(1), (2), (5) hold together: the acceleration is the one that its own loads give."""
    p = replace(P, road=road)
    y = TwoWheelerBraking.outputs(p, State(v, front, rear, 0.0, 0.0, 0.0))
    air = 0.5 * p.air_density * p.drag_area * v * v
    assert p.mass * y.deceleration == pytest.approx(y.front_force + y.rear_force + air, abs=1e-8)  # (1)
    assert y.front_load + y.rear_load == pytest.approx(p.mass * GRAVITY)
    assert y.front_force == pytest.approx(y.front_load * friction_coefficient(road, y.front_slip), abs=1e-8)
    assert y.rear_force == pytest.approx(y.rear_load * friction_coefficient(road, y.rear_slip), abs=1e-8)
    moment = p.mass * p.center_height * y.deceleration / p.wheelbase
    both = p.mass * GRAVITY * p.rear_distance / p.wheelbase + moment  # (5), below 0 where the wheel lifts
    assert y.front_load == pytest.approx(min(p.mass * GRAVITY, max(0.0, both)), abs=1e-8)


@given(speeds, speeds)
def test_slip_is_between_minus_one_and_one(v: float, rim: float) -> None:
    assert -1.0 <= slip(v, rim) <= 1.0
    assert slip(v, rim) == -slip(rim, v)
    assert slip(v, 0.0) == (1.0 if v > 0.0 else 0.0)


def test_a_slip_at_standstill_is_none() -> None:
    assert slip(0.0, 0.0) == 0.0
    y = TwoWheelerBraking.outputs(P, State())
    assert y.front_slip == y.rear_slip == y.deceleration == y.front_force == 0.0
    assert y.front_load == pytest.approx(200.0 * 9.81 * 0.516 / 1.35)


def test_wheels_react_to_torque_and_road() -> None:
    """(1) at the start: J w' = -T before there is any slip."""
    x = TwoWheelerBraking.step(P, start(), Inputs(100.0, 50.0), 1e-6)
    y = TwoWheelerBraking.outputs(P, x)
    assert (y.front_wheel_speed - start().speed / 0.25) / 1e-6 == pytest.approx(-100.0 / 0.79, rel=1e-3)
    assert (y.rear_wheel_speed - start().speed / 0.25) / 1e-6 == pytest.approx(-50.0 / 0.79, rel=1e-3)


def test_a_free_wheel_is_slowed_by_the_road_and_pushes_the_vehicle() -> None:
    x = start()
    for _ in range(50):
        x = TwoWheelerBraking.step(P, x, Inputs(300.0, 0.0), DT)
    y = TwoWheelerBraking.outputs(P, x)
    assert y.rear_slip < 0.0
    assert y.rear_force == pytest.approx(-0.79 / 0.25**2 * y.deceleration, rel=0.01)  # J w' = r F_x


# -- the step ----------------------------------------------------------------------------------------------


def end_of_half_a_second(n: int, dt: float) -> float:
    x = start()
    for _ in range(n):
        x = TwoWheelerBraking.step(P, x, Inputs(350.0, 100.0), dt)
    return x.front_rim_speed


def test_halving_the_inner_step_converges() -> None:
    """Below 0.2 ms a step is one inner step: order 2."""
    a, b, c = (end_of_half_a_second(5000 * k, 1e-4 / k) for k in (1, 2, 4))
    assert abs(a - b) < 1e-6
    assert (a - b) / (b - c) == pytest.approx(4.0, rel=0.1)


def test_a_long_step_is_many_short_ones() -> None:
    x = y = start()
    u = Inputs(400.0, 120.0)
    x = TwoWheelerBraking.step(P, x, u, 0.01)
    for _ in range(50):
        y = TwoWheelerBraking.step(P, y, u, 2e-4)
    assert astuple(x) == pytest.approx(astuple(y), abs=1e-12)


@settings(max_examples=30)
@given(roads, st.floats(0.0, 800.0), st.floats(0.0, 400.0))
def test_friction_and_brakes_only_take_energy(road: Road, front: float, rear: float) -> None:
    p = replace(P, road=road)

    def energy(x: State) -> float:
        wheels = 0.5 * p.wheel_inertia / p.wheel_radius**2 * (x.front_rim_speed**2 + x.rear_rim_speed**2)
        return 0.5 * p.mass * x.speed**2 + wheels

    x, left = start(p), energy(start(p))
    for _ in range(60):
        x = TwoWheelerBraking.step(p, x, Inputs(front, rear), DT)
        assert energy(x) < left
        left = energy(x)


def test_a_locked_wheel_stands_until_the_road_overcomes_its_brake() -> None:
    x = start()
    for _ in range(100):
        x = TwoWheelerBraking.step(P, x, Inputs(2000.0, 2000.0), DT)
    assert x.front_rim_speed == x.rear_rim_speed == 0.0
    y = TwoWheelerBraking.outputs(P, x)
    assert y.front_slip == y.rear_slip == 1.0
    held = TwoWheelerBraking.step(P, x, Inputs(1.01 * 0.25 * y.front_force, 2000.0), DT)
    assert held.front_rim_speed == 0.0
    freed = TwoWheelerBraking.step(P, x, Inputs(0.5 * 0.25 * y.front_force, 2000.0), DT)
    assert freed.front_rim_speed > 0.0
    assert freed.rear_rim_speed == 0.0


def test_sliding_to_standstill() -> None:
    """Both wheels locked: constant friction, and with air drag v dv/dx = -(mu g + c v^2/m)."""
    states = stop(P, Inputs(1e6, 1e6))
    mu_g, c = friction_coefficient(Road.DRY, 1.0) * GRAVITY, 0.5 * 1.2 * 0.388 / 200.0
    v0 = 100.0 / 3.6
    closed = math.log(1.0 + c * v0**2 / mu_g) / (2.0 * c)
    assert states[-1].stopping_distance == pytest.approx(closed, abs=0.01)  # wheels lock within 1 ms


# -- the end of the stop -----------------------------------------------------------------------------------


@pytest.mark.parametrize("road", list(Road))
def test_the_stop_ends_with_constant_deceleration(road: Road) -> None:
    p = replace(P, road=road)
    states = stop(p, Inputs(60.0, 30.0))
    last = states[-1]
    assert last.speed == last.front_rim_speed == last.rear_rim_speed == 0.0
    assert last.distance == last.stopping_distance > 0.0
    assert [s.stopping_distance for s in states if s.speed > 1.0] == [0.0] * sum(
        s.speed > 1.0 for s in states
    )
    slow = [s for s in states if 0.0 < s.speed <= 1.0]
    assert {s.stop_deceleration for s in slow} == {last.stop_deceleration}
    for s in slow:
        rest = s.speed**2 / (2.0 * s.stop_deceleration)
        assert s.distance + rest == pytest.approx(last.stopping_distance, abs=1e-12)
    slips = [slip(s.speed, s.front_rim_speed) for s in slow]
    assert max(slips) - min(slips) < 1e-9
    for a, b in itertools.pairwise(states):
        assert b.speed <= a.speed
        assert b.distance >= a.distance


def test_the_crossing_of_the_stop_speed_does_not_depend_on_the_step() -> None:
    u = Inputs(300.0, 100.0)
    found = [stop(P, u, dt)[-1].stopping_distance for dt in (0.02, 0.01, 0.005, 0.001, 2e-4)]
    assert max(found) - min(found) < 1e-6


def test_standstill_is_the_end() -> None:
    x = stop(P, Inputs(300.0, 100.0))[-1]
    assert TwoWheelerBraking.step(P, x, Inputs(300.0, 100.0), 5.0) == x


# -- odd parameters ----------------------------------------------------------------------------------------


def test_a_start_below_the_stop_speed_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"initial_speed = 3\.0 km/h must be above stop_speed = 1\.0 m/s \(3\.6 "
    ):
        start(replace(P, initial_speed=3.0))


def test_a_wheel_in_the_air_leaves_all_the_weight_to_the_other() -> None:
    p = replace(P, center_height=0.9)
    y = TwoWheelerBraking.outputs(p, State(20.0, 16.0, 16.0, 0.0, 0.0, 0.0))
    assert y.rear_load == y.rear_force == 0.0
    assert y.front_load == pytest.approx(200.0 * 9.81)
    assert y.deceleration > p.front_distance / p.center_height * GRAVITY  # what lifts the wheel
    assert loads(p, 100.0) == (0.0, 200.0 * 9.81)


@given(st.floats(0.3, 3.0), st.floats(0.0, 0.5), st.floats(0.0, 0.5))
def test_wheels_lift_without_a_jump(height: float, front: float, rear: float) -> None:
    """Even where (S1) has no solution (l <= h (mu_f - mu_r)), loads are in order and Newton holds."""
    p = replace(P, center_height=height)
    y = TwoWheelerBraking.outputs(p, State(20.0, 20.0 * (1.0 - front), 20.0 * (1.0 - rear), 0.0, 0.0, 0.0))
    assert 0.0 <= y.front_load <= 200.0 * 9.81 + 1e-9
    air = 0.5 * 1.2 * 0.388 * 20.0**2
    assert y.front_force == pytest.approx(y.front_load * friction_coefficient(Road.DRY, front), abs=1e-8)
    assert y.rear_force == pytest.approx(y.rear_load * friction_coefficient(Road.DRY, rear), abs=1e-8)
    assert 200.0 * y.deceleration == pytest.approx(y.front_force + y.rear_force + air)
    near = State(20.0, 20.0 * (1.0 - front) + 1e-9, 20.0 * (1.0 - rear), 0.0, 0.0, 0.0)
    if p.wheelbase - height * 1.3 > 0.1:
        assert TwoWheelerBraking.outputs(p, near).deceleration == pytest.approx(y.deceleration, abs=1e-4)


@pytest.mark.parametrize(
    "p",
    [
        replace(P, wheel_inertia=0.01),
        replace(P, stop_speed=0.1),
        replace(P, mass=2000.0),
        replace(P, initial_speed=300.0, road=Road.SNOW),
        replace(P, drag_area=0.0, air_density=0.0),
    ],
    ids=lambda p: str(asdict(p)),
)
def test_stiff_and_odd_vehicles_stay_calm(p: Parameters) -> None:
    """The inner step follows the fastest eigenvalue: no slip jumps to and fro under constant torque."""
    x, u = start(p), Inputs(20.0, 10.0)
    slips = []
    for _ in range(40):
        x = TwoWheelerBraking.step(p, x, u, DT)
        y = TwoWheelerBraking.outputs(p, x)
        assert violations(y) == []
        slips.append(y.front_slip)
    assert all(abs(b - a) < 0.02 for a, b in itertools.pairwise(slips[2:]))


def test_negative_torques_are_none() -> None:
    assert TwoWheelerBraking.step(P, start(), Inputs(-5.0, -9.0), DT) == TwoWheelerBraking.step(
        P, start(), Inputs(), DT
    )
