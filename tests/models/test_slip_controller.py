"""SlipController: slips, strategies, schedule, limits, anti-windup, freeze, compensation, locked wheels."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.slip_controller import (
    ESTIMATED_SPEED,
    FRONT_COMPENSATED,
    FRONT_ONLY,
    KNOWN_SPEED,
    SlipController,
    Strategy,
    believed_slip,
)

R = 0.25
DT = 0.01
V0 = 100.0 / 3.6
P = SlipController.Parameters()
Inputs, State = SlipController.Inputs, SlipController.State


def inputs(v: float, front_slip: float, rear_slip: float = 0.0, estimate: float = 0.0) -> Inputs:
    """What is measured at a speed and slips."""
    return Inputs(v * (1.0 - front_slip) / R, v * (1.0 - rear_slip) / R, v, estimate)


def samples(p: SlipController.Parameters, *given_inputs: Inputs) -> list[State]:
    x = SlipController.initial(p, Inputs())
    found = []
    for u in given_inputs:
        x = SlipController.step(p, x, u, DT)
        found.append(x)
    return found


def test_slip_of_no_speed_is_none() -> None:
    """0/0, at standstill or with both wheels locked: no division, and no brake that is released."""
    assert believed_slip(0.0, 0.0) == 0.0
    assert believed_slip(0.0, 3.0) == 0.0
    assert believed_slip(10.0, 0.0) == 1.0
    assert believed_slip(10.0, 7.8) == pytest.approx(0.22)
    assert believed_slip(10.0, 11.0) == pytest.approx(-0.1)  # a wheel faster than the belief


def test_the_control_law() -> None:
    """u[k] = K_p e[k] + K_i T_s (e[0] + ... + e[k-1]) at v_0."""
    x = samples(P, inputs(V0, 0.1, 0.2), inputs(V0, 0.15, 0.25))
    assert x[0].front_torque == pytest.approx(3000.0 * 0.12)
    assert x[0].rear_torque == pytest.approx(3000.0 * 0.02)
    assert x[1].front_torque == pytest.approx(3000.0 * 0.07 + 25000.0 * 0.12 * DT)
    assert x[1].rear_torque == 0.0  # -85 N.m asked, clipped


@pytest.mark.parametrize(
    ("v", "share"), [(V0, 1.0), (1.5 * V0, 1.0), (0.5 * V0, 0.5), (0.08 * V0, 0.09), (2.0, 0.09)]
)
def test_the_schedule(v: float, share: float) -> None:
    x = samples(P, inputs(v, 0.12), inputs(v, 0.22))
    assert x[0].front_torque == pytest.approx(3000.0 * share * 0.1)
    assert x[1].front_torque == pytest.approx(25000.0 * share * 0.1 * DT, rel=1e-9)


def test_a_proportional_controller_is_a_choice_of_parameters() -> None:
    p = SlipController.Parameters(proportional_gain=340.0, integral_gain=0.0, schedule_minimum=1.0)
    x = samples(p, *[inputs(3.0, 0.02)] * 20)
    assert {s.front_torque for s in x} == {x[0].front_torque}
    assert x[0].front_torque == pytest.approx(340.0 * 0.2)


def test_the_derivative_brakes_the_approach() -> None:
    p = SlipController.Parameters(derivative_gain=10.0, integral_gain=0.0)
    x = samples(p, inputs(V0, 0.1), inputs(V0, 0.12))
    assert x[0].front_torque == pytest.approx(3000.0 * 0.12)  # no difference yet
    assert x[1].front_torque == pytest.approx(3000.0 * 0.10 - 10.0 * 0.02 / DT)


@given(st.lists(st.tuples(st.floats(0.0, 60.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), max_size=30))
def test_torques_stay_in_their_limits(walk: list[tuple[float, float, float]]) -> None:
    for s in samples(P, *(inputs(*point) for point in walk)):
        assert 0.0 <= s.front_torque <= 2000.0
        assert 0.0 <= s.rear_torque <= 2000.0


def test_a_limited_torque_does_not_wind_up() -> None:
    p = SlipController.Parameters(maximum_torque=300.0)
    x = samples(p, *[inputs(V0, 0.0)] * 100)
    assert x[-1].front_torque == 300.0
    assert x[-1].front_integral == 0.0  # 3000 * 0.22 is beyond the limit by itself
    back = samples(p, *[inputs(V0, 0.0)] * 100, inputs(V0, 0.23))[-1]
    assert back.front_torque == 0.0  # at once
    released = samples(P, *[inputs(V0, 0.9)] * 100, inputs(V0, 0.12))[-1]
    assert released.front_torque == pytest.approx(300.0)


@pytest.mark.parametrize("strategy", list(Strategy))
def test_frozen_below_two_meters_a_second(strategy: Strategy) -> None:
    p = SlipController.Parameters(strategy=strategy)
    fast, slow = inputs(10.0, 0.1, 0.2, estimate=9.0), inputs(1.99, 0.9, 0.9, estimate=1.99)
    x = samples(p, fast, fast, slow, slow)
    for name in ("front_torque", "rear_torque", "front_integral", "rear_integral"):
        assert getattr(x[1], name) == getattr(x[2], name) == getattr(x[3], name)
    assert x[3].front_slip == pytest.approx(0.9)  # what it believes, it still says


def test_only_the_first_strategy_knows_the_speed() -> None:
    for strategy in Strategy:
        p = SlipController.Parameters(strategy=strategy)
        (x,) = samples(p, inputs(20.0, 0.1, 0.1, estimate=18.0))
        assert x.speed == (20.0 if strategy == KNOWN_SPEED else 18.0)
        assert x.front_slip == pytest.approx(0.1 if strategy == KNOWN_SPEED else 0.0)


def test_front_only_leaves_the_rear_wheel_alone() -> None:
    for p in (SlipController.Parameters(strategy=s) for s in (FRONT_ONLY, FRONT_COMPENSATED)):
        x = samples(p, *[inputs(20.0, 0.1, 0.0, estimate=20.0)] * 5)
        assert all(s.rear_torque == 0.0 for s in x)
        assert x[-1].front_torque > 300.0


def test_the_compensation_is_the_torque_that_slows_the_wheel() -> None:
    """T_r = -J w_r': with it the road need not slow the wheel, so the wheel has no slip."""
    p = SlipController.Parameters(strategy=FRONT_COMPENSATED)
    x = samples(p, *(Inputs(70.0, 80.0 - 0.3 * k, 0.0, 20.0) for k in range(5)))
    assert x[0].rear_torque == 0.0  # no difference yet
    assert x[-1].rear_torque == pytest.approx(0.79 * 30.0)
    speeding_up = samples(p, *(Inputs(70.0, 80.0 + k, 0.0, 20.0) for k in range(5)))
    assert speeding_up[-1].rear_torque == 0.0


def test_locked_wheels_stay_braked() -> None:
    """(b): the estimate falls to 0 with the wheels, and no guard turns 0/0 into a slip of 1."""
    p = SlipController.Parameters(strategy=ESTIMATED_SPEED)
    rolling, locked = Inputs(80.0, 80.0, 25.0, 20.0), Inputs(0.0, 0.0, 20.0, 0.0)
    x = samples(p, *[rolling] * 10, *[locked] * 50)
    assert x[-1].front_slip == x[-1].rear_slip == x[-1].speed == 0.0
    assert x[-1].front_torque == x[9].front_torque > 600.0
    unfrozen = SlipController.Parameters(strategy=ESTIMATED_SPEED, freeze_speed=0.0)
    assert samples(unfrozen, *[rolling] * 10, *[locked] * 2000)[-1].front_torque == 2000.0


def test_no_output_is_ever_undefined() -> None:
    for strategy in Strategy:
        p = SlipController.Parameters(strategy=strategy)
        (x,) = samples(p, Inputs(0.0, 0.0, 0.0, 0.0))
        assert all(math.isfinite(value) for value in dataclasses.astuple(x))
