"""Tire relaxation: a step is as good as many, and its edges."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.tire_relaxation import relaxation, relaxed

slips = st.floats(-1.0, 1.0)


@given(
    st.floats(0.01, 1.0),
    st.floats(1e-4, 0.05),
    st.floats(0.0, 60.0),
    slips,
    slips,
    slips,
    st.floats(0.05, 0.95),
)
def test_two_parts_of_a_step_are_the_step(
    sigma: float, h: float, fastest: float, s: float, before: float, after: float, share: float
) -> None:
    between = before + share * (after - before)
    half = relaxed(relaxation(sigma, share * h, fastest), s, before, between)
    parts = relaxed(relaxation(sigma, (1.0 - share) * h, fastest), half, between, after)
    assert parts == pytest.approx(relaxed(relaxation(sigma, h, fastest), s, before, after), abs=1e-7)


@given(slips, slips, slips)
def test_without_a_length_the_slip_is_the_wheels(s: float, before: float, after: float) -> None:
    assert relaxed(relaxation(0.0, 1e-3, 20.0), s, before, after) == after


@given(slips, slips)
def test_at_a_standstill_it_stays(s: float, slip: float) -> None:
    assert relaxed(relaxation(0.15, 1e-3, 0.0), s, slip, slip) == pytest.approx(s)
