"""Records: a unit of measure over the SI base units, and the affine map between two of them.

FMI 2.0 section 2.2.2: a unit names the exponents of the SI base units (and rad) and how its values map
to them, base = factor * value + offset. Here angle counts: rad is a base unit like the others, so that a
frequency and a rotation (cycles and radians a second) differ by a factor of 2 pi and not by nothing.
"""

from __future__ import annotations

import dataclasses
from fractions import Fraction

from ..errors import ConfigError

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

Exponents = tuple[int | Fraction, ...]
"""The exponents of BASE_UNITS, in their order."""

TEMPERATURE: Exponents = tuple(int(base == "K") for base in BASE_UNITS)


class UnknownUnitError(ConfigError):
    """A text that names no unit of measure."""


class DifferentQuantityError(ConfigError):
    """Two units that measure different quantities."""


class DifferenceError(ConfigError):
    """Two units of which one is for differences, as a warming, and the other for absolute quantities."""


class OpenUnitError(ConfigError):
    """Two units between which several conversions could be meant."""


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

    def then(self, after: Affine) -> Affine:
        """Return this map followed by `after`, as one map."""
        if self.identity or after.identity:
            return after if self.identity else self
        return Affine(after.scale * self.scale, after.scale * self.offset + after.offset)

    def expression(self, x: str) -> str:
        """Return the map as Python source over the expression `x`, without the terms that do nothing."""
        if self.scale != 1.0:
            x = f"{self.scale!r} * {x}"
        return f"{x} + {self.offset!r}" if self.offset != 0.0 else x


@dataclasses.dataclass(frozen=True)
class UnitOfMeasure:
    """A unit: `exponents` over BASE_UNITS (None: the name is declared, its definition is not).

    `cycles`: a frequency in cycles (Hz, 1/min), which a plain rate (1/s) may be too. `logarithmic`: a level
    (dB), which no factor converts. `difference`: it is for differences of temperatures (delta_degC). `also`
    are the other readings of a text that has several.
    """

    name: str
    exponents: Exponents | None = None
    factor: float = 1.0
    offset: float = 0.0
    cycles: bool = False
    logarithmic: bool = False
    difference: bool = False
    also: tuple[UnitOfMeasure, ...] = ()

    @property
    def readings(self) -> tuple[UnitOfMeasure, ...]:
        """The unit and its other readings."""
        return (self, *self.also)

    @property
    def bare(self) -> bool:
        """True for the unit 1: no dimension, no factor."""
        return self.exponents is not None and not any(self.exponents) and self.factor == 1.0

    @property
    def plain_rate(self) -> bool:
        """True for 1/s and its multiples, which may count turns or radians."""
        return self.exponents == tuple(-1 if base == "s" else 0 for base in BASE_UNITS)

    @property
    def dimension(self) -> str:
        """The exponents as text: "kg.m2/s3" as "kg.m2.s-3"; "1" for none."""
        pairs = zip(BASE_UNITS, self.exponents or (), strict=False)
        return ".".join(f"{base}{'' if e == 1 else e}" for base, e in pairs if e) or "1"
