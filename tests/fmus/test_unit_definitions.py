"""Unit definitions against pint, which reads the same names from tables of its own."""

from __future__ import annotations

import pint
import pytest

from evcosim.fmus.unit_definitions import BASE_UNITS, define

# What models use or will, and names that differ in pint.
# fmt: off
NAMES = [
    "kg", "m", "s", "A", "K", "mol", "rad", "N", "W", "Wh", "kWh", "V", "ohm", "Hz", "J", "Pa", "C",
    "F", "H", "T", "Wb", "km", "h", "min", "deg", "g", "cm", "mm", "kN", "kW", "mA", "mV", "bar", "rpm",
    "ms", "%", "1", "m/s", "km/h", "m/s2", "m/s3", "rad/s", "rad/s2", "A.h", "kg/m3", "m2", "N.s/m",
    "l/min", "L", "t", "us", "kPa", "MPa", "kJ", "MJ", "MW", "kV", "Ah",
    "N.m", "N.m/A", "Wh/km", "kg.m2", "%.s/m", "%/s", "1/s", "km/(h.%)", "km.s/h", "V.s/rad",
]
# fmt: on
PINT_BASES = {
    "kg": "kilogram",
    "m": "meter",
    "s": "second",
    "A": "ampere",
    "K": "kelvin",
    "mol": "mole",
    "cd": "cd",
}


@pytest.fixture(scope="module")
def registry():
    return pint.UnitRegistry(preprocessors=[lambda text: text.replace("%", "percent")])


@pytest.mark.parametrize("name", NAMES)
def test_factor_and_exponents_agree_with_pint(name, registry):
    above, _, below = name.partition("/")
    expression = above.replace(".", "*") + (f"/({below.strip('()').replace('.', '*')})" if below else "")
    for symbol in ("m", "s", "kg"):
        for power in "23":
            expression = expression.replace(f"{symbol}{power}", f"{symbol}**{power}")
    quantity = (1.0 * registry.parse_expression(expression)) if name != "1" else registry.Quantity(1.0, "")
    base = quantity.to_base_units()
    definition = define(name)
    exponents = dict(definition.exponents)
    assert definition.factor == pytest.approx(base.magnitude, rel=1e-15)
    assert definition.offset == 0.0
    assert {PINT_BASES[s]: e for s, e in exponents.items() if s != "rad"} == {
        str(unit): int(e) for unit, e in base.unit_items() if str(unit) != "radian"
    }


def test_an_offset_stands_alone():
    assert define("degC").offset == 273.15
    with pytest.raises(ValueError, match="'degC' is no unit symbol"):
        define("W/degC")


@pytest.mark.parametrize("name", ["", "m/", "mph", "m//s", "m s", "m/s/s", "m^2", "km/h2x", "M"])
def test_an_unknown_name_is_refused_by_its_part(name):
    with pytest.raises(ValueError, match="is no unit symbol"):
        define(name)


def test_factors_are_the_nearest_floats():
    assert define("km/h").factor == 1 / 3.6
    assert define("%").factor == 0.01
    assert define("A.h").factor == 3600.0
    assert set(dict(define("N.s/m").exponents)) <= set(BASE_UNITS)
