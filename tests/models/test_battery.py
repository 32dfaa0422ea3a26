"""Battery: the current gives the power, charge and energy are conserved, the limits hold."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.battery import Battery

P = Battery.Parameters()
charges = st.floats(0.001, 1.0)
EMPTY_NOTICE = "the battery is empty: it delivers nothing any more"


def ocv(charge: float) -> float:
    """Open-circuit voltage [V]."""
    return P.empty_voltage + P.voltage_rise * charge


@given(charges, st.floats(0.0, 8000.0))
def test_current_times_voltage_is_the_power(charge: float, power: float) -> None:
    y = Battery.outputs(P, Battery.State(charge, 0.0), Battery.Inputs(power))
    assert y.voltage * y.current == pytest.approx(power, rel=1e-9, abs=1e-9)
    assert y.voltage == pytest.approx(ocv(charge) - P.resistance * y.current)


@given(charges, st.floats(0.0, 8000.0))
def test_current_is_the_printed_root(charge: float, power: float) -> None:
    u, r = ocv(charge), P.resistance
    y = Battery.outputs(P, Battery.State(charge, 0.0), Battery.Inputs(power))
    assert y.current == pytest.approx((u - math.sqrt(u * u - 4.0 * r * power)) / (2.0 * r), abs=1e-9)


@given(charges, st.floats(0.0, 1e6))
def test_more_than_the_terminals_carry_is_the_most_they_carry(charge: float, beyond: float) -> None:
    x = Battery.State(charge, 0.0)
    limit = ocv(charge) ** 2 / (4.0 * P.resistance)
    assert Battery.outputs(P, x, Battery.Inputs(limit + beyond)) == Battery.outputs(
        P, x, Battery.Inputs(limit)
    )
    energy = Battery.step(P, x, Battery.Inputs(limit + beyond), 0.01).energy
    assert energy == pytest.approx(limit * 0.01 / 3600.0)


@given(charges, st.floats(-1e6, 1e6))
def test_charge_never_rises_and_never_leaves_its_range(charge: float, power: float) -> None:
    x = Battery.State(charge, 0.0)
    after = Battery.step(P, x, Battery.Inputs(power), 1.0)
    assert 0.0 <= after.state_of_charge <= charge
    if power <= 0.0:
        assert dataclasses.replace(after, step_size=x.step_size) == x


def discharge(x: Battery.State, power: float, seconds: float, steps: int) -> Battery.State:
    """The state after `steps` equal steps of a constant power [W]."""
    for _ in range(steps):
        x = Battery.step(P, x, Battery.Inputs(power), seconds / steps)
    return x


def test_energy_and_losses_come_from_the_charge() -> None:
    """Charge times open-circuit voltage = energy at the terminals + heat of the resistance."""
    x, power, dt = Battery.State(0.9, 0.0), 3000.0, 1.0
    given_up = 0.0
    for _ in range(600):
        i = Battery.outputs(P, x, Battery.Inputs(power)).current
        given_up += ocv(x.state_of_charge) * i * dt / 3600.0
        x = Battery.step(P, x, Battery.Inputs(power), dt)
    assert x.energy == pytest.approx(3000.0 * 600.0 / 3600.0)
    drawn = Battery.outputs(P, x, Battery.Inputs(power)).energy_drawn
    assert drawn == pytest.approx(given_up, rel=1e-12)
    assert drawn > x.energy


def test_halving_the_step_halves_the_error() -> None:
    start = Battery.State(1.0, 0.0)
    exact = discharge(start, 3000.0, 600.0, 6400).state_of_charge
    errors = [discharge(start, 3000.0, 600.0, n).state_of_charge - exact for n in (50, 100, 200)]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.05)
    assert abs(errors[0]) < 2e-4  # at steps of 12 s


def test_an_empty_battery_delivers_nothing() -> None:
    x = discharge(Battery.State(0.01, 0.0), 5000.0, 60.0, 600)
    assert x.state_of_charge == 0.0
    y = Battery.outputs(P, x, Battery.Inputs(5000.0))
    assert (y.current, y.voltage) == (0.0, P.empty_voltage)
    assert Battery.step(P, x, Battery.Inputs(5000.0), 0.1) == x
    assert y.available_power == 0.0


@given(charges, st.floats(0.0, 20000.0), st.sampled_from([0.01, 1.0, 30.0]))
def test_the_cells_give_up_what_is_delivered_and_lost(charge: float, power: float, dt: float) -> None:
    """In each step, also the one in which the charge does not last, however long it is."""
    x = Battery.State(charge)
    for _ in range(40):
        after = Battery.step(P, x, Battery.Inputs(power), dt)
        given_up = ocv(x.state_of_charge) * P.capacity * (x.state_of_charge - after.state_of_charge)
        taken = after.energy + after.loss - x.energy - x.loss
        assert taken == pytest.approx(given_up, rel=1e-9, abs=1e-9 * charge * ocv(1.0) * P.capacity * 1e-3)
        x = after


@given(st.floats(1e-6, 0.01), st.floats(100.0, 20000.0), st.sampled_from([0.01, 0.1, 1.0]))
def test_who_keeps_to_the_available_power_gets_all_that_it_takes(
    charge: float, wanted: float, dt: float
) -> None:
    x, taken = Battery.step(P, Battery.State(charge), Battery.Inputs(0.0), dt), 0.0
    while x.state_of_charge > 0.0:
        power = min(wanted, Battery.outputs(P, x, Battery.Inputs(0.0)).available_power)
        before, x = x, Battery.step(P, x, Battery.Inputs(power), dt)
        taken += power * dt / 3600.0
        assert Battery.notice(P, before, x, Battery.Inputs(power)) in ("", EMPTY_NOTICE)
    assert x.energy == pytest.approx(taken, rel=1e-9)
    assert Battery.notice(P, x, x, Battery.Inputs(0.0)) == EMPTY_NOTICE


def test_more_than_it_can_deliver_is_noticed() -> None:
    x = Battery.State(1.0)
    limit = Battery.outputs(P, x, Battery.Inputs(0.0)).available_power
    assert limit == ocv(1.0) ** 2 / (4.0 * P.resistance)
    beyond = Battery.Inputs(limit * 1.001)
    assert "asked for more power" in Battery.notice(P, x, Battery.step(P, x, beyond, 0.01), beyond)


# -- charging ----------------------------------------------------------------------------------------------

CHARGED = dataclasses.replace(P, charge_limit=3000.0)


@given(charges, st.floats(-3000.0, 8000.0), st.sampled_from([0.01, 1.0, 30.0]))
def test_what_charges_it_comes_back_but_for_the_losses(charge: float, power: float, dt: float) -> None:
    """Charge times open-circuit voltage = energy at the terminals + heat, whichever way the current flows."""
    x, u = Battery.State(charge), Battery.Inputs(power)
    for _ in range(20):
        y, after = Battery.outputs(CHARGED, x, u), Battery.step(CHARGED, x, u, dt)
        given_up = ocv(x.state_of_charge) * P.capacity * (x.state_of_charge - after.state_of_charge)
        taken = after.energy + after.loss - x.energy - x.loss
        assert taken == pytest.approx(given_up, rel=1e-9, abs=1e-9 * ocv(1.0) * P.capacity)
        assert after.loss >= x.loss
        assert y.current * power >= 0.0
        assert 0.0 <= after.state_of_charge <= 1.0
        x = after


def test_a_charged_battery_takes_no_more_than_its_limit() -> None:
    x = Battery.State(0.5)
    most, more = (Battery.outputs(CHARGED, x, Battery.Inputs(power)) for power in (-3000.0, -9000.0))
    assert more == most
    assert most.voltage * most.current == pytest.approx(-3000.0)
    assert most.voltage > ocv(0.5)
    assert Battery.notice(CHARGED, x, x, Battery.Inputs(-2000.0)) == ""
    assert "more power than it takes" in Battery.notice(CHARGED, x, x, Battery.Inputs(-9000.0))


def test_a_full_battery_is_charged_no_more_and_an_empty_one_is() -> None:
    full, u = Battery.State(1.0), Battery.Inputs(-2000.0)
    assert Battery.outputs(CHARGED, full, u).current == 0.0
    assert Battery.step(CHARGED, full, u, 0.0) == full
    brim = Battery.step(CHARGED, Battery.State(1.0 - 1e-5), u, 30.0)
    assert brim.state_of_charge == 1.0
    empty = Battery.step(CHARGED, Battery.State(0.0), u, 1.0)
    assert empty.state_of_charge > 0.0
    assert empty.energy == pytest.approx(-2000.0 / 3600.0)
