"""Units of measure: conversion by definition, and pint for names without one."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units import _USUAL, Affine, UnitOfMeasure, by_pint, conversion, defined

SPEED = (0, 1, -1, 0, 0, 0, 0, 0)
MS = UnitOfMeasure("m/s", SPEED)
KMH = UnitOfMeasure("km/h", SPEED, 1 / 3.6)
KELVIN = UnitOfMeasure("K", (0, 0, 0, 0, 1, 0, 0, 0))
CELSIUS = UnitOfMeasure("degC", (0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15)
numbers = st.floats(-1e6, 1e6)


def test_factors_are_rounded_once():
    assert conversion(MS, KMH) == Affine(3.6)
    assert conversion(KMH, MS) == Affine(5 / 18)


def test_offsets():
    assert conversion(CELSIUS, KELVIN)(20.0) == pytest.approx(293.15)
    assert conversion(KELVIN, CELSIUS)(273.15) == pytest.approx(0.0, abs=1e-12)


@given(numbers, st.sampled_from([(MS, KMH), (CELSIUS, KELVIN), (MS, MS)]))
def test_there_and_back(x, pair):
    a, b = pair
    assert conversion(b, a)(conversion(a, b)(x)) == pytest.approx(x, rel=1e-12, abs=1e-9)


@given(numbers, st.floats(0.01, 100), numbers)
def test_expression_is_the_map(x, scale, offset):
    affine = Affine(scale, offset)
    assert eval(affine.expression("x"), {"x": x}) == affine(x)
    assert affine.inverse()(affine(x)) == pytest.approx(x, rel=1e-9, abs=1e-6 * (1 + abs(offset)) / scale)


def test_different_quantities_are_refused():
    with pytest.raises(ConfigError, match=r"\[m/s\] and \[K\]"):
        conversion(MS, KELVIN)


def test_an_fmu_own_definition_comes_first():
    odd = UnitOfMeasure("km/h", SPEED, 1.0)
    assert defined("km/h", {"km/h": odd}) is odd
    assert defined("km/h", {"km/h": UnitOfMeasure("km/h")}).factor == pytest.approx(1 / 3.6)


@pytest.mark.parametrize(
    ("name", "si", "factor"),
    [
        ("rpm", UnitOfMeasure("rad/s", (0, 0, -1, 0, 0, 0, 0, 1)), 0.104719755),
        ("Nm", UnitOfMeasure("N.m", (1, 2, -2, 0, 0, 0, 0, 0)), 1.0),
        ("%", UnitOfMeasure("1", (0,) * 8), 0.01),
        ("deg/s", UnitOfMeasure("rad/s", (0, 0, -1, 0, 0, 0, 0, 1)), 0.0174532925),
        ("m/s^2", UnitOfMeasure("m/s2", (0, 1, -2, 0, 0, 0, 0, 0)), 1.0),
        ("m/s2", UnitOfMeasure("m/s2", (0, 1, -2, 0, 0, 0, 0, 0)), 1.0),
        ("kW", UnitOfMeasure("W", (1, 2, -3, 0, 0, 0, 0, 0)), 1000.0),
        ("A.h", UnitOfMeasure("C", (0, 0, 1, 1, 0, 0, 0, 0)), 3600.0),
    ],
)
def test_names_that_only_a_dbc_uses(name, si, factor):
    assert conversion(defined(name), si).scale == pytest.approx(factor, rel=1e-8)


def test_an_unknown_name_is_named():
    with pytest.raises(ConfigError, match="'furlongs/fortnite' is not known"):
        defined("furlongs/fortnite")


@pytest.mark.parametrize("name", sorted(_USUAL))
def test_the_table_of_usual_units_is_pints(name):
    ours, pints = _USUAL[name], by_pint(name)
    assert ours.exponents is not None and pints.exponents is not None
    assert ours.factor == pytest.approx(pints.factor, rel=1e-12)
    assert ours.offset == pints.offset == 0.0
    assert ours.exponents[:-1] == pints.exponents[:-1]  # pint does not always keep rad
    assert conversion(ours, pints).scale == pytest.approx(1.0, rel=1e-12)


QUANTITIES = [
    [u for u in _USUAL.values() if u.exponents == e] for e in sorted({u.exponents for u in _USUAL.values()})
]


@given(numbers, st.sampled_from(QUANTITIES).flatmap(lambda units: st.tuples(*[st.sampled_from(units)] * 3)))
def test_conversions_in_a_row_are_one_conversion(x, units):
    a, b, c = units
    twice, once = conversion(b, c)(conversion(a, b)(x)), conversion(a, c)(x)
    assert twice == pytest.approx(once, rel=1e-12, abs=1e-300)


def test_the_identity_maps_every_value_to_itself():
    assert Affine().identity and Affine()(7.5) == 7.5
    assert Affine().expression("x") == "x"
    assert not Affine(2.0).identity and not Affine(1.0, 1.0).identity


def test_a_unit_without_a_definition_converts_to_itself_alone():
    unknown = UnitOfMeasure("parsecond")
    assert conversion(unknown, unknown).identity
    with pytest.raises(ConfigError, match="different quantities"):
        conversion(unknown, UnitOfMeasure("furlong"))
