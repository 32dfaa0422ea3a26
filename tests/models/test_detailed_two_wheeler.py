"""DetailedTwoWheeler: balance of power, limits in which it is TwoWheelerBraking, convergence, standstill."""

from __future__ import annotations

import math
from dataclasses import astuple, replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.base import variables, violations
from evcosim.models.constants import GRAVITY
from evcosim.models.detailed_two_wheeler import DetailedTwoWheeler, ride_of
from evcosim.models.road_friction import Road
from evcosim.models.two_wheeler_braking import TwoWheelerBraking
from evcosim.models.two_wheeler_ride import Ride, travel

P = DetailedTwoWheeler.Parameters()
Parameters, Inputs, State = DetailedTwoWheeler.Parameters, DetailedTwoWheeler.Inputs, DetailedTwoWheeler.State
DT = 0.01
small, rates = st.floats(-2e-3, 2e-3), st.floats(-0.3, 0.3)
rides = st.tuples(small, small, small, small, rates, rates, rates, rates)
slips = st.floats(-1.0, 1.0)


def start(p: Parameters = P) -> State:
    return DetailedTwoWheeler.initial(p, Inputs())


def after(p: Parameters, u: Inputs, steps: int, dt: float = DT) -> State:
    """The state after some steps under constant torques."""
    x = start(p)
    for _ in range(steps):
        x = DetailedTwoWheeler.step(p, x, u, dt)
    return x


def stop(p: Parameters, u: Inputs, dt: float = DT) -> State:
    """The state at standstill under constant torques."""
    x = start(p)
    for _ in range(20_000):
        if x.speed == 0.0:
            return x
        x = DetailedTwoWheeler.step(p, x, u, dt)
    raise AssertionError("it does not stop")


# -- the same place ----------------------------------------------------------------------------------------


def test_it_has_every_variable_of_the_plain_plant() -> None:
    for part in ("Parameters", "Inputs", "Outputs"):
        plain, detailed = (
            {v.name: v for v in variables(getattr(m, part))} for m in (TwoWheelerBraking, DetailedTwoWheeler)
        )
        assert plain.keys() <= detailed.keys()
        assert all(
            detailed[name].type == v.type and detailed[name].unit == v.unit for name, v in plain.items()
        )


def limit(stiffer: float, **changes: Any) -> Parameters:
    """Nearly rigid springs, well damped; no relaxation, no moment of the wheels."""
    damping = 12e3 * math.sqrt(stiffer)
    p = replace(P, wheel_reaction=False, relaxation_length=0.0, center_height=0.506, **changes)
    return replace(
        p,
        front_stiffness=4e6 * stiffer,
        rear_stiffness=4e6 * stiffer,
        tire_stiffness=4e6 * stiffer,
        front_damping=damping,
        rear_damping=damping,
        tire_damping=damping,
    )


@pytest.mark.parametrize(("front", "rear"), [(350.0, 80.0), (300.0, 0.0), (250.0, 120.0)])
def test_on_rigid_springs_without_relaxation_it_is_the_plain_plant(front: float, rear: float) -> None:
    """Speed, wheels and loads; the distance between the two falls with the give of the springs."""
    plain, x = (
        TwoWheelerBraking.Parameters(),
        TwoWheelerBraking.initial(TwoWheelerBraking.Parameters(), Inputs()),
    )
    for _ in range(40):
        x = TwoWheelerBraking.step(plain, x, TwoWheelerBraking.Inputs(front, rear), DT)
    y = TwoWheelerBraking.outputs(plain, x)
    apart = []
    for stiffer in (1.0, 4.0):
        p = limit(stiffer)
        z = DetailedTwoWheeler.outputs(p, after(p, Inputs(front, rear), 40))
        assert z.speed == pytest.approx(y.speed, abs=2e-3 / stiffer)
        assert z.distance == pytest.approx(y.distance, abs=1e-3 / stiffer)
        assert z.front_slip == pytest.approx(y.front_slip, abs=3e-3 / stiffer)
        assert z.front_load == pytest.approx(y.front_load, abs=2.0 / stiffer)
        apart.append(abs(z.front_load - y.front_load))
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.2)


@pytest.mark.parametrize("sigma", [1e-12, 1e-9, 1e-7])
def test_relaxation_vanishes_with_its_length(sigma: float) -> None:
    u = Inputs(350.0, 100.0)
    none, short = (after(replace(P, relaxation_length=s), u, 30) for s in (0.0, sigma))
    assert astuple(short) == pytest.approx(astuple(none), abs=1e-5)


# -- equations ---------------------------------------------------------------------------------------------


@given(
    st.floats(2.0, 60.0),
    st.floats(0.05, 1.5),
    st.floats(0.05, 1.5),
    slips,
    slips,
    rides,
    st.floats(0.0, 900.0),
    st.floats(0.0, 500.0),
)
def test_every_power_has_its_place(
    v: float, front: float, rear: float, s_f: float, s_r: float, ride: Ride, t_f: float, t_r: float
) -> None:
    """(D1)-(D6), (R1)-(R5): what kinetic and stored energy lose is that of brakes, slip, air and dampers."""
    rim_f, rim_r, k, r = front * v, rear * v, P.frame, P.wheel_radius
    now = P.motion(v, rim_f, rim_r, s_f, s_r, ride, t_f, t_r)
    _, phi, z_f, z_r, dz, dphi, dz_f, dz_r = ride
    (x_f, x_r), (v_f, v_r) = travel(k, ride), travel(k, (*ride[4:], 0.0, 0.0, 0.0, 0.0))
    unsprung = P.front_unsprung_mass + P.rear_unsprung_mass
    kinetic = k.mass * ((v + k.above * dphi) * (now.speed + k.above * now.pitch) + dz * now.heave)
    kinetic += P.pitch_inertia * dphi * now.pitch + unsprung * v * now.speed
    kinetic += P.front_unsprung_mass * dz_f * now.front_hub + P.rear_unsprung_mass * dz_r * now.rear_hub
    kinetic += P.wheel_inertia / r**2 * (rim_f * now.front_rim + rim_r * now.rear_rim)
    stored = (
        P.front_stiffness * x_f * v_f + P.rear_stiffness * x_r * v_r - k.mass * GRAVITY * k.above * phi * dphi
    )
    stored += P.tire_stiffness * (z_f * dz_f + z_r * dz_r)
    brakes = t_f * (rim_f / r - dphi) + t_r * (rim_r / r - dphi)
    sliding = now.front_force * (v - rim_f) + now.rear_force * (v - rim_r)
    air = 0.5 * P.air_density * P.drag_area * v**2 * (v - r * dphi)
    dampers = P.front_damping * v_f**2 + P.rear_damping * v_r**2 + P.tire_damping * (dz_f**2 + dz_r**2)
    lost = brakes + sliding + air + dampers
    assert kinetic + stored == pytest.approx(
        -lost, abs=1e-9 * max(1.0, abs(lost), abs(brakes) + abs(sliding))
    )


@pytest.mark.parametrize("reaction", [True, False])
def test_the_settled_loads_are_those_of_the_moments(reaction: bool) -> None:
    """m h a, the wheels' angular momentum and the lean, about the point where a tire stands."""
    p = replace(P, wheel_reaction=reaction)
    x, u = after(p, Inputs(300.0, 60.0), 150), Inputs(300.0, 60.0)
    y, z = (DetailedTwoWheeler.outputs(p, s) for s in (x, DetailedTwoWheeler.step(p, x, u, DT)))
    assert y.front_load + y.rear_load == pytest.approx(p.mass * GRAVITY, rel=1e-3)
    wheels = (y.front_wheel_speed + y.rear_wheel_speed - z.front_wheel_speed - z.rear_wheel_speed) / DT
    moment = p.mass * p.center_height * y.deceleration + p.frame.mass * GRAVITY * p.frame.above * y.pitch
    moment += p.wheel_inertia * wheels if reaction else 0.0
    assert p.wheelbase * (y.front_load - p.front_weight) == pytest.approx(moment, rel=5e-3)


def test_it_starts_at_rest_on_its_springs() -> None:
    x = start()
    now = P.motion(x.speed, x.speed, x.speed, 0.0, 0.0, ride_of(x), 0.0, 0.0)
    for rate in (now.heave, now.pitch, now.front_hub, now.rear_hub, now.front_force, now.rear_force):
        assert rate == pytest.approx(0.0, abs=1e-9)
    assert now.speed == pytest.approx(-0.5 * P.air_density * P.drag_area * x.speed**2 / P.mass)


def test_a_tires_slip_follows_over_the_relaxation_length() -> None:
    """(D4): wheels of given slip; after a way of sigma a share of 1 - 1/e, and more for the faster wheel."""
    p = replace(P, wheel_inertia=1e9, road=Road.SNOW, drag_area=0.0)
    x = replace(start(p), front_rim_speed=0.9 * start(p).speed, rear_rim_speed=1.25 * start(p).speed)
    y = DetailedTwoWheeler.step(p, x, Inputs(), p.relaxation_length / x.speed)
    share = 1.0 - math.exp(-1.0)
    assert y.front_tire_slip == pytest.approx(0.1 * share, rel=2e-3)
    assert y.rear_tire_slip == pytest.approx(-0.2 * (1.0 - math.exp(-1.25)), rel=2e-3)


def test_a_locked_wheels_brake_holds_what_the_road_pulls() -> None:
    """Beyond that, more torque changes nothing, neither of the wheel nor of the pitch."""
    x = after(P, Inputs(2000.0, 2000.0), 40)
    assert x.front_rim_speed == x.rear_rim_speed == 0.0
    more = DetailedTwoWheeler.step(P, x, Inputs(9000.0, 9000.0), DT)
    same = DetailedTwoWheeler.step(P, x, Inputs(2000.0, 2000.0), DT)
    assert more.pitch == same.pitch
    free = DetailedTwoWheeler.step(P, x, Inputs(0.0, 2000.0), DT)
    assert free.front_rim_speed > 0.0
    assert free.rear_rim_speed == 0.0


# -- the step ----------------------------------------------------------------------------------------------


def test_halving_the_inner_step_converges() -> None:
    """Below 0.5 ms a step is one inner step: order 2."""
    u = Inputs(350.0, 60.0)
    a, b, c = (after(P, u, 800 * k, 5e-4 / k) for k in (1, 2, 4))
    assert a.front_rim_speed == pytest.approx(b.front_rim_speed, abs=1e-4)
    assert (a.front_rim_speed - b.front_rim_speed) / (b.front_rim_speed - c.front_rim_speed) == pytest.approx(
        4.0, rel=0.1
    )
    assert (a.pitch - b.pitch) / (b.pitch - c.pitch) == pytest.approx(4.0, rel=0.15)


def test_a_long_step_is_many_short_ones() -> None:
    u = Inputs(400.0, 120.0)
    assert astuple(after(P, u, 3)) == pytest.approx(astuple(after(P, u, 60, 5e-4)), abs=1e-12)


@pytest.mark.parametrize(
    "p",
    [
        replace(P, front_stiffness=1e6, rear_stiffness=1e6, tire_stiffness=1e6),
        replace(P, wheel_inertia=0.01),
        replace(P, relaxation_length=1e-3),
        replace(P, road=Road.SNOW, stop_speed=0.1),
        replace(P, front_damping=0.0, rear_damping=0.0, tire_damping=0.0),
    ],
    ids=["stiff", "light wheels", "short relaxation", "snow", "undamped"],
)
def test_stiff_and_odd_vehicles_stay_calm_at_10_ms(p: Parameters) -> None:
    x = start(p)
    for _ in range(60):
        x = DetailedTwoWheeler.step(p, x, Inputs(20.0, 10.0), DT)
        assert violations(x) == []
        y = DetailedTwoWheeler.outputs(p, x)
        assert violations(y) == []
        assert abs(x.pitch) < 0.03
        assert abs(y.front_load + y.rear_load - p.mass * GRAVITY) < 200.0


# -- the end -----------------------------------------------------------------------------------------------


def test_the_stop_ends_with_constant_deceleration_and_the_springs_settle() -> None:
    x = stop(P, Inputs(300.0, 60.0))
    assert x.speed == x.front_rim_speed == x.front_tire_slip == 0.0
    assert x.distance == x.stopping_distance > 0.0
    y = DetailedTwoWheeler.outputs(P, x)
    assert y.deceleration == y.front_force == y.rear_force == 0.0
    assert y.pitch > 0.01  # it still leans forward
    for _ in range(300):
        x = DetailedTwoWheeler.step(P, x, Inputs(300.0, 60.0), DT)
    rest = DetailedTwoWheeler.outputs(P, x)
    assert rest.front_load == pytest.approx(P.front_weight, abs=0.1)
    assert rest.pitch == pytest.approx(0.0, abs=1e-5)
    assert rest.stopping_distance == y.stopping_distance


def test_the_crossing_of_the_stop_speed_does_not_depend_on_the_step() -> None:
    u = Inputs(300.0, 60.0)
    found = [stop(P, u, dt).stopping_distance for dt in (0.02, 0.01, 0.005, 5e-4)]
    assert max(found) - min(found) < 2e-6


# -- odd parameters ----------------------------------------------------------------------------------------


def test_what_cannot_stand_is_refused() -> None:
    with pytest.raises(ValueError, match="leave no sprung mass"):
        start(replace(P, front_unsprung_mass=100.0))
    with pytest.raises(ValueError, match="too soft to keep the vehicle upright"):
        start(replace(P, front_stiffness=100.0))
    with pytest.raises(ValueError, match=r"initial_speed = 3\.0 km/h must be above stop_speed"):
        start(replace(P, initial_speed=3.0))


def test_a_vehicle_that_turns_over_says_so() -> None:
    high, u = replace(P, center_height=1.2), Inputs(900.0, 0.0)
    assert DetailedTwoWheeler.notice(P, start(), after(P, u, 30), u) == ""
    x = after(high, u, 120)
    assert "turns over" in DetailedTwoWheeler.notice(high, x, x, u)
    assert math.isfinite(x.pitch)
