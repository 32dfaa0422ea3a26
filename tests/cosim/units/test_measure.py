"""The records of units of measure: the affine map and what a unit says of itself."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.units.measure import Affine, UnitOfMeasure

numbers = st.floats(-1e6, 1e6)
maps = st.builds(Affine, st.floats(0.01, 100), numbers)


@given(numbers, maps)
def test_expression_is_the_map(x, affine):
    assert eval(affine.expression("x"), {"x": x}) == affine(x)


@given(numbers, maps)
def test_there_and_back(x, affine):
    far = 1e-6 * (1 + abs(affine.offset)) / affine.scale
    assert affine.inverse()(affine(x)) == pytest.approx(x, rel=1e-9, abs=far)


@given(numbers, maps, maps)
def test_one_map_after_another(x, first, after):
    assert first.then(after)(x) == pytest.approx(after(first(x)), rel=1e-9, abs=1e-6)
    assert first.then(Affine()) is first and Affine().then(after) is after


def test_the_identity_maps_every_value_to_itself():
    assert Affine().identity and Affine()(7.5) == 7.5
    assert Affine().expression("x") == "x"
    assert not Affine(2.0).identity and not Affine(1.0, 1.0).identity


def test_a_unit_shows_its_dimension():
    watt = UnitOfMeasure("W", (1, 2, -3, 0, 0, 0, 0, 0))
    assert watt.dimension == "kg.m2.s-3" and not watt.bare
    assert UnitOfMeasure("x", (0, Fraction(1, 2), 0, 0, 0, 0, 0, 0)).dimension == "m1/2"
    none = (0,) * 8
    assert UnitOfMeasure("1", none).bare and UnitOfMeasure("1", none).dimension == "1"
    assert not UnitOfMeasure("%", none, 0.01).bare and not UnitOfMeasure("?").bare
