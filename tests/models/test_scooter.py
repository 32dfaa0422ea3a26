"""Scooter: power balance, working points of the paper, order of the step, standstill, limits."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evcosim.models.base import violations
from evcosim.models.scooter import Scooter, level_road_load, maximum_force

P = Scooter.Parameters()
DT = 0.01
throttles = st.floats(0.0, 100.0)
grades = st.floats(-0.3, 0.3)


def drive(
    x: Scooter.State, u: Scooter.Inputs, seconds: float, steps: int | None = None, p: Scooter.Parameters = P
) -> Scooter.State:
    """The state after `seconds` of constant inputs, in steps of 10 ms unless their number is given."""
    n = steps or round(seconds / DT)
    for _ in range(n):
        x = Scooter.step(p, x, u, seconds / n)
    return x


def steady_throttle(kmh: float) -> float:
    """The throttle [%] that keeps a speed [km/h] on a level road."""
    v = kmh / 3.6
    return 100.0 * level_road_load(P, v) / maximum_force(P, v)


# -- the paper's working points ----------------------------------------------------------------------------


POLES = {25: 0.0411, 30: 0.0300, 35: 0.0253, 40: 0.0228, 45: 0.0214, 49: 0.0206}


def step_response(kmh: float) -> tuple[float, float]:
    """Gain [km/h per %] and pole [Hz] from a step of 0.01 % of the throttle at a working point."""
    small = 0.01
    u = Scooter.Inputs(steady_throttle(kmh) + small)
    start = drive(Scooter.State(kmh / 3.6, 0.0, 0.0), Scooter.Inputs(steady_throttle(kmh)), 200.0)
    half = drive(start, u, 10.0)
    full = drive(half, u, 10.0)
    ratio = (full.speed - half.speed) / (half.speed - start.speed)  # exp(-10 s * pole), of a first-order lag
    gain = 3.6 * (half.speed - start.speed) / (1.0 - ratio) / small
    return gain, -math.log(ratio) / 10.0 / (2.0 * math.pi)


@pytest.mark.parametrize("kmh", POLES)
def test_gain_and_pole_of_the_working_points(kmh: int) -> None:
    gain, pole = step_response(kmh)
    assert gain == pytest.approx(0.46, rel=0.01)
    assert pole == pytest.approx(POLES[kmh], rel=0.01)


def test_the_pole_gets_slower_with_speed_and_the_gain_does_not() -> None:
    found = [step_response(v) for v in range(25, 50, 4)]
    assert all(a[1] > b[1] for a, b in pairwise(found))
    assert all(abs(gain - 0.46) < 0.05 * 0.46 for gain, _ in found)


def test_force_of_the_matched_point() -> None:
    assert maximum_force(P, 30.0 / 3.6) == pytest.approx(2.4085 * P.mass, rel=1e-4)
    assert 3.6 * P.force_map.offset == pytest.approx(17.03, abs=0.005)


@given(st.floats(100.0, 400.0), st.floats(0.0, 14.0))
def test_the_map_belongs_to_the_drive(mass: float, v: float) -> None:
    assert maximum_force(Scooter.Parameters(mass=mass, drag_area=0.3), v) == maximum_force(P, v)


# -- balances ----------------------------------------------------------------------------------------------


@given(st.floats(0.1, 15.0), st.floats(0.0, 850.0), st.floats(0.0, 1500.0), grades)
def test_power_balance_at_an_instant(v: float, force: float, brake: float, grade: float) -> None:
    """Drive power = change of kinetic energy + brake + air, viscous and rolling losses + climbing."""
    y = Scooter.outputs(P, Scooter.State(v, force, 0.0), Scooter.Inputs(0.0, brake, grade))
    air = 0.5 * P.air_density * P.drag_area * v**3
    rolling = P.rolling_resistance * P.mass * 9.81 * math.cos(grade) * v
    climb = P.mass * 9.81 * math.sin(grade) * v
    kinetic = P.mass * v * y.acceleration
    lost = kinetic + brake * v + air + P.viscous_resistance * v * v + rolling + climb
    assert force * v == pytest.approx(lost, abs=1e-6)
    assert y.power == pytest.approx(force * v / 0.85 + 40.0)


def test_energy_over_a_ride() -> None:
    """Work of the drive = kinetic energy + losses, summed over a ride with brake and grade."""
    x = Scooter.State(2.0, 0.0, 0.0)
    work = lost = 0.0
    for k in range(3000):
        u = Scooter.Inputs(60.0 if k < 2000 else 0.0, 0.0 if k < 2500 else 50.0, 0.02 * math.sin(k / 300))
        after = Scooter.step(P, x, u, DT)
        for state in (x, after):
            v = state.speed
            hold = P.mass * 9.81 * (0.014 * math.cos(u.road_grade) + math.sin(u.road_grade)) + u.brake_force
            work += 0.5 * DT * state.drive_force * v
            lost += 0.5 * DT * v * (hold + v * (P.viscous_resistance + P.drag * v))
        x = after
    kinetic = 0.5 * P.mass * (x.speed**2 - 2.0**2)
    assert work == pytest.approx(kinetic + lost, rel=1e-3)


@given(st.floats(0.0, 15.0), st.floats(0.1, 0.6), st.floats(0.1, 0.6))
def test_wheel_speeds_give_the_speed(v: float, front: float, rear: float) -> None:
    p = Scooter.Parameters(front_wheel_radius=front, rear_wheel_radius=rear)
    y = Scooter.outputs(p, Scooter.State(v, 0.0, 0.0), Scooter.Inputs())
    assert 0.5 * (y.front_wheel_speed * front + y.rear_wheel_speed * rear) == pytest.approx(v)


@given(st.floats(0.5, 13.0), throttles, grades)
def test_acceleration_is_the_slope_of_the_speed(v: float, throttle: float, grade: float) -> None:
    u = Scooter.Inputs(throttle, 0.0, grade)
    x = Scooter.State(v, 0.01 * throttle * maximum_force(P, v), 0.0)
    after = Scooter.step(P, x, u, 1e-5)
    slope = (after.speed - x.speed) / 1e-5
    assert Scooter.outputs(P, x, u).acceleration == pytest.approx(slope, abs=1e-3)


# -- the step ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kmh", "throttle", "grade"), [(25.0, 90.0, 0.0), (20.0, 0.0, -0.05), (45.0, 20.0, 0.1)]
)
def test_halving_the_step_quarters_the_error(kmh: float, throttle: float, grade: float) -> None:
    u = Scooter.Inputs(throttle, 0.0, grade)
    start = Scooter.State(kmh / 3.6, 0.01 * throttle * maximum_force(P, kmh / 3.6), 0.0)
    exact = drive(start, u, 2.0, 25600).speed
    errors = [drive(start, u, 2.0, n).speed - exact for n in (200, 800, 1600, 3200)]
    assert abs(errors[0]) < 1e-5  # at 10 ms; the order shows where the step resolves the drive's lag of 5 ms
    assert [a / b for a, b in pairwise(errors[1:])] == pytest.approx([4.0, 4.0], rel=0.15)


@pytest.mark.parametrize("start_kmh", [0.0, 20.0, 49.0])
def test_ten_milliseconds_are_enough_across_the_corners(start_kmh: float) -> None:
    """Pulling away, leaving the boost, entering the fade of the speed limit: still good to 1 mm/s."""
    start, u = Scooter.State(start_kmh / 3.6, 0.0, 0.0), Scooter.Inputs(100.0)
    fine = drive(start, u, 6.0, 60000)
    assert drive(start, u, 6.0).speed == pytest.approx(fine.speed, abs=1e-3)
    assert drive(start, u, 6.0).distance == pytest.approx(fine.distance, abs=1e-2)


@pytest.mark.parametrize("lag", [1e-6, 0.001, 0.005, 0.1])
def test_the_drive_lag_is_exact_at_any_step(lag: float) -> None:
    """Where the force map is flat, the force after one step is that of a first-order lag."""
    p = Scooter.Parameters(drive_time_constant=lag)
    x = Scooter.step(p, Scooter.State(1.0, 0.0, 0.0), Scooter.Inputs(50.0), DT)
    assert x.drive_force == pytest.approx(425.0 * (1.0 - math.exp(-DT / lag)))


# -- standstill, limits, odd inputs ------------------------------------------------------------------------


@given(st.floats(0.0, 15.0), st.floats(-50.0, 150.0), st.floats(-100.0, 5000.0), st.floats(-1.5, 1.5))
def test_never_backward_and_always_in_range(v: float, throttle: float, brake: float, grade: float) -> None:
    x, u = Scooter.State(v, 0.0, 0.0), Scooter.Inputs(throttle, brake, grade)
    for _ in range(50):
        after = Scooter.step(P, x, u, DT)
        assert after.distance >= x.distance
        assert violations(after) == []
        assert violations(Scooter.outputs(P, after, u)) == []
        x = after


@given(st.floats(-50.0, 150.0), st.floats(-500.0, 0.0))
def test_throttle_is_clipped_and_a_negative_brake_is_none(throttle: float, brake: float) -> None:
    x = Scooter.State(5.0, 100.0, 0.0)
    clipped = Scooter.Inputs(min(100.0, max(0.0, throttle)), 0.0)
    u = Scooter.Inputs(throttle, brake)
    assert Scooter.step(P, x, u, DT) == Scooter.step(P, x, clipped, DT)
    assert Scooter.outputs(P, x, u) == Scooter.outputs(P, x, clipped)


@given(st.floats(0.0, 12.0), st.floats(300.0, 3000.0))
def test_braked_to_a_stop_it_stays_without_chatter(v: float, brake: float) -> None:
    u = Scooter.Inputs(0.0, brake)
    x = drive(Scooter.State(v, 0.0, 0.0), u, 12.0)
    assert x.speed == 0.0
    assert Scooter.outputs(P, x, u).acceleration == 0.0
    assert drive(x, u, 0.1) == x


@given(grades, st.floats(0.0, 800.0))
def test_at_rest_it_moves_only_downhill_and_only_against_too_weak_a_brake(grade: float, brake: float) -> None:
    pull = -P.mass * 9.81 * (0.014 * math.cos(grade) + math.sin(grade)) - brake
    assume(abs(pull) > 1e-6)
    u = Scooter.Inputs(0.0, brake, grade)
    x = Scooter.step(P, Scooter.State(), u, DT)
    assert (x.speed > 0.0) == (pull > 0.0)
    assert Scooter.outputs(P, Scooter.State(), u).acceleration == pytest.approx(max(0.0, pull / P.mass))


@pytest.mark.parametrize("dt", [0.001, 0.01, 0.1])
def test_stopping_distance(dt: float) -> None:
    """Without air and viscous resistance, v^2/(2 a), whatever the step."""
    p = Scooter.Parameters(drag_area=0.0, viscous_resistance=0.0, rolling_resistance=0.0)
    x = drive(Scooter.State(10.03, 0.0, 0.0), Scooter.Inputs(0.0, 800.0), 5.0, round(5.0 / dt), p)
    assert x.speed == 0.0
    assert x.distance == pytest.approx(10.03**2 / (2.0 * 4.0), rel=1e-9)


def test_the_drive_limits_the_speed() -> None:
    x = drive(Scooter.State(), Scooter.Inputs(100.0), 60.0)
    assert 49.5 < 3.6 * x.speed < 50.5
    downhill = drive(Scooter.State(60.0 / 3.6, 0.0, 0.0), Scooter.Inputs(100.0), 0.2)
    assert downhill.drive_force == 0.0


def limited(watts: float, throttle: float = 100.0) -> Scooter.Inputs:
    return Scooter.Inputs(throttle=throttle, available_power=watts)


@given(
    st.floats(0.0, 6000.0), st.floats(0.0, 15.0), st.floats(0.0, 850.0), st.sampled_from([0.001, 0.01, 0.1])
)
def test_the_power_never_exceeds_what_is_available(watts: float, v: float, force: float, dt: float) -> None:
    x = Scooter.State(v, force, 0.0)
    for _ in range(20):
        x = Scooter.step(P, x, limited(watts), dt)
        assert Scooter.outputs(P, x, limited(watts)).power <= watts
        assert x.drive_force * x.speed <= P.drive_efficiency * max(0.0, watts - 40.0) * (1.0 + 1e-12)


@pytest.mark.parametrize("watts", [0.0, 20.0, 40.0, -5.0])
def test_without_power_for_the_drive_the_vehicle_coasts(watts: float) -> None:
    x, coasting = Scooter.State(8.0, 300.0, 0.0), Scooter.State(8.0, 0.0, 0.0)
    for _ in range(200):
        x = Scooter.step(P, x, limited(watts), DT)
        coasting = Scooter.step(P, coasting, Scooter.Inputs(0.0), DT)
        assert (x.speed, x.drive_force, x.distance) == (coasting.speed, 0.0, coasting.distance)
    assert Scooter.outputs(P, x, limited(watts)).power == max(0.0, watts)


@given(st.floats(0.0, 15.0), st.floats(0.0, 100.0))
def test_a_limit_that_is_not_reached_changes_nothing(v: float, throttle: float) -> None:
    x = free = Scooter.State(v, 0.0, 0.0)
    for _ in range(20):
        x, free = (
            Scooter.step(P, x, limited(1e5, throttle), DT),
            Scooter.step(P, free, Scooter.Inputs(throttle), DT),
        )
    assert (x.speed, x.drive_force, x.distance) == (free.speed, free.drive_force, free.distance)


def test_a_limit_is_noticed_where_it_takes_force_away() -> None:
    x = Scooter.State(5.0, 0.0, 0.0)
    for watts, noticed in ((1e6, False), (1000.0, True), (0.0, True)):
        after = Scooter.step(P, x, limited(watts), DT)
        assert bool(Scooter.notice(P, x, after, limited(watts))) == noticed
        assert not Scooter.notice(P, x, Scooter.step(P, x, limited(watts, 0.0), DT), limited(watts, 0.0))
