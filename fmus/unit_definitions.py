"""Definitions of units of measure in FMI: base-unit exponents, factor and offset, from a table of symbols.

A name is symbols with optional powers, "." between factors and "/" once: `kg/m3`, `N.s/m`, `km/(h.%)`.
Everything after "/" divides, with or without parentheses.
A value x in the unit is `factor x + offset` in base units. Names and symbols are those of the SI brochure,
and `1`, `%`, `rpm`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

# symbol: (factor, exponents of the base units)
_SYMBOLS: dict[str, tuple[Fraction, dict[str, int]]] = {
    **{name: (Fraction(1), {name: 1}) for name in BASE_UNITS},
    "1": (Fraction(1), {}),
    "%": (Fraction(1, 100), {}),
    "g": (Fraction(1, 1000), {"kg": 1}),
    "km": (Fraction(1000), {"m": 1}),
    "cm": (Fraction(1, 100), {"m": 1}),
    "mm": (Fraction(1, 1000), {"m": 1}),
    "l": (Fraction(1, 1000), {"m": 3}),
    "L": (Fraction(1, 1000), {"m": 3}),
    "t": (Fraction(1000), {"kg": 1}),
    "us": (Fraction(1, 1_000_000), {"s": 1}),
    "ms": (Fraction(1, 1000), {"s": 1}),
    "min": (Fraction(60), {"s": 1}),
    "h": (Fraction(3600), {"s": 1}),
    "mA": (Fraction(1, 1000), {"A": 1}),
    "Ah": (Fraction(3600), {"s": 1, "A": 1}),
    "Hz": (Fraction(1), {"s": -1}),
    "N": (Fraction(1), {"kg": 1, "m": 1, "s": -2}),
    "kN": (Fraction(1000), {"kg": 1, "m": 1, "s": -2}),
    "Pa": (Fraction(1), {"kg": 1, "m": -1, "s": -2}),
    "kPa": (Fraction(1000), {"kg": 1, "m": -1, "s": -2}),
    "MPa": (Fraction(1_000_000), {"kg": 1, "m": -1, "s": -2}),
    "bar": (Fraction(100_000), {"kg": 1, "m": -1, "s": -2}),
    "J": (Fraction(1), {"kg": 1, "m": 2, "s": -2}),
    "kJ": (Fraction(1000), {"kg": 1, "m": 2, "s": -2}),
    "MJ": (Fraction(1_000_000), {"kg": 1, "m": 2, "s": -2}),
    "Wh": (Fraction(3600), {"kg": 1, "m": 2, "s": -2}),
    "kWh": (Fraction(3_600_000), {"kg": 1, "m": 2, "s": -2}),
    "W": (Fraction(1), {"kg": 1, "m": 2, "s": -3}),
    "kW": (Fraction(1000), {"kg": 1, "m": 2, "s": -3}),
    "MW": (Fraction(1_000_000), {"kg": 1, "m": 2, "s": -3}),
    "C": (Fraction(1), {"s": 1, "A": 1}),
    "V": (Fraction(1), {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "mV": (Fraction(1, 1000), {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "kV": (Fraction(1000), {"kg": 1, "m": 2, "s": -3, "A": -1}),
    "ohm": (Fraction(1), {"kg": 1, "m": 2, "s": -3, "A": -2}),
    "F": (Fraction(1), {"kg": -1, "m": -2, "s": 4, "A": 2}),
    "Wb": (Fraction(1), {"kg": 1, "m": 2, "s": -2, "A": -1}),
    "T": (Fraction(1), {"kg": 1, "s": -2, "A": -1}),
    "H": (Fraction(1), {"kg": 1, "m": 2, "s": -2, "A": -2}),
    "deg": (Fraction(math.pi / 180), {"rad": 1}),
    "rev": (Fraction(2 * math.pi), {"rad": 1}),
    "rpm": (Fraction(2 * math.pi / 60), {"rad": 1, "s": -1}),
}
_TOKEN = re.compile(r"(1|%|[A-Za-z]+?)(-?[1-9])?")


@dataclass(frozen=True)
class UnitDefinition:
    """FMI BaseUnit: the exponents that are not 0, and base value = factor x value + offset."""

    exponents: tuple[tuple[str, int], ...]
    factor: float = 1.0
    offset: float = 0.0


def define(name: str) -> UnitDefinition:
    """Return the definition of a unit name. Raises ValueError for a name that cannot be read."""
    if name == "degC":  # an offset has a meaning only where the unit stands alone
        return UnitDefinition((("K", 1),), offset=273.15)
    above, slash, below = name.partition("/")
    if below.startswith("(") and below.endswith(")"):
        below = below[1:-1]
    factor = Fraction(1)
    exponents = dict.fromkeys(BASE_UNITS, 0)
    for part, sign in ((above, 1), (below, -1)) if slash else ((above, 1),):
        for token in part.split("."):
            size, dimension, power = _read(name, token)
            factor *= size ** (sign * power)
            for base, exponent in dimension.items():
                exponents[base] += sign * power * exponent
    return UnitDefinition(tuple((b, e) for b, e in exponents.items() if e), float(factor))


def _read(name: str, token: str) -> tuple[Fraction, dict[str, int], int]:
    """Return factor, exponents and power of one symbol of a unit name. Raises ValueError."""
    match = _TOKEN.fullmatch(token)
    if match is None or match[1] not in _SYMBOLS:
        raise ValueError(f"unit {name!r}: {token!r} is no unit symbol (known: {' '.join(_SYMBOLS)} degC)")
    size, dimension = _SYMBOLS[match[1]]
    return size, dimension, int(match[2] or 1)
