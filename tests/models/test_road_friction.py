"""Burckhardt's friction: the table, its symmetry, its slope, names of roads."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.road_friction import FRICTION, Road, friction_coefficient, friction_slope

roads = st.sampled_from(list(Road))
slips = st.floats(0.0, 1.0)


def test_the_standard_table() -> None:
    assert {road.name: tuple(FRICTION[road]) for road in Road} == {
        "DRY": (1.2801, 23.99, 0.52),
        "WET": (0.857, 33.822, 0.347),
        "COBBLE": (1.3713, 6.4565, 0.6691),
        "SNOW": (0.1946, 94.129, 0.0646),
    }


@given(roads, slips)
def test_odd_in_the_slip(road: Road, slip: float) -> None:
    assert friction_coefficient(road, -slip) == -friction_coefficient(road, slip)
    assert friction_slope(road, -slip) == friction_slope(road, slip)


@given(roads, st.floats(0.001, 0.999))
def test_the_slope_is_the_derivative(road: Road, slip: float) -> None:
    e = 1e-6
    difference = friction_coefficient(road, slip + e) - friction_coefficient(road, slip - e)
    assert friction_slope(road, slip) == pytest.approx(difference / (2.0 * e), rel=1e-5, abs=1e-6)


def test_peaks() -> None:
    """Where the slope is 0: exp(-th_2 lambda) = th_3/(th_1 th_2)."""
    for road, (th_1, th_2, th_3) in FRICTION.items():
        peak = math.log(th_1 * th_2 / th_3) / th_2
        assert friction_slope(road, peak) == pytest.approx(0.0, abs=1e-12)
        assert all(
            friction_coefficient(road, x / 100.0) <= friction_coefficient(road, peak) for x in range(101)
        )
    assert friction_coefficient(Road.DRY, 0.0) == 0.0
