"""Conversions between units of measure: exact ones, angles, offsets, levels, and what is refused."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.conversion import between, conversion
from evcosim.cosim.units.definition import defined
from evcosim.cosim.units.measure import (
    Affine,
    DifferenceError,
    OpenUnitError,
    UnitOfMeasure,
    UnknownUnitError,
)
from evcosim.cosim.units.spellings import EXACT
from evcosim.cosim.units.words import WORDS

SPEED = (0, 1, -1, 0, 0, 0, 0, 0)
RATE, TURNING = (0, 0, -1, 0, 0, 0, 0, 0), (0, 0, -1, 0, 0, 0, 0, 1)
MS = UnitOfMeasure("m/s", SPEED)
KMH = UnitOfMeasure("km/h", SPEED, 1 / 3.6)
KELVIN = UnitOfMeasure("K", (0, 0, 0, 0, 1, 0, 0, 0))
CELSIUS = UnitOfMeasure("degC", (0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15)
numbers = st.floats(-1e6, 1e6)

PLAIN = [
    "1",
    "%",
    "ppm",
    "m",
    "km",
    "mi",
    "s",
    "ms",
    "min",
    "h",
    "m/s",
    "kn",
    "m/s2",
    "rad",
    "deg",
    "gon",
    "rev",
    "N",
    "rad/s",
    "deg/s",
    "rpm",
    "cycle/s",
    "Hz",
    "kHz",
    "1/s",
    "s-1",
    "1/h",
    "1/min",
    "min-1",
    "K",
    "degC",
    "degF",
    "delta_K",
    "delta_degC",
    "delta_degF",
    "N.m",
    "J",
    "Wh",
    "kWh",
    "W",
    "hp",
    "PS",
    "A.h",
    "C",
    "V",
    "mV",
    "Pa",
    "bar",
    "psi",
    "kg",
    "g",
    "dB",
    "dBm",
]
PLAIN += [
    "N m",
    "m s-1",
    "l/100km",
    "kWh/(100 km)",
    "V/1000 rpm",
    "kgm2",
    "VDC",
    "psia",
    "%RH",
    "‰",
    "miles per hour",
]
TEXTS = [*PLAIN, *(spelling for spelling, _, _ in (*WORDS, *EXACT))]


def converted(a: str, b: str) -> Affine | None:
    try:
        return between(a, b)
    except ConfigError:
        return None


@given(
    st.lists(st.sampled_from(["N", "m", "s", "kg", "rad", "V", "min", "Wh"]), min_size=2, max_size=4),
    st.lists(st.sampled_from([" ", " * ", "*", ".", "·", "⋅", "\u2022"]), min_size=3, max_size=3),
    st.sampled_from(["", "2", "^2", "²", "-1", "⁻¹", "^(1/2)"]),
)
def test_a_product_is_one_whatever_its_sign(names, signs, exponent):
    """A space, a point, a dot and an asterisk are one sign, whatever stands around them."""
    written = "".join(f"{name}{exponent}{sign}" for name, sign in zip(names, [*signs, ""], strict=False))
    written = written[: written.rindex(names[-1])] + names[-1] + exponent
    plain = "*".join(f"{name}{exponent}" for name in names)
    assert between(written, plain).identity


def test_factors_are_rounded_once():
    assert conversion(MS, KMH) == Affine(3.6)
    assert conversion(KMH, MS) == Affine(5 / 18)


@pytest.mark.parametrize(
    ("source", "target", "scale"),
    [
        ("Hz", "rpm", 60.0), ("Hz", "rad/s", 2 * math.pi), ("Hz", "deg/s", 360.0), ("Hz", "1/min", 60.0),
        ("1/s", "Hz", 1.0), ("s-1", "min-1", 60.0), ("1/h", "Hz", 1 / 3600), ("1/min", "1/s", 1 / 60),
        ("RPM", "U/min", 1.0), ("Umin", "rad/s", 2 * math.pi / 60), ("rev/min", "deg/s", 6.0),
        ("kHz", "1/s", 1000.0),
        ("Grad", "rad", math.pi / 180), ("Grad/sec", "deg/s", 1.0), ("rev", "deg", 360.0),
        ("g", "m/s2", 9.80665), ("g", "kg", 0.001), ("C", "A.h", 1 / 3600), ("J/kg.K", "J/(kg.K)", 1.0),
        ("KM/H", "m/s", 1 / 3.6), ("Psi", "kPa", 6.894757293168362), ("Unit_Volt", "mV", 1000.0),
        ("kgf", "N", 9.80665),
        ("Hz/s", "rpm/s", 60.0), ("m^0.5", "cm^(1/2)", 10.0),
    ],
)  # fmt: skip # a table
def test_scales(source, target, scale):
    assert between(source, target) == Affine(pytest.approx(scale, rel=1e-14))


def test_offsets():
    assert conversion(CELSIUS, KELVIN)(20.0) == pytest.approx(293.15)
    assert conversion(KELVIN, CELSIUS)(273.15) == pytest.approx(0.0, abs=1e-12)
    assert between("DegC", "°F")(100.0) == pytest.approx(212.0)
    assert between("C", "K") == Affine(1.0, 273.15)


@pytest.mark.parametrize(
    ("source", "target", "said"),
    [
        ("m/s", "K", r"\[m/s\] and \[K\] measure different quantities"),
        ("1", "m^0.5", "different quantities"),
        (
            "1/s",
            "rad/s",
            r"\[1/s\] may count turns \(1 is 6.28319 \[rad/s\]\) or radians \(1 is 1 \[rad/s\]\)",
        ),
        ("rpm", "s-1", r"\[s-1\] may count turns \(1 is 60 \[rpm\]\) or radians \(1 is 9.5493 \[rpm\]\)"),
        ("1", "rad", "differ by an angle, which may count radians or turns"),
        ("N.m/rad", "N.m", "differ by an angle"),
        ("ton/h", "kg/s", r"1 \[ton/h\] may be 0.277778 or 0.251996 or 0.282235 \[kg/s\]"),
        ("grad", "rad", r"1 \[grad\] may be 0.0174533 or 0.015708 \[rad\]"),
        ("dB", "1", r"\[dB\] is logarithmic, and converts to nothing but itself"),
        ("W", "dBm", r"\[dBm\] is logarithmic"),
        ("dB", "dBm", "is logarithmic"),
        ("dB/s", "1/s", "is logarithmic"),
    ],
)
def test_what_is_refused(source, target, said):
    for a, b in ((source, target), (target, source)):
        with pytest.raises(ConfigError, match=said if (a, b) == (source, target) else None):
            between(a, b)


def test_what_is_open_is_an_error_of_its_own():
    for a, b in (("1/s", "rad/s"), ("grad", "rad"), ("1", "rad")):
        with pytest.raises(OpenUnitError):
            between(a, b)


@pytest.mark.parametrize("text", TEXTS)
def test_every_text_is_itself(text):
    assert between(text, text).identity


@pytest.mark.parametrize("a", TEXTS)
def test_there_and_back(a):
    found = 0
    for b in TEXTS:
        map_ = converted(a, b)
        assert (map_ is None) == (converted(b, a) is None)
        if map_ is not None:
            found += 1
            for x in (-40.0, 0.0, 1.0, 98.6):
                assert converted(b, a)(map_(x)) == pytest.approx(x, rel=1e-12, abs=1e-9)
    assert found


def test_conversions_in_a_row_are_one_conversion():
    """Wherever all three pairs convert: one text stands for all that are defined alike."""
    kinds = {}
    for text in TEXTS:
        unit = defined(text)
        readings = tuple((u.exponents, u.factor, u.offset, u.cycles) for u in unit.readings)
        kinds.setdefault((readings, unit.logarithmic and text), text)
    texts = list(kinds.values())
    maps = {(a, b): converted(a, b) for a, b in itertools.product(texts, texts)}
    tried = 0
    for a, b, c in itertools.product(texts, texts, texts):
        first, second, whole = maps[a, b], maps[b, c], maps[a, c]
        if first and second and whole:
            tried += 1
            for x in (0.0, 25.0):
                assert second(first(x)) == pytest.approx(whole(x), rel=1e-12, abs=1e-9), (a, b, c)
    assert tried > 1000


def test_a_rotation_that_leaves_the_radian_out_converts_like_one_that_does_not():
    """FMI descriptions of many tools: rad/s as 1/s, rpm as 1/s with 2 pi/60 or 1/60, Hz as 1/s."""
    turn = 2.0 * math.pi
    written = [
        ("rad/s", RATE, 1.0), ("rad/s", TURNING, 1.0), ("rpm", RATE, 1 / 60), ("rpm", RATE, turn / 60),
        ("rpm", TURNING, turn / 60), ("Hz", RATE, 1.0), ("Hz", TURNING, turn), ("1/min", RATE, 1 / 60),
        ("1/min", TURNING, turn / 60), ("deg/s", RATE, turn / 360), ("1/s", RATE, 1.0), ("1/s", TURNING, 1.0),
    ]  # fmt: skip # a table
    units = [defined(name, {name: UnitOfMeasure(name, e, f)}) for name, e, f in written]
    units += [defined(name) for name in ("rad/s", "rpm", "Hz", "1/min", "1/s", "s-1", "U/min")]
    for a, b, c in itertools.product(units, units, units):
        try:
            first, second, whole = conversion(a, b), conversion(b, c), conversion(a, c)
        except ConfigError:
            continue
        assert second(first(1.0)) == pytest.approx(whole(1.0), rel=1e-12), (a, b, c)


def test_a_base_unit_with_the_radian_decides_what_a_rate_is():
    radians = defined("1/s", {"1/s": UnitOfMeasure("1/s", TURNING)})
    assert conversion(radians, defined("rpm")).scale == pytest.approx(30 / math.pi)
    with pytest.raises(OpenUnitError):
        conversion(defined("1/s", {"1/s": UnitOfMeasure("1/s", RATE)}), defined("rpm"))


@pytest.mark.parametrize(
    ("source", "target"), [(CELSIUS, KELVIN), (CELSIUS, CELSIUS), (defined("degF"), CELSIUS)]
)
def test_an_offset_is_for_absolute_quantities(source, target):
    assert conversion(source, target, (True, True)) == Affine(conversion(source, target).scale)
    for relative in ((True, False), (False, True)):
        with pytest.raises(ConfigError, match=r"a difference and .* an absolute|an absolute .* a diff"):
            conversion(source, target, relative)
    assert conversion(KELVIN, KELVIN, (True, False)).identity  # no zero is in question
    assert conversion(MS, KMH, (True, False)) == Affine(3.6)


@pytest.mark.parametrize(
    "warming", ["delta_degC", "\u0394\u00b0C", "\u2206K", "delta_K", "delta degF", "Delta_C"]
)
@pytest.mark.parametrize("absolute", ["K", "degC", "degF", "C", "mK", "Celsius"])
def test_a_unit_of_differences_is_for_no_absolute_temperature(warming, absolute):
    for a, b in ((warming, absolute), (absolute, warming)):
        with pytest.raises(DifferenceError, match=r"the zero of the one means nothing to the other"):
            between(a, b)
    ends = defined(warming), defined(absolute)
    assert not conversion(*ends, (False, True)).offset  # what FMI calls relative is a difference too
    assert conversion(*reversed(ends), (True, False))(0.0) == 0.0
    assert between(warming, "delta_K").scale == pytest.approx(5 / 9 if "F" in warming else 1.0)


def test_a_unit_of_differences_in_a_product_is_a_factor():
    assert between("delta_degC/min", "K/s") == Affine(pytest.approx(1 / 60))
    assert between("W/delta_degF", "W/K").scale == pytest.approx(1.8)
    for text in ("delta_V", "deltaT", "delta_", "delta_delta_degC"):
        with pytest.raises(UnknownUnitError):
            defined(text)


def test_two_definitions_of_one_name():
    near = UnitOfMeasure("km/h", SPEED, 0.277778)
    assert conversion(KMH, near).identity  # digits
    with pytest.raises(OpenUnitError, match=r"define \[km/h\] otherwise: as 0.277778 \[m.s-1\] and as 1 "):
        conversion(KMH, UnitOfMeasure("km/h", SPEED, 1.0))
    with pytest.raises(OpenUnitError, match="otherwise"):
        conversion(CELSIUS, UnitOfMeasure("degC", CELSIUS.exponents))


@given(*[st.floats() for _ in range(4)])
@settings(max_examples=300)
def test_definitions_that_no_number_converts_are_refused(a, b, c, d):
    source, target = UnitOfMeasure("a", SPEED, a, b), UnitOfMeasure("b", SPEED, c, d)
    try:
        map_ = conversion(source, target)
    except ConfigError:
        return
    assert math.isfinite(map_.scale) and map_.scale and math.isfinite(map_.offset)


def test_a_unit_without_a_definition_converts_to_itself_alone():
    unknown = UnitOfMeasure("parsecond")
    assert conversion(unknown, unknown).identity
    with pytest.raises(ConfigError, match="different quantities"):
        conversion(unknown, UnitOfMeasure("furlong"))
