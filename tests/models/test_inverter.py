"""Inverter: the loss of two bridges, its efficiency both ways, the balance of the energies."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.inverter import Inverter, loss

P = Inverter.Parameters()
powers, currents = st.floats(-2e5, 2e5), st.floats(0.0, 600.0)


@given(powers, powers, currents, currents)
def test_the_battery_delivers_what_motors_take_and_bridges_lose(
    left: float, right: float, i_left: float, i_right: float
) -> None:
    u = Inverter.Inputs(left, right, i_left, i_right)
    y = Inverter.outputs(P, Inverter.State(), u)
    assert y.power == pytest.approx(left + right + y.loss)
    assert y.loss >= 2.0 * P.idle_loss
    assert 0.0 <= y.efficiency <= 1.0
    if y.efficiency > 0.0:
        taken, given_ = (y.power, left + right) if left + right > 0.0 else (left + right, y.power)
        assert y.efficiency == pytest.approx(given_ / taken)


def test_the_chosen_loss_is_two_percent_of_the_full_power() -> None:
    u = Inverter.Inputs(114e3, 114e3, 419.0, 419.0)
    assert Inverter.outputs(P, Inverter.State(), u).efficiency == pytest.approx(0.98, abs=0.001)


def test_less_than_its_own_loss_is_no_efficiency() -> None:
    assert Inverter.outputs(P, Inverter.State(), Inverter.Inputs(-50.0, 0.0)).efficiency == 0.0
    assert Inverter.outputs(P, Inverter.State(), Inverter.Inputs(0.0, 0.0)).efficiency == 0.0


def test_each_bridge_loses_by_its_own_current() -> None:
    both, left, none = (
        loss(P, Inverter.Inputs(0.0, 0.0, *i)) for i in ((300.0, 300.0), (300.0, 0.0), (0.0, 0.0))
    )
    assert both - left == pytest.approx(left - none)
    assert left - none == pytest.approx(300.0 * P.current_loss + 300.0**2 * P.resistance)


def test_energies_are_the_sums_of_the_powers() -> None:
    x, u = Inverter.State(), Inverter.Inputs(20e3, -5e3, 100.0, 50.0)
    for _ in range(100):
        x = Inverter.step(P, x, u, 0.01)
    assert x.motor_energy == pytest.approx(15e3 / 3600.0)
    assert x.loss_energy == pytest.approx(loss(P, u) / 3600.0)
