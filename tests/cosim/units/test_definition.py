"""The definition of a unit text: by the FMU, the tables, or nobody."""

from __future__ import annotations

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.units.definition import by_text, contradiction, defined, names_difference
from evcosim.cosim.units.measure import UnitOfMeasure, UnknownUnitError

SPEED = (0, 1, -1, 0, 0, 0, 0, 0)
RATE, TURNING = (0, 0, -1, 0, 0, 0, 0, 0), (0, 0, -1, 0, 0, 0, 0, 1)
A_TURN = 2.0 * math.pi
UNKNOWN = (
    "furlongs/fortnite", "#", "??", "€", "V(", "9**9**9**9", "count", "raw", "bit", "# of Bars", '"', "Grads",
    "tbd", "Cs", "m" * 1000, "m^13", "Ym12.Ym12", "ym12/Ym12", "x" * 64, "(" * 10_000, "1e999",
    "__class__", "Quantity",
)  # fmt: skip # a list
LEFT_OUT = (
    ("rad/s", 1.0), ("deg/s", math.pi / 180), ("deg/s", 0.0174533), ("rpm", A_TURN / 60), ("rpm", 1 / 60),
    ("Hz", 1.0), ("Hz", A_TURN), ("1/min", 1 / 60), ("1/min", 0.0166667), ("rev/min", 1 / 60),
    ("RPM", 1 / 60),
)  # fmt: skip # a table


def test_an_fmu_own_definition_comes_first():
    odd = UnitOfMeasure("km/h", SPEED, 1.0)
    assert defined("km/h", {"km/h": odd}) is odd
    assert defined("km/h", {"km/h": UnitOfMeasure("km/h")}).factor == pytest.approx(1 / 3.6)


def test_the_definition_of_another_fmu_comes_last():
    odd = UnitOfMeasure("km/h", SPEED, 1.0)
    assert defined("km/h", {}, {"km/h": odd}).factor == pytest.approx(1 / 3.6)
    assert defined("knots_of_mine", {}, {}, {"knots_of_mine": odd}) is odd


@pytest.mark.parametrize(
    ("name", "exponents", "factor"),
    [
        ("rpm", TURNING, A_TURN / 60), ("Nm", (1, 2, -2, 0, 0, 0, 0, 0), 1.0), ("%", (0,) * 8, 0.01),
        ("deg/s", TURNING, math.pi / 180), ("m/s^2", (0, 1, -2, 0, 0, 0, 0, 0), 1.0),
        ("kW", (1, 2, -3, 0, 0, 0, 0, 0), 1000.0), ("A.h", (0, 0, 1, 1, 0, 0, 0, 0), 3600.0),
        ("Hz", TURNING, A_TURN), ("kHz", TURNING, 1000 * A_TURN), ("1/min", TURNING, A_TURN / 60),
        ("1/s", RATE, 1.0), ("1/h", RATE, 1 / 3600), ("L/min", (0, 3, -1, 0, 0, 0, 0, 0), 1e-3 / 60),
        ("survey_foot", (0, 1, 0, 0, 0, 0, 0, 0), 1200 / 3937), ("Wh/km", (1, 1, -2, 0, 0, 0, 0, 0), 3.6),
        ("[m/s]", SPEED, 1.0), ("W/degC", (1, 2, -3, 0, -1, 0, 0, 0), 1.0),
        ("KPa/s", (1, -1, -3, 0, 0, 0, 0, 0), 1e3),
    ],
)  # fmt: skip # a table
def test_texts_by_table(name, exponents, factor):
    unit = defined(name)
    assert unit.exponents == exponents
    assert unit.factor == pytest.approx(factor, rel=1e-9)
    assert unit.offset == 0.0 and not unit.also


@pytest.mark.parametrize(
    "name", ["Hz", "mHz", "kilohertz", "1/min", "min-1", "min^-1", "/min", "Unit_MinutInver"]
)
def test_frequencies_count_cycles(name):
    assert defined(name).cycles and defined(name).exponents == TURNING


@pytest.mark.parametrize("name", ["rpm", "rad/s", "1/s", "Hz/s", "L/min", "1/Hz", "cycle/s", "s"])
def test_others_do_not(name):
    assert not defined(name).cycles


@pytest.mark.parametrize("name", UNKNOWN)
def test_an_unknown_text_is_named(name):
    with pytest.raises(UnknownUnitError, match="is not known") as error:
        defined(name)
    assert len(str(error.value)) < 120


@given(st.text(max_size=70))
def test_every_text_has_a_finite_definition_or_none(text):
    unit = by_text(text)
    for reading in unit.readings if unit else ():
        assert reading.logarithmic or (0.0 < reading.factor < math.inf and math.isfinite(reading.offset))


@pytest.mark.parametrize("factor", [1.0, 0.5])
@pytest.mark.parametrize(("name", "left_out"), LEFT_OUT)
def test_a_name_says_the_angle_that_the_exponents_leave_out(name, left_out, factor):
    """If the factor fits, with a radian or a cycle counted as 1."""
    own = UnitOfMeasure(name, RATE, factor * left_out)
    unit = defined(name, {name: own})
    if factor == 1.0:
        assert unit == dataclasses.replace(by_text(name), name=name)
    else:
        assert unit is own


def test_angles_too():
    for name, factor in (("rad", 1.0), ("deg", math.pi / 180), ("rev", 1.0), ("N.m/rad", 1.0)):
        named = by_text(name)
        own = UnitOfMeasure(name, (*named.exponents[:-1], 0), factor)
        assert defined(name, {name: own}).exponents == named.exponents


def test_a_definition_with_the_angle_stays():
    own = UnitOfMeasure("1/min", TURNING, A_TURN / 60)
    assert defined("1/min", {"1/min": own}) == dataclasses.replace(own, cycles=True)
    radians = UnitOfMeasure("1/s", TURNING)
    assert defined("1/s", {"1/s": radians}) is radians


def test_an_own_definition_of_a_difference_is_one():
    kelvin = by_text("K").exponents
    assert defined("delta_degC", {"delta_degC": UnitOfMeasure("delta_degC", kelvin)}).difference
    assert names_difference("\u0394K") and not names_difference("K") and not names_difference("?")


def test_an_empty_definition_is_none():
    empty = UnitOfMeasure("kV", (0,) * 8)
    assert defined("kV", {"kV": empty}) == by_text("kV")
    one = UnitOfMeasure("p.u.", (0,) * 8)
    assert defined("p.u.", {"p.u.": one}) is one


@pytest.mark.parametrize("name", ["km/h", "rpm", "Hz", "degC", "V", "C", "1/min"])
def test_a_definition_against_its_name_is_said(name):
    usual = by_text(name)
    for u in (usual, dataclasses.replace(usual, factor=usual.factor * (1 + 1e-4))):
        assert contradiction(u) == ""
    odd = dataclasses.replace(usual, factor=usual.factor * 2.0)
    assert contradiction(odd).startswith(f"[{name}] is defined as {odd.factor:.6g} [")
    assert contradiction(dataclasses.replace(odd, name="of mine")) == ""
