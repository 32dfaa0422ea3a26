"""The symbols of units: those of the SI with their prefixes, and others that are exactly defined.

Sources: the SI brochure (9th edition, 2019) with its prefixes and non-SI units accepted for use; NIST SP 811,
appendix B, for the rest. Factors are exact, but for pi, which is the double nearest to it.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from fractions import Fraction

from .measure import BASE_UNITS, Exponents
from .names import NAMES

_PI = Fraction(math.pi)
_GRAVITY = Fraction("9.80665")  # standard gravity (3rd CGPM, 1901) [m/s2]
_POUND, _INCH, _MILE = Fraction("0.45359237"), Fraction("0.0254"), Fraction("1609.344")
_HOUR = Fraction(3600)

_Size = tuple[Fraction | int, dict[str, int]]
_FORCE, _ENERGY = {"kg": 1, "m": 1, "s": -2}, {"kg": 1, "m": 2, "s": -2}
_POWER, _PRESSURE = {"kg": 1, "m": 2, "s": -3}, {"kg": 1, "m": -1, "s": -2}

_PREFIXES = {
    "Q": 30, "R": 27, "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "d": -1, "c": -2, "m": -3, "u": -6, "μ": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
    "r": -27, "q": -30,
}  # fmt: skip # a line for the multiples and two for the parts
_OF_TONNES = ("k", "M", "G", "T")
_LONG_PREFIXES = {
    "exa": "E", "peta": "P", "tera": "T", "giga": "G", "mega": "M", "kilo": "k", "hecto": "h", "deca": "da",
    "deka": "da", "deci": "d", "centi": "c", "milli": "m", "micro": "u", "nano": "n", "pico": "p",
    "femto": "f", "atto": "a",
}  # fmt: skip # those that are met

# with prefixes; angle counts, so that Hz is 2 pi rad a second, and lm holds steradians
_PREFIXED: dict[str, _Size] = {
    "m": (1, {"m": 1}), "g": (Fraction(1, 1000), {"kg": 1}), "s": (1, {"s": 1}), "A": (1, {"A": 1}),
    "K": (1, {"K": 1}), "mol": (1, {"mol": 1}), "cd": (1, {"cd": 1}), "rad": (1, {"rad": 1}),
    "sr": (1, {"rad": 2}), "Hz": (2 * _PI, {"rad": 1, "s": -1}), "N": (1, _FORCE), "Pa": (1, _PRESSURE),
    "J": (1, _ENERGY), "W": (1, _POWER), "C": (1, {"s": 1, "A": 1}), "V": (1, _POWER | {"A": -1}),
    "F": (1, {"kg": -1, "m": -2, "s": 4, "A": 2}), "ohm": (1, _POWER | {"A": -2}),
    "Ω": (1, _POWER | {"A": -2}), "S": (1, {"kg": -1, "m": -2, "s": 3, "A": 2}),
    "Wb": (1, _ENERGY | {"A": -1}), "T": (1, {"kg": 1, "s": -2, "A": -1}), "H": (1, _ENERGY | {"A": -2}),
    "lm": (1, {"cd": 1, "rad": 2}), "lx": (1, {"cd": 1, "rad": 2, "m": -2}), "Bq": (1, {"s": -1}),
    "Gy": (1, {"m": 2, "s": -2}), "Sv": (1, {"m": 2, "s": -2}), "kat": (1, {"mol": 1, "s": -1}),
    "L": (Fraction(1, 1000), {"m": 3}), "l": (Fraction(1, 1000), {"m": 3}), "t": (1000, {"kg": 1}),
    "bar": (100_000, _PRESSURE), "Wh": (_HOUR, _ENERGY), "Ah": (_HOUR, {"s": 1, "A": 1}), "VA": (1, _POWER),
    "Nm": (1, _ENERGY), "Ns": (1, _FORCE | {"s": -1}), "Nms": (1, _ENERGY | {"s": -1}), "Ws": (1, _ENERGY),
    "As": (1, {"s": 1, "A": 1}), "Vs": (1, _ENERGY | {"A": -1}), "var": (1, _POWER),
    "eV": (Fraction("1.602176634e-19"), _ENERGY),
}  # fmt: skip # related units side by side
_ALONE: dict[str, _Size] = {
    "%": (Fraction(1, 100), {}), "‰": (Fraction(1, 1000), {}), "ppm": (Fraction(1, 1_000_000), {}),
    "min": (60, {"s": 1}), "h": (_HOUR, {"s": 1}), "d": (24 * _HOUR, {"s": 1}),
    "deg": (_PI / 180, {"rad": 1}), "°": (_PI / 180, {"rad": 1}), "gon": (_PI / 200, {"rad": 1}),
    "rev": (2 * _PI, {"rad": 1}), "cycle": (2 * _PI, {"rad": 1}), "turn": (2 * _PI, {"rad": 1}),
    "rpm": (_PI / 30, {"rad": 1, "s": -1}), "gn": (_GRAVITY, {"m": 1, "s": -2}),
    "degC": (1, {"K": 1}), "degF": (Fraction(5, 9), {"K": 1}), "ha": (10_000, {"m": 2}),
    "in": (_INCH, {"m": 1}), "ft": (12 * _INCH, {"m": 1}), "yd": (36 * _INCH, {"m": 1}),
    "mi": (_MILE, {"m": 1}), "mph": (_MILE / _HOUR, {"m": 1, "s": -1}),
    "kph": (Fraction(5, 18), {"m": 1, "s": -1}), "kn": (1852 / _HOUR, {"m": 1, "s": -1}),
    "lb": (_POUND, {"kg": 1}), "short_ton": (2000 * _POUND, {"kg": 1}), "lbf": (_POUND * _GRAVITY, _FORCE),
    "psi": (_POUND * _GRAVITY / _INCH**2, _PRESSURE), "atm": (101_325, _PRESSURE),
    "mmHg": (Fraction("133.322387415"), _PRESSURE), "gal": (231 * _INCH**3, {"m": 3}),
    "kgf": (_GRAVITY, _FORCE), "cP": (Fraction(1, 1000), _PRESSURE | {"s": -1}),
    "cSt": (Fraction(1, 1_000_000), {"m": 2, "s": -1}), "cmH2O": (Fraction("98.0665"), _PRESSURE),
    "inH2O": (Fraction("249.08891"), _PRESSURE),
    "inHg": (_INCH * 1000 * Fraction("133.322387415"), _PRESSURE),
    "hp": (550 * 12 * _INCH * _POUND * _GRAVITY, _POWER), "PS": (75 * _GRAVITY, _POWER),
}  # fmt: skip # related units side by side
_OFFSETS = {"degC": Fraction("273.15"), "degF": Fraction("459.67") * Fraction(5, 9)}
_LONG = {
    "meter": "m", "metre": "m", "gram": "g", "second": "s", "ampere": "A", "amp": "A", "hertz": "Hz",
    "newton": "N", "pascal": "Pa", "joule": "J", "watt": "W", "volt": "V", "liter": "L", "litre": "L",
    "kelvin": "K", "radian": "rad", "coulomb": "C", "farad": "F", "siemens": "S", "henry": "H", "tesla": "T",
    "ohm": "ohm", "watthour": "Wh", "amperehour": "Ah", "watt_hour": "Wh", "ampere_hour": "Ah",
    "volt_ampere": "VA", "candela": "cd", "mole": "mol", "lumen": "lm", "lux": "lx", "weber": "Wb",
    "becquerel": "Bq", "gray": "Gy", "sievert": "Sv", "katal": "kat", "steradian": "sr", "tonne": "t",
    "bar": "bar",
    "electronvolt": "eV", "electron_volt": "eV",
}  # fmt: skip # as they are written out, with a long prefix or none

_IN_ANY_CASE = {
    name.casefold(): name for name in NAMES if len(name) > 3 and not name.startswith("cal")
}  # a capital tells Cal from cal, and short names have homonyms

LEVELS = frozenset({"Np", "neper", "Bel", "bel", "decibel", "db", "octave", "decade", "phon"})
"""Names of logarithmic units beside those that begin with dB: no factor converts them."""

Size = tuple[Fraction, Exponents, Fraction]
"""Factor, exponents and offset of a symbol."""


def is_level(name: str) -> bool:
    """Return True for the name of a logarithmic unit: dB, dBm, dBV, Np and the like."""
    return name.startswith("dB") or name in LEVELS


@functools.cache
def symbol(name: str) -> Size | None:
    """Return what a symbol, or a name that is written out, stands for; None where it is no such symbol."""
    found = _ALONE.get(name) or _PREFIXED.get(name)
    if found is None:
        found = _prefixed(name, _PREFIXED) or _written_out(name) or _named(name)
    if found is None:
        return None
    factor, powers = found
    exponents = tuple(powers.get(base, 0) for base in BASE_UNITS)
    return Fraction(factor), exponents, _OFFSETS.get(name, Fraction(0))


def _prefixed(name: str, symbols: dict[str, _Size]) -> _Size | None:
    for prefix in (name[:1], name[:2]):
        rest = name[len(prefix) :]
        if rest == "t" and prefix not in _OF_TONNES:
            continue  # "ct" is a carat, and "pt" a pint
        if prefix in _PREFIXES and rest in symbols:
            factor, powers = symbols[rest]
            return Fraction(10) ** _PREFIXES[prefix] * factor, powers
    return None


def _written_out(name: str) -> _Size | None:
    """Return the unit of "kilometers" or "volt"."""
    small = name.casefold()
    prefix = next((long for long in _LONG_PREFIXES if small.startswith(long)), "")
    rest = small.removeprefix(prefix)
    base = _LONG.get(rest) or _LONG.get(rest.removesuffix("s"))
    if base is None:
        return None
    return _prefixed(_LONG_PREFIXES[prefix] + base, _PREFIXED) if prefix else _PREFIXED[base]


def _keys(name: str) -> Iterator[str]:
    """Yield the keys of NAMES that a name may stand for: its singular, and the same in other capitals."""
    for each in (name, name[:-1] if name[-1:] in "sS" else name):
        yield each
        if each in (each.upper(), each.capitalize(), each.title()):  # microN is a force, and no micron
            yield _IN_ANY_CASE.get(each.casefold(), each)


def _named(name: str) -> _Size | None:
    """Return the unit of a name of NAMES, of its plural, or of one behind a prefix that is written out."""
    prefixes = ["", *(long for long in _LONG_PREFIXES if name.casefold().startswith(long))]
    for prefix in prefixes:
        rest = name[len(prefix) :]
        found = next((NAMES[key] for key in _keys(rest) if key in NAMES), None)
        if found is not None:
            factor, base = found
            size, powers = _ALONE.get(base) or _PREFIXED.get(base) or _prefixed(base, _PREFIXED) or (0, {})
            scale = Fraction(10) ** _PREFIXES[_LONG_PREFIXES[prefix]] if prefix else 1
            return scale * factor * size, powers
    return None
