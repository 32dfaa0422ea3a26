"""The grammar of a unit text: what it reads, what it refuses, and that it always ends."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.units.grammar import LONGEST, parse, plain

NONE = (
    "9**9**9**9", "#", "# of Bars", "??", "€", "V(", "V)", "()", "", " ", '"', "m-", "-m", "m*", "*m", "m//s",
    "m**", "m^", "m^s", "m^(s)", "m^(1/0)", "m^(2", "2", "10 Nm", "1e3", "0.1*V", "m 2", "1 1", "m,s",
    "1 m", "100 m", "% N", "N %", "ppm V", "m s -1", "N (m)", "m/200s", "m.100s", "s100 m",
    "m2147483648", "m^999", "(m^9)^9", "m^(1/13)", "11", "1-1", "m**2**2", "x.__class__", "f(x)",
    "__import__('os')", "lambda: 0", "m" * 65, "(" * 64, "(" * 32 + "m" + ")" * 32, "m\0",
    "a/b*c/(d/e*f)/(g/h*i)/(j/k*l)", "m1/2", "٣", "m٣", "m^٣",
)  # fmt: skip # a list
SPEED = ({"m": 1, "s": -1},)


@pytest.mark.parametrize(
    ("text", "readings"),
    [
        *((text, SPEED) for text in ("m/s", "m.s-1", "m*s^-1", "m s^-1".replace(" ", "·"), "m.s**(-1)")),
        *((text, SPEED) for text in ("(m/s)", "m / s", "((m)/(s))", "m⋅s⁻¹", "1*m/s", "m.s^(-2/2)")),
        *((text, SPEED) for text in ("m s-1", "m s^-1", "m  s⁻¹", "m•s⁻¹", "m\u2215s", "m\u2044s")),
        *(
            (text, ({"kg": 1, "m": 2},))
            for text in ("kg m2", "kg m²", "kgm2", "KgM2".lower(), "kgm²", "kgm**2")
        ),
        ("N/kgm2", ({"N": 1, "kg": -1, "m": -2},)),
        ("kgm/s2", ({"kg": 1, "m": 1, "s": -2},)),
        ("kgms", ({"kgms": 1},)),
        *((text, ({"l": 1, "%": 1, "km": -1},)) for text in ("l/100km", "l/100 km", "l / (100 km)")),
        ("V/1000rpm", ({"V": 1, "‰": 1, "rpm": -1},)),
        ("J/kg K", ({"J": 1, "kg": -1, "K": 1}, {"J": 1, "kg": -1, "K": -1})),
        *((text, ({"s": -1},)) for text in ("1/s", "/s", "s-1", "s^-1", "s⁻¹", "(s)-1")),
        ("m/s²", ({"m": 1, "s": -2},)),
        ("m/s/s", ({"m": 1, "s": -2},)),
        ("(m/s)2", ({"m": 2, "s": -2},)),
        ("m^(1/2)", ({"m": Fraction(1, 2)},)),
        ("m^0.5", ({"m": Fraction(1, 2)},)),
        ("m^2.s", ({"m": 2, "s": 1},)),
        ("1", ({},)),
        ("m/m", ({"m": 0},)),
        ("kg.m2/s3", ({"kg": 1, "m": 2, "s": -3},)),
        ("J/kg.K", ({"J": 1, "kg": -1, "K": 1}, {"J": 1, "kg": -1, "K": -1})),
        ("inH2O", ({"inH2O": 1},)),
        ("Â°C", ({"°C": 1},)),
        ("º/s", ({"°": 1, "s": -1},)),
        ("µm", ({"μm": 1},)),
        ("%/s", ({"%": 1, "s": -1},)),
    ],
)
def test_what_is_read(text, readings):
    assert tuple(dict(powers) for powers in parse(plain(text))) == readings


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_unit_text(text):
    assert parse(plain(text)) == ()


@given(st.text(st.sampled_from("ms1290()*/.^+-% °µ#€\"'²⁻_ΩK"), max_size=70) | st.text(max_size=70))
def test_any_text_is_read_or_is_none(text):
    for powers in parse(plain(text)):
        assert len(plain(text)) <= LONGEST
        assert all(abs(exponent) <= 12 and exponent.denominator <= 12 for _, exponent in powers)
