"""BoundController: the observer against its equation, the switching law, anti-windup, odd inputs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from itertools import pairwise

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from evcosim.models.base import violations
from evcosim.models.bound_controller import BoundController, ControllerState, SpeedSource, ThrottleSource

DT = 0.01
P = BoundController.Parameters()
DRIVER, ACCELERATION, VELOCITY = ControllerState
OFF = dataclasses.replace(P, enabled=False)

Inputs = BoundController.Inputs
State = BoundController.State


def sample(
    x: State, inputs: Iterable[BoundController.Inputs], p: BoundController.Parameters = P
) -> list[State]:
    """The states after each sample."""
    states = []
    for u in inputs:
        x = BoundController.step(p, x, u, DT)
        states.append(x)
    return states


# -- observer ----------------------------------------------------------------------------------------------


def observer_by_small_steps(
    p: BoundController.Parameters, v_e: float, eta: float, v_m: float, g_e: float, seconds: float
) -> tuple[float, float]:
    """(5) by the classical Runge-Kutta rule, straight from the equation."""
    t, mu = p.time_constant, p.gain
    g1, g2 = p.observer_gain, p.observer_bandwidth**2

    def slope(a: float, b: float) -> tuple[float, float]:
        return -a / t + mu / t * g_e + g1 * (v_m - a) + g2 * b, v_m - a

    n = 50
    h = seconds / n
    for _ in range(n):
        a1, b1 = slope(v_e, eta)
        a2, b2 = slope(v_e + h / 2 * a1, eta + h / 2 * b1)
        a3, b3 = slope(v_e + h / 2 * a2, eta + h / 2 * b2)
        a4, b4 = slope(v_e + h * a3, eta + h * b3)
        v_e += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        eta += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
    return v_e, eta


@pytest.mark.parametrize("damping", [0.3, 0.999999, 1.0, 1.000001, 2.5])
@pytest.mark.parametrize("dt", [0.01, 0.5])
def test_the_observer_solves_its_equation(damping: float, dt: float) -> None:
    p = dataclasses.replace(OFF, observer_damping=damping)
    x = dataclasses.replace(State(), observer_speed=20.0, observer_offset=3.0)
    after = BoundController.step(p, x, Inputs(60.0, 25.0), dt)
    expected = observer_by_small_steps(p, 20.0, 3.0, 25.0, 60.0, dt)
    assert (after.observer_speed, after.observer_offset) == pytest.approx(expected, rel=1e-8)


@given(st.floats(0.0, 50.0), st.floats(0.0, 100.0))
def test_it_starts_in_equilibrium(speed: float, throttle: float) -> None:
    u = Inputs(throttle, speed, 100.0, 10.0)
    for x in sample(BoundController.initial(P, u), [u] * 20):
        assert x.speed_estimate == pytest.approx(speed, abs=1e-9)
        assert x.acceleration_estimate == pytest.approx(0.0, abs=1e-7)
        assert (x.state, x.throttle) == (DRIVER, throttle)


@settings(max_examples=20)
@given(st.floats(24.0, 49.0), st.floats(0.0, 100.0), st.floats(0.0, 60.0))
def test_a_constant_speed_is_found_whatever_the_throttle(speed: float, throttle: float, start: float) -> None:
    """(6)-(7): within the 0.5 km/h of the rounding after 60 s."""
    measured = float(math.floor(speed + 0.5))
    x = BoundController.initial(OFF, Inputs(0.0, start))
    x = sample(x, [Inputs(throttle, measured)] * 6000, OFF)[-1]
    assert abs(x.speed_estimate - speed) <= 0.5 + 1e-9


@pytest.mark.parametrize("use_observer", [True, False])
def test_a_ramp_gives_its_acceleration(use_observer: bool) -> None:
    p = dataclasses.replace(OFF, use_observer=use_observer)
    slope = 1.5
    x = sample(State(), [Inputs(0.0, 3.6 * slope * k * DT) for k in range(3000)], p)[-1]
    assert x.acceleration_estimate == pytest.approx(slope, rel=0.01)


def test_without_observer_the_measurement_is_the_speed() -> None:
    p = dataclasses.replace(P, use_observer=False)
    measured = [float(k // 30) for k in range(600)]
    states = sample(State(), [Inputs(0.0, v) for v in measured], p)
    assert [x.speed_estimate for x in states] == measured


# -- supervisor and law ------------------------------------------------------------------------------------


def rising(throttle: float, slope: float, seconds: float, start: float = 0.0) -> list[BoundController.Inputs]:
    """A measured speed that rises with `slope` [m/s2]."""
    return [Inputs(throttle, start + 3.6 * slope * k * DT) for k in range(round(seconds / DT))]


def test_below_both_bounds_the_rider_drives() -> None:
    for x in sample(State(), rising(40.0, 0.5, 10.0)):
        assert (x.state, x.throttle) == (DRIVER, 40.0)
        assert x.reference == x.speed_estimate


def test_too_much_acceleration_enters_acceleration_and_the_bound_enters_velocity() -> None:
    states = [x.state for x in sample(State(), rising(100.0, 1.5, 9.0))]
    assert list(dict.fromkeys(states)) == [DRIVER, ACCELERATION, VELOCITY]


def test_the_reference_rises_with_the_bound() -> None:
    """(8), with its factor 3.6: from the estimate at the entry."""
    states = [x for x in sample(State(), rising(100.0, 1.5, 4.0)) if x.state == ACCELERATION]
    assert states[0].reference == states[0].speed_estimate == states[0].entry_reference
    for k, x in enumerate(states):
        assert x.reference == pytest.approx(states[0].reference + 3.6 * 1.0 * k * DT)


def test_a_released_throttle_gives_the_vehicle_back() -> None:
    entered = sample(State(), rising(100.0, 1.5, 9.0))[-1]
    assert entered.state == VELOCITY
    released = BoundController.step(P, entered, Inputs(0.0, 40.0), DT)
    assert released.throttle == 0.0
    slow = sample(entered, [Inputs(0.0, 20.0)] * 500)[-1]
    assert slow.state == DRIVER


@given(st.floats(0.0, 100.0), st.floats(0.0, 60.0), st.floats(0.0, 3.0))
def test_the_applied_throttle_is_never_above_the_request_for_long(
    throttle: float, speed: float, slope: float
) -> None:
    """The bounds take, they do not give: a candidate above the request hands over to the rider at once."""
    states = sample(State(), rising(throttle, slope, 3.0, speed))
    assert all(x.throttle <= throttle + 1e-6 for x in states[1:])


@given(
    st.lists(
        st.builds(Inputs, st.floats(-50, 200), st.floats(-20, 300), st.floats(-10, 100), st.floats(-1, 5)),
        max_size=80,
    ),
    st.booleans(),
)
def test_any_inputs_keep_the_throttle_in_range(
    inputs: list[BoundController.Inputs], use_observer: bool
) -> None:
    p = dataclasses.replace(P, use_observer=use_observer)
    for x in sample(State(), inputs, p):
        assert violations(BoundController.outputs(p, x)) == []
        assert all(math.isfinite(getattr(x, f.name)) for f in dataclasses.fields(x))


def test_a_request_out_of_range_is_its_nearest_end() -> None:
    for request, end in ((150.0, 100.0), (-20.0, 0.0)):
        a = sample(State(), rising(request, 1.5, 3.0))
        assert a == sample(State(), rising(end, 1.5, 3.0))


@given(st.floats(0.0, 100.0), st.floats(0.0, 60.0))
def test_disabled_it_applies_the_request_and_keeps_observing(throttle: float, speed: float) -> None:
    off = sample(State(), [Inputs(throttle, speed)] * 200, OFF)
    assert {(x.state, x.throttle) for x in off} == {(DRIVER, throttle)}
    free = sample(State(), [Inputs(throttle, speed, 1e9, 1e9)] * 200)
    assert [x.speed_estimate for x in off] == [x.speed_estimate for x in free]


# -- anti-windup and bumpless entry ------------------------------------------------------------------------


@pytest.mark.parametrize("tracking_time", [0.005, 0.01, 0.015, 0.02])
def test_idle_integrals_follow_the_rider(tracking_time: float) -> None:
    p = dataclasses.replace(P, tracking_time=tracking_time)
    x = sample(State(), [Inputs(63.0, 10.0, 1e3, 1e3)] * 200, p)[-1]
    assert (x.speed_integral, x.acceleration_integral) == pytest.approx((63.0, 63.0))


@pytest.mark.parametrize("tracking_time", [0.01, 0.02])
def test_a_constant_throttle_approached_from_above_lets_the_bounds_act(tracking_time: float) -> None:
    """An integral that nears the request from above must not keep the candidate above it for ever."""
    p = dataclasses.replace(P, tracking_time=tracking_time)
    down = sample(State(), [Inputs(100.0 - 0.1 * k, 20.0) for k in range(300)], p)[-1]
    states = sample(down, rising(70.0, 1.5, 5.0, 20.0), p)
    assert {ACCELERATION, VELOCITY} & {x.state for x in states}


def test_entry_into_acceleration_takes_over_the_throttle() -> None:
    states = sample(State(), rising(80.0, 1.5, 3.0))
    k = next(k for k, x in enumerate(states) if x.state == ACCELERATION)
    assert states[k].throttle == pytest.approx(states[k - 1].throttle, abs=1e-9)


def test_no_windup_at_the_ends() -> None:
    """A minute far above the bound closes the throttle; it opens again before the bound is reached."""
    entered = sample(State(), rising(100.0, 1.5, 9.0))[-1]
    x = sample(entered, [Inputs(100.0, 60.0)] * 6000)[-1]
    assert (x.state, x.throttle) == (VELOCITY, 0.0)
    assert x.speed_integral + P.speed_gain * (30.0 - x.speed_estimate) > -5.0
    opened = sample(x, [Inputs(100.0, 60.0 - 0.03 * k) for k in range(1000)])
    first = next(y for y in opened if y.throttle > 0.0)
    assert first.speed_estimate > 30.0


def test_the_dwell_time_keeps_the_driver() -> None:
    p = dataclasses.replace(P, dwell_time=0.5)
    bound = [Inputs(100.0, 40.0)] * 100
    released = [Inputs(0.0, 20.0)] * 300
    x = sample(State(), rising(100.0, 1.5, 9.0), p)[-1]
    assert x.state == VELOCITY
    states = sample(x, [*released, *bound, *released], p)
    changes = [k for k in range(1, len(states)) if states[k].state != states[k - 1].state]
    stays = [b - a for a, b in pairwise(changes) if states[a].state == DRIVER]
    assert stays
    assert all(stay >= 50 for stay in stays)
    assert BoundController.initial(p, Inputs()).dwell_left == 0.0


@pytest.mark.parametrize("samples", [1, 7, 10, 14, 50, 110])
def test_the_dwell_time_is_counted_to_the_sample(samples: int) -> None:
    p = dataclasses.replace(P, dwell_time=samples * DT)
    over = Inputs(100.0, 40.0)
    settled = dataclasses.replace(
        BoundController.initial(p, over), state=VELOCITY, speed_integral=1e6, entry_reference=30.0
    )
    left = BoundController.step(p, settled, over, DT)  # the candidate is above the request
    assert left.state == DRIVER
    states = [x.state for x in sample(left, [over] * (samples + 5), p)]
    assert states.index(VELOCITY) == samples


def test_a_moving_speed_bound_is_fed_forward() -> None:
    """(C1): a step of the bound moves the throttle by K_p and by the vehicle's own gain."""
    at_bound = BoundController.initial(P, Inputs(50.0, 30.0))
    x = dataclasses.replace(at_bound, state=VELOCITY, entry_reference=30.0)
    held = BoundController.step(P, x, Inputs(100.0, 30.0, 30.0), DT).throttle
    moved = BoundController.step(P, x, Inputs(100.0, 30.0, 30.2), DT).throttle
    assert 0.0 < held < moved < 100.0
    assert moved - held == pytest.approx((P.speed_gain + 1.0 / P.gain) * 0.2)


def test_the_last_bit_of_an_integral_does_not_keep_the_driver() -> None:
    above = math.nextafter(70.0, 100.0)
    x = dataclasses.replace(
        State(), observer_speed=31.0, speed_estimate=31.0, speed_integral=above, acceleration_integral=above
    )
    assert BoundController.step(P, x, Inputs(70.0, 31.0), DT).state == VELOCITY


# -- where speed and throttle come from ----------------------------------------------------------------------

WHEELS = dataclasses.replace(P, speed_source=SpeedSource.WHEELS, throttle_source=ThrottleSource.BUS)


@given(st.floats(0.0, 70.0), st.floats(0.1, 0.4), st.floats(0.1, 0.4), st.floats(0.0, 100.0))
def test_wheels_and_bus_give_what_drive_and_wire_give(v: float, r_f: float, r_r: float, g: float) -> None:
    """Rolling wheels of any radii at v, formed and rounded here, against v rounded by the drive."""
    p = dataclasses.replace(WHEELS, front_wheel_radius=r_f, rear_wheel_radius=r_r)
    w_f, w_r = v / 3.6 / r_f, v / 3.6 / r_r
    formed = Inputs(77.0, 99.0, throttle_position=g, front_wheel_speed=w_f, rear_wheel_speed=w_r)
    given = Inputs(g, math.floor(v + 0.5))
    assume(abs(v % 1.0 - 0.5) > 1e-9)
    x, y = BoundController.initial(p, formed), BoundController.initial(P, given)
    assert x == y
    assert sample(x, [formed] * 3, p) == sample(y, [given] * 3)


def test_the_speed_of_the_wheels_is_their_mean_and_may_be_left_as_it_is() -> None:
    fine = dataclasses.replace(WHEELS, speed_resolution=0.0, rear_wheel_radius=0.3)
    u = Inputs(front_wheel_speed=40.0, rear_wheel_speed=30.0)
    assert BoundController.initial(fine, u).speed_estimate == pytest.approx(3.6 * (8.0 + 9.0) / 2.0)
    half = dataclasses.replace(fine, speed_resolution=0.5)
    assert BoundController.initial(half, u).speed_estimate == 30.5


def test_by_default_the_wheels_and_the_bus_are_not_heard() -> None:
    quiet, loud = (
        Inputs(20.0, 30.0),
        Inputs(20.0, 30.0, throttle_position=80.0, front_wheel_speed=10.0, rear_wheel_speed=99.0),
    )
    x = BoundController.initial(P, quiet)
    assert BoundController.initial(P, loud) == x
    assert sample(x, [loud]) == sample(x, [quiet])
