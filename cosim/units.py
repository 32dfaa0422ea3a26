"""Units of measure: conversion by what the FMUs themselves declare.

FMI 2.0 section 2.2.2: a unit names the exponents of the SI base units (and rad) and how its values map
to them, base = factor * value + offset. Two units convert into each other when their exponents are equal.
A name that no FMU defines (a DBC signal's "rpm") is looked up in a table of the usual ones, then with pint,
which takes 0.4 s to load.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping
from fractions import Fraction

from .errors import ConfigError

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclasses.dataclass(frozen=True)
class Affine:
    """The map x -> scale * x + offset."""

    scale: float = 1.0
    offset: float = 0.0

    def __call__(self, x: float) -> float:
        return self.scale * x + self.offset

    @property
    def identity(self) -> bool:
        """True where it maps every value to itself."""
        return self.scale == 1.0 and self.offset == 0.0

    def inverse(self) -> Affine:
        """Return the map back. Raises ZeroDivisionError for a map that sends all values to one."""
        return Affine(1.0 / self.scale, -self.offset / self.scale)

    def expression(self, x: str) -> str:
        """Return the map as Python source over the expression `x`, without the terms that do nothing."""
        if self.scale != 1.0:
            x = f"{self.scale!r} * {x}"
        return f"{x} + {self.offset!r}" if self.offset != 0.0 else x


@dataclasses.dataclass(frozen=True)
class UnitOfMeasure:
    """A unit: `exponents` over BASE_UNITS (None: the name is declared, its definition is not)."""

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0
    angle_known: bool = True  # False for pint's units, in which rad is 1


def _usual() -> dict[str, UnitOfMeasure]:
    """Return the units of DBC files, figures and metrics that most runs need; tests compare pint's."""
    none, length, speed = (0,) * 8, (0, 1, 0, 0, 0, 0, 0, 0), (0, 1, -1, 0, 0, 0, 0, 0)
    force, energy, power = (1, 1, -2, 0, 0, 0, 0, 0), (1, 2, -2, 0, 0, 0, 0, 0), (1, 2, -3, 0, 0, 0, 0, 0)
    second, ampere, volt = (0, 0, 1, 0, 0, 0, 0, 0), (0, 0, 0, 1, 0, 0, 0, 0), (1, 2, -3, -1, 0, 0, 0, 0)
    radian, turning = (0, 0, 0, 0, 0, 0, 0, 1), (0, 0, -1, 0, 0, 0, 0, 1)
    acceleration = (0, 1, -2, 0, 0, 0, 0, 0)
    degree, hour = math.pi / 180.0, 3600.0
    table: dict[str, tuple[tuple[int, ...], float]] = {
        "": (none, 1.0), "1": (none, 1.0), "%": (none, 0.01),
        "m": (length, 1.0), "km": (length, 1000.0), "mm": (length, 0.001),
        "s": (second, 1.0), "ms": (second, 0.001), "min": (second, 60.0), "h": (second, hour),
        "m/s": (speed, 1.0), "km/h": (speed, 1.0 / 3.6),
        "m/s2": (acceleration, 1.0), "m/s^2": (acceleration, 1.0),
        "rad": (radian, 1.0), "deg": (radian, degree), "rad/s": (turning, 1.0), "deg/s": (turning, degree),
        "rpm": (turning, 2.0 * math.pi / 60.0),
        "N": (force, 1.0), "kN": (force, 1000.0), "N.m": (energy, 1.0), "Nm": (energy, 1.0),
        "W": (power, 1.0), "kW": (power, 1000.0), "J": (energy, 1.0), "Wh": (energy, hour),
        "kWh": (energy, 1000.0 * hour), "Wh/km": (force, hour / 1000.0),
        "V": (volt, 1.0), "A": (ampere, 1.0), "A.h": ((0, 0, 1, 1, 0, 0, 0, 0), hour),
    }  # fmt: skip # related units side by side
    return {name: UnitOfMeasure(name, exponents, factor) for name, (exponents, factor) in table.items()}


_USUAL = _usual()

# Names that DBC files use and pint reads differently or not at all.
_ALIASES = {
    "": "dimensionless",
    "1": "dimensionless",
    "-": "dimensionless",
    "%": "percent",
    "Nm": "N*m",
    "deg": "degree",
    "deg/s": "degree/s",
    "°": "degree",
    "°C": "degC",
    "1/min": "rpm",
    "kph": "km/h",
}


def defined(name: str, *sources: Mapping[str, UnitOfMeasure]) -> UnitOfMeasure:
    """Return the definition of a unit name: by the first of `sources` that has it, the usual units, or pint.

    Raises ConfigError when nobody knows the name.
    """
    for source in sources:
        unit = source.get(name)
        if unit is not None and unit.exponents is not None:
            return unit
    return _USUAL.get(name) or by_pint(name)


@functools.cache
def by_pint(name: str) -> UnitOfMeasure:
    """Return pint's definition of a unit name. Raises ConfigError when it has none."""
    import pint  # 0.3 s, and only names without a definition need it

    registry = _pint_registry()
    # FMI and Modelica write a product as "N.m" and a power as "m2"
    text = _ALIASES.get(name) or _spell_out(name)
    try:
        unit = registry.Unit(text)
        zero = registry.Quantity(0.0, unit).to_base_units()
        one = registry.Quantity(1.0, unit).to_base_units()
    except (pint.PintError, ValueError, TypeError, AttributeError, SyntaxError) as error:
        raise ConfigError(
            f"unit of measure '{name}' is not known: no FMU defines it, nor does pint"
        ) from error
    powers = {str(base): float(power) for base, power in one.unit_items()}
    symbols = {"kg": "kilogram", "m": "meter", "s": "second", "A": "ampere", "K": "kelvin", "mol": "mole"}
    symbols |= {"cd": "candela", "rad": "radian"}
    exponents = tuple(int(powers.pop(symbols[b], 0)) for b in BASE_UNITS)
    if powers:
        raise ConfigError(f"unit of measure '{name}' has parts outside the SI base units: {sorted(powers)}")
    return UnitOfMeasure(
        name, exponents, one.magnitude - zero.magnitude, zero.magnitude, angle_known=exponents[-1] != 0
    )


@functools.cache
def _pint_registry():  # type: ignore[no-untyped-def] # pint is imported lazily, so its types have no name here
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def _spell_out(name: str) -> str:
    """Return a unit name of FMI or Modelica as pint has it: "kg.m2" as "kg*m**2"."""
    import re

    with_powers = re.sub(r"(?<=[A-Za-z])(-?\d+)", r"**\1", name)
    return re.sub(r"(?<=[A-Za-z\d)])\.(?=[A-Za-z(])", "*", with_powers)


def conversion(source: UnitOfMeasure, target: UnitOfMeasure) -> Affine:
    """Return the map from values in `source` to values in `target`.

    Raises ConfigError when they do not measure the same quantity.
    """
    if source == target or (source.name == target.name and source.exponents == target.exponents):
        return Affine()
    if not _same_quantity(source, target):
        raise ConfigError(f"[{source.name}] and [{target.name}] measure different quantities")
    return Affine(_ratio(source.factor, target.factor), (source.offset - target.offset) / target.factor)


def _ratio(a: float, b: float) -> float:
    """Return a / b, rounded once: 1 / (1/3.6) is 3.6 here, where division gives 3.5999999999999996."""
    exact = [Fraction(x).limit_denominator(1_000_000) for x in (a, b)]
    if float(exact[0]) == a and float(exact[1]) == b:
        return float(exact[0] / exact[1])
    return a / b


def _same_quantity(a: UnitOfMeasure, b: UnitOfMeasure) -> bool:
    """Return whether both are defined and have the same exponents."""
    if a.exponents is None or b.exponents is None:
        return False
    if a.angle_known and b.angle_known:
        return a.exponents == b.exponents
    return a.exponents[:-1] == b.exponents[:-1]  # rad is 1 on one side
