"""InductionMotorDrive: the printed motor, exact inner steps, bandwidth, energy, limits, machine and ideal."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from evcosim.models import induction_motor_drive
from evcosim.models.base import violations
from evcosim.models.induction_motor_drive import InductionMotorDrive, Machine

Parameters, Inputs, State = (
    InductionMotorDrive.Parameters,
    InductionMotorDrive.Inputs,
    InductionMotorDrive.State,
)
P = Parameters()
IDEAL = Parameters(ideal=True)
DRIVING = 10.0 * 0.93
CRUISE = 60.0 / 3.6 / 0.36  # rad/s
wheel_speeds = st.floats(-90.0, 90.0)
requests = st.floats(-4000.0, 4000.0)


def run(
    p: InductionMotorDrive.Parameters,
    request: float,
    speed: float,
    steps: int,
    dt: float = 0.01,
    x: InductionMotorDrive.State | None = None,
) -> InductionMotorDrive.State:
    """The state after steps of constant inputs, from a magnetized motor without torque."""
    if x is None:
        x = InductionMotorDrive.initial(p, Inputs(0.0, speed))
    for _ in range(steps):
        x = InductionMotorDrive.step(p, x, Inputs(request, speed), dt)
    return x


# -- the printed motor -------------------------------------------------------------------------------------


def test_the_printed_torque_needs_419_amperes_in_each_axis() -> None:
    k = Machine(P)
    flux = 482e-6 * 419.0
    assert 247.0 / (k.torque_factor * flux) == pytest.approx(419.0, abs=0.5)
    assert run(P, 2297.1, 10.0, 20).current_q == pytest.approx(419.0, abs=0.5)


def test_the_machines_time_constants() -> None:
    k = Machine(P)
    assert 1.0 / k.rotor_rate == pytest.approx(0.165, abs=5e-4)
    assert k.leakage / (0.0044 + 0.003) == pytest.approx(3.9e-3, abs=5e-5)


def test_the_voltage_is_enough_up_to_120_kmh() -> None:
    speed = 120.0 / 3.6 / 0.36
    assert run(P, 2297.1, speed, 20).voltage < 400.0
    assert run(P, 2297.1, speed, 20).torque == pytest.approx(2297.1, rel=1e-3)


# -- the inner step ----------------------------------------------------------------------------------------


@given(st.floats(-3000.0, 3000.0), st.floats(1e-6, 2e-3))
@settings(max_examples=40)
def test_the_inner_step_is_the_exact_solution(w: float, h: float) -> None:
    """Against the matrix exponential of (M1)-(M2) with the voltage as a third, constant state."""
    k = Machine(P)
    a = np.zeros((3, 3), dtype=complex)
    a[0] = [-k.resistance / k.leakage - 1j * w, k.ratio * (k.rotor_rate - 1j * w) / k.leakage, 1 / k.leakage]
    a[1] = [k.coupling, -k.rotor_rate, 0.0]
    exact = expm(a * h)[:2]
    m_11, m_12, m_21, m_22, g_1, g_2 = k.advance(w, h)
    ours = np.array([[m_11, m_12, g_1], [m_21, m_22, g_2]])
    assert np.abs(ours - exact).max(axis=0) == pytest.approx(0.0, abs=1e-8 * np.abs(exact).max())


@pytest.mark.parametrize("speed", [0.0, CRUISE, -CRUISE, 90.0])
def test_halving_the_communication_step_changes_nothing_but_the_rounding(speed: float) -> None:
    a, b = run(P, 1500.0, speed, 5), run(P, 1500.0, speed, 10, 0.005)
    for name in ("current_d", "current_q", "flux", "motor_torque", "integral_q"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-9)


# -- bandwidth ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tau", [0.001, 0.003, 0.006])
@pytest.mark.parametrize("speed", [0.0, CRUISE, 90.0])
def test_the_torque_follows_with_the_time_constant(tau: float, speed: float) -> None:
    """Within 2 % of the step: sampling the current at h = 0.1 ms explains h/(2 tau e), 1.8 % at 1 ms."""
    p = dataclasses.replace(P, time_constant=tau)
    x = InductionMotorDrive.initial(p, Inputs(0.0, speed))
    for k in range(1, 201):
        x = InductionMotorDrive.step(p, x, Inputs(2000.0, speed), 1e-4)
        lag = 2000.0 / DRIVING * (1.0 - math.exp(-k * 1e-4 / tau))
        assert x.motor_torque == pytest.approx(lag, abs=0.02 * 2000.0 / DRIVING)


@given(requests, wheel_speeds)
@settings(max_examples=30)
def test_machine_and_ideal_rest_in_the_same_state(request: float, speed: float) -> None:
    a, b = run(P, request, speed, 60), run(IDEAL, request, speed, 60)
    assert a.torque == pytest.approx(b.torque, abs=2.0)
    assert a.motor_torque == pytest.approx(b.motor_torque, abs=0.2)
    assert a.current_d == pytest.approx(419.0, abs=0.5)
    assert a.current_q == pytest.approx(b.current_q, abs=0.5)
    assert a.flux == pytest.approx(b.flux, rel=1e-3)
    assert a.voltage == pytest.approx(b.voltage, abs=0.5)
    assert a.power == pytest.approx(b.power, rel=2e-3, abs=30.0)


@given(requests, wheel_speeds)
def test_a_start_with_a_torque_stays_there(request: float, speed: float) -> None:
    for p in (P, IDEAL):
        x = InductionMotorDrive.initial(p, Inputs(request, speed))
        after = InductionMotorDrive.step(p, x, Inputs(request, speed), 0.01)
        # the start is the equilibrium of continuous time, 0.1 % of the range beside the sampled one
        assert after.motor_torque == pytest.approx(x.motor_torque, abs=0.25)
        assert after.current_q == pytest.approx(x.current_q, abs=0.5)


@given(requests, requests, wheel_speeds)
def test_the_ideal_lag_is_exact_at_any_step(first: float, then: float, speed: float) -> None:
    x = InductionMotorDrive.initial(IDEAL, Inputs(first, speed))
    one = run(IDEAL, then, speed, 1, 0.01, x)
    ten = run(IDEAL, then, speed, 10, 0.001, x)
    assert one.motor_torque == pytest.approx(ten.motor_torque, abs=1e-9)


# -- energy ------------------------------------------------------------------------------------------------


@given(requests, wheel_speeds)
@settings(max_examples=30)
def test_power_at_rest_is_the_shafts_and_what_the_resistances_take(request: float, speed: float) -> None:
    x = run(P, request, speed, 60)
    shaft = x.motor_torque * speed * 10.0
    stator = 1.5 * 0.0044 * (x.current_d**2 + x.current_q**2)
    rotor = 1.5 * 0.003 * (482e-6 / (482e-6 + 12.9e-6) * x.current_q) ** 2  # slip times the torque
    assert x.power == pytest.approx(shaft + stator + rotor, rel=1e-3, abs=10.0)


@given(requests, wheel_speeds)
def test_the_gear_takes_its_share_whichever_way_power_flows(request: float, speed: float) -> None:
    assume(min(abs(request), abs(speed)) > 1e-6)  # a power of subnormal size has no digits to compare
    x = run(IDEAL, request, speed, 20)
    at_wheel, at_shaft = x.torque * speed, x.motor_torque * speed * 10.0
    assert at_wheel <= at_shaft + 1e-9 * abs(at_shaft)
    assert min(abs(at_wheel), abs(at_shaft)) == pytest.approx(0.93 * max(abs(at_wheel), abs(at_shaft)))


# -- limits ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("request_", "torque"), [(1e4, 2297.1), (-1e4, -247.0 * 10.0 / 0.93)])
@pytest.mark.parametrize("p", [P, IDEAL], ids=["machine", "ideal"])
def test_the_motor_keeps_its_torque(
    p: InductionMotorDrive.Parameters, request_: float, torque: float
) -> None:
    x = run(p, request_, CRUISE, 60)
    assert abs(x.motor_torque) == pytest.approx(247.0, abs=0.1)
    assert x.torque == pytest.approx(torque, abs=1.5)


def test_the_current_limits_the_torque_of_both_forms_alike() -> None:
    limits = {"current_limit": 450.0}
    machine, ideal = (dataclasses.replace(p, **limits) for p in (P, IDEAL))
    a, b = run(machine, 2000.0, CRUISE, 60), run(ideal, 2000.0, CRUISE, 60)
    assert a.motor_torque == pytest.approx(b.motor_torque, abs=0.1)
    assert math.hypot(b.current_d, b.current_q) == pytest.approx(450.0)
    assert b.motor_torque < 120.0


def test_a_voltage_that_is_not_enough_is_kept_and_left_without_windup() -> None:
    p = dataclasses.replace(P, voltage_limit=150.0)
    pressed = run(p, 2000.0, CRUISE, 100)
    assert pressed.voltage == 150.0
    assert violations(pressed) == []
    slow = run(p, 2000.0, 0.5 * CRUISE, 60, x=pressed)
    assert slow.torque == pytest.approx(2000.0, rel=0.02)


@given(st.floats(-1e6, 1e6), st.floats(-400.0, 400.0), st.floats(1e-3, 0.1))
@settings(max_examples=30)
def test_whatever_is_asked_it_stays_finite(request: float, speed: float, dt: float) -> None:
    x = run(P, request, speed, 10, dt)
    assert violations(x) == []
    assert x.voltage <= 400.0


def test_friction_is_overcome_and_shows_in_the_current() -> None:
    rough = dataclasses.replace(P, friction=0.0014)
    a, b = run(P, 1000.0, CRUISE, 60), run(rough, 1000.0, CRUISE, 60)
    assert a.torque == pytest.approx(b.torque, abs=0.5)
    extra = 0.0014 * CRUISE * 10.0 / (Machine(P).torque_factor * 482e-6 * 419.0)
    assert b.current_q - a.current_q == pytest.approx(extra, rel=0.01)


def test_limits_that_leave_no_torque_are_refused() -> None:
    with pytest.raises(ValueError, match=r"current_limit = 400.0 A leaves no current .* = 419.0 A"):
        InductionMotorDrive.initial(dataclasses.replace(P, current_limit=400.0), Inputs())


class Pure(complex):
    """A complex number that calculates with complex numbers only."""


def _pure(name: str) -> Any:
    def calculate(self: complex, other: complex) -> Pure:
        assert isinstance(other, complex), f"a complex number meets {other!r} in {name}"
        return Pure(getattr(complex(self), name)(complex(other)))

    return calculate


for _name in ("add", "sub", "mul", "truediv"):
    setattr(Pure, f"__{_name}__", _pure(f"__{_name}__"))
    setattr(Pure, f"__r{_name}__", _pure(f"__r{_name}__"))
Pure.conjugate = lambda self: Pure(complex(self).conjugate())  # type: ignore[method-assign] # the same in Pure


@pytest.mark.parametrize("request_at_wheel", [1500.0, 30000.0])
def test_complex_numbers_meet_complex_numbers_only(
    request_at_wheel: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The product of a complex number and a float has another rule since Python 3.14: the sign of a zero."""
    expected = run(dataclasses.replace(P, voltage_limit=150.0), request_at_wheel, CRUISE, 3)
    monkeypatch.setattr(induction_motor_drive, "complex", Pure, raising=False)
    for name in ("ONE", "HALF", "QUARTER"):
        monkeypatch.setattr(induction_motor_drive, name, Pure(getattr(induction_motor_drive, name)))
    for name in ("complex_exp", "complex_sqrt", "cosh", "sinh"):
        plain = getattr(induction_motor_drive, name)
        monkeypatch.setattr(induction_motor_drive, name, lambda z, plain=plain: Pure(plain(z)))
    x = run(dataclasses.replace(P, voltage_limit=150.0), request_at_wheel, CRUISE, 3)
    assert dataclasses.astuple(x) == dataclasses.astuple(expected)
