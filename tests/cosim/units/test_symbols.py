"""The table of symbols: pint's definitions, but for the angle in a frequency."""

from __future__ import annotations

import math

import pytest

from evcosim.cosim.units.measure import BASE_UNITS
from evcosim.cosim.units.symbols import _ALONE, is_level, symbol
from evcosim.cosim.units.symbols import _PREFIXED as _WITH_PREFIX
from support.pints import registry

SYMBOLS = {"kg": "kilogram", "m": "meter", "s": "second", "A": "ampere", "K": "kelvin", "mol": "mole"}
SYMBOLS |= {"cd": "candela", "rad": "radian"}
OTHER_NAMES = {
    "gn": "standard_gravity", "rev": "turn", "°": "degree", "Nm": "newton * meter", "gon": "gradian",
    "%": "percent", "Ω": "ohm", "VA": "volt * ampere", "PS": "metric_horsepower", "kn": "knot", "d": "day",
    "gal": "gallon", "Ah": "ampere * hour", "Wh": "watt * hour", "lb": "pound", "ha": "hectare",
    "mmHg": "mmHg", "t": "tonne", "As": "ampere * second", "Vs": "volt * second", "Ws": "joule",
    "Nms": "newton * meter * second", "Ns": "newton * second", "‰": "permille",
    "var": "volt * ampere", "cmH2O": "centimeter_H2O",
}  # fmt: skip # as pint calls them
PREFIXED = (
    ("km", 1e3), ("mV", 1e-3), ("MW", 1e6), ("uA", 1e-6), ("μs", 1e-6), ("dam", 10.0), ("mbar", 100.0),
    ("hPa", 100.0), ("cNm", 0.01), ("kilometers", 1e3), ("Millivolt", 1e-3), ("metres", 1.0),
    ("kilograms", 1.0),
)  # fmt: skip # a table


@pytest.mark.parametrize("name", sorted({*_ALONE, *_WITH_PREFIX}))
def test_a_symbol_is_pints(name):
    factor, exponents, offset = symbol(name)
    unit = registry().Unit(OTHER_NAMES.get(name, name))
    zero, one = (registry().Quantity(x, unit).to_base_units() for x in (0.0, 1.0))
    angle = exponents[-1] if name in ("Hz", "sr", "lm", "lx") else 0  # a turn, or steradians that pint drops
    assert float(factor) / (2.0 * math.pi if name == "Hz" else 1.0) == pytest.approx(
        one.magnitude - zero.magnitude, rel=1e-7
    )
    assert float(offset) == pytest.approx(zero.magnitude, abs=1e-9)
    powers = {str(base): power for base, power in one.unit_items()}
    found = tuple(round(powers.get(SYMBOLS[base], 0)) for base in BASE_UNITS)
    assert exponents[:-1] == found[:-1] and exponents[-1] in (found[-1], angle)


@pytest.mark.parametrize(("name", "factor"), PREFIXED)
def test_prefixes(name, factor):
    assert float(symbol(name)[0]) == factor


@pytest.mark.parametrize(
    "name", ["kmin", "mrpm", "k", "mm2", "Grads", "kilo", "kilokilometer", "mkm", "", "s s"]
)
def test_what_is_no_symbol(name):
    assert symbol(name) is None


def test_levels():
    assert all(map(is_level, ("dB", "dBm", "dBV", "dB(A)", "Np", "decibel", "db")))
    assert not any(map(is_level, ("B", "V", "deg", "bar")))
