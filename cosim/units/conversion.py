"""The conversion between two units of measure, or the reason why there is none.

Units convert when their exponents are equal, that of rad too. Two more rules:

- A plain rate (1/s) is taken as cycles where the other unit counts cycles and says so (Hz, 1/min), and is
  refused where it is a rotation (rad/s, rpm): it may be radians or turns.
- An offset (degC) is for absolute quantities. Between two differences it is left out; between a difference
  and an absolute quantity there is no conversion. A text may say that it is for differences (delta_degC).
"""

from __future__ import annotations

import math
from fractions import Fraction

from ..errors import ConfigError
from .definition import defined
from .measure import BASE_UNITS, Affine, DifferenceError, DifferentQuantityError, OpenUnitError, UnitOfMeasure

_TURNING = tuple({"s": -1, "rad": 1}.get(base, 0) for base in BASE_UNITS)
_SAME = 1e-3  # relative: definitions of one name that differ by less differ in digits
_ABSOLUTE = (False, False)


def conversion(
    source: UnitOfMeasure, target: UnitOfMeasure, relative: tuple[bool, bool] = _ABSOLUTE
) -> Affine:
    """Return the map from values in `source` to values in `target`.

    `relative` says of each whether its values are differences (FMI: relativeQuantity); a unit may say it too.
    Raises ConfigError when they do not measure the same quantity, or when it stays open which conversion is
    meant.
    """
    if source.name == target.name:
        return _of_one_name(source, target, relative)
    for unit in (source, target):
        if unit.logarithmic:
            raise DifferentQuantityError(f"[{unit.name}] is logarithmic, and converts to nothing but itself")
    found: dict[Affine, tuple[UnitOfMeasure, UnitOfMeasure]] = {}
    for a in source.readings:
        for b in target.readings:
            map_ = _between(a, b)
            if map_ is not None and not any(_close(map_, other) for other in found):
                found[map_] = (a, b)
    if not found:
        raise _no_conversion(source, target)
    if len(found) > 1:
        maps = " or ".join(f"{m.scale:.6g}{f' {m.offset:+.6g}' if m.offset else ''}" for m in found)
        raise OpenUnitError(f"1 [{source.name}] may be {maps} [{target.name}]: the text has several meanings")
    ((map_, pair),) = found.items()
    return _checked(_without_offset(map_, pair, relative), source, target)


def _of_one_name(source: UnitOfMeasure, target: UnitOfMeasure, relative: tuple[bool, bool]) -> Affine:
    """Return the identity, unless the two ends define the name otherwise."""
    a, b = source, target
    same = a.exponents == b.exponents and a.logarithmic == b.logarithmic
    if not (same and math.isclose(a.factor, b.factor, rel_tol=_SAME) and _near(a.offset, b.offset)):
        raise OpenUnitError(
            f"the two ends define [{a.name}] otherwise: as {_in_base_units(a)} and as {_in_base_units(b)}"
        )
    return _without_offset(Affine(), (a, b), relative)


def _in_base_units(unit: UnitOfMeasure) -> str:
    offset = f" + {unit.offset:.6g}" if unit.offset else ""
    return f"{unit.factor:.6g}{offset} [{unit.dimension}]"


def _between(a: UnitOfMeasure, b: UnitOfMeasure) -> Affine | None:
    """Return the map between two readings; None where they measure different quantities."""
    if a.exponents is None or b.exponents is None:
        return None
    if a.exponents == b.exponents:
        if not b.factor:
            return Affine(math.inf)
        return Affine(_ratio(a.factor, b.factor), (a.offset - b.offset) / b.factor)
    if a.plain_rate and b.cycles:
        return Affine(_ratio(a.factor, _cycles(b)))
    if a.cycles and b.plain_rate:
        return Affine(_ratio(_cycles(a), b.factor) if b.factor else math.inf)
    return None


def _cycles(unit: UnitOfMeasure) -> float:
    """Return the cycles a second in one of a frequency's unit."""
    return _ratio(unit.factor, 2.0 * math.pi)


def _ratio(a: float, b: float) -> float:
    """Return a / b, rounded once: 1 / (1/3.6) is 3.6 here, where division gives 3.5999999999999996."""
    exact = [Fraction(x).limit_denominator(1_000_000) for x in (a, b) if math.isfinite(x)]
    if len(exact) == 2 and float(exact[0]) == a and float(exact[1]) == b:
        return float(exact[0] / exact[1])
    quotient = a / b
    if 1e-3 < abs(quotient) < 1e6:  # 2 pi cancels out: 60 rpm a Hz, and not 60.00000000000001
        near = float(Fraction(quotient).limit_denominator(3600))
        if abs(near - quotient) <= 4.0 * math.ulp(quotient):
            return near
    return quotient


def _without_offset(
    map_: Affine, pair: tuple[UnitOfMeasure, UnitOfMeasure], relative: tuple[bool, bool]
) -> Affine:
    """Return the map for what is converted. Raises ConfigError for a difference at one end alone."""
    named = any(unit.difference for unit in pair)
    if not (named or any(reading.offset for unit in pair for reading in unit.readings)):
        return map_
    first, second = (said or unit.difference for said, unit in zip(relative, pair, strict=True))
    if first != second:
        kinds = ["a difference" if each else "an absolute quantity" for each in (first, second)]
        by = "" if named else " (FMI: relativeQuantity)"
        raise DifferenceError(
            f"[{pair[0].name}] is {kinds[0]} and [{pair[1].name}] {kinds[1]}{by}: the zero of the one means "
            "nothing to the other"
        )
    return Affine(map_.scale) if first else map_


def _checked(map_: Affine, source: UnitOfMeasure, target: UnitOfMeasure) -> Affine:
    """Return the map. Raises ConfigError where no double holds its factor or offset."""
    if not (math.isfinite(map_.scale) and map_.scale and math.isfinite(map_.offset)):
        raise ConfigError(
            f"[{source.name}] and [{target.name}] are defined with factors {source.factor:g} and "
            f"{target.factor:g} and offsets {source.offset:g} and {target.offset:g}: no number converts them"
        )
    return map_


def _close(a: Affine, b: Affine) -> bool:
    return math.isclose(a.scale, b.scale, rel_tol=1e-9) and _near(a.offset, b.offset)


def _near(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=_SAME, abs_tol=1e-9)


def _no_conversion(source: UnitOfMeasure, target: UnitOfMeasure) -> ConfigError:
    """Return the error for two units that do not convert, with both readings where an angle is open."""
    plain_rate, turning = source, target
    if target.plain_rate:
        plain_rate, turning = target, source
    if plain_rate.plain_rate and turning.exponents == _TURNING:
        as_turns, as_radians = (x * plain_rate.factor / turning.factor for x in (2.0 * math.pi, 1.0))
        return OpenUnitError(
            f"[{plain_rate.name}] may count turns (1 is {as_turns:.6g} [{turning.name}]) or radians "
            f"(1 is {as_radians:.6g} [{turning.name}])"
        )
    if source.exponents and target.exponents and source.exponents[:-1] == target.exponents[:-1]:
        apart = "differ by an angle, which may count radians or turns"
        return OpenUnitError(f"[{source.name}] and [{target.name}] {apart}")
    return DifferentQuantityError(f"[{source.name}] and [{target.name}] measure different quantities")


def between(source: str, target: str) -> Affine:
    """Return the map between two unit texts. Raises ConfigError as `defined` and `conversion` do."""
    return conversion(defined(source), defined(target))
