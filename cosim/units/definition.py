"""The definition of a unit of measure by its text, or by an FMU's own description of it.

An FMU's own definition comes first; a text without one is read by the tables of everyday spellings, of the
symbols of the SI, and of other names.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from .annotations import annotated, objection
from .grammar import LONGEST, Powers, parse, plain
from .measure import BASE_UNITS, TEMPERATURE, Exponents, UnitOfMeasure, UnknownUnitError
from .names import doubt
from .spellings import meanings, says_none
from .symbols import Size, is_level, symbol

_NONE: Exponents = (0,) * len(BASE_UNITS)
_RAD = BASE_UNITS.index("rad")
_A_MINUTE: Powers = (("min", Fraction(-1)),)
_DELTA = re.compile(r"(?:[Dd]elta[ _]?|Δ[ _]?)(.+)")
_DEGREES = re.compile(r"(?i:°|(?<![^\W_])deg)(?: ?[.-] ?| )([CFK])(?![^\W_])")  # "° C", "Deg.F"
_HYPHEN = re.compile(r"(?<=[\w)])-(?=[^\W\d])")
_PER = re.compile(r" per ", re.IGNORECASE)
_SHORT = 5  # characters of a name whose capitals are tried
_FITS = 1e-3  # relative: tools write a factor with as few as four digits


def defined(
    name: str, own: Mapping[str, UnitOfMeasure] | None = None, *others: Mapping[str, UnitOfMeasure]
) -> UnitOfMeasure:
    """Return the definition of a unit text.

    It is that of `own`, the units that the text's FMU defines; else the reading of the text; else that of
    `others`, the units that other FMUs define. Raises UnknownUnitError when nobody knows the text.
    """
    unit = (own or {}).get(name)
    if unit is not None and unit.exponents is not None:
        return as_named(unit)
    found = by_text(name)
    if found is not None:
        return found
    for source in others:
        unit = source.get(name)
        if unit is not None and unit.exponents is not None:
            return unit
    said = name if len(name) <= LONGEST else name[:LONGEST] + "..."
    text = plain(said)
    names = [each for powers in parse(text) for each, _ in powers]
    why = doubt([text, *names]) or next(filter(None, map(objection, [text, *names])), "")
    why = why or _by_case(names) or _by_hyphen(text)
    raise UnknownUnitError(f"unit of measure '{said}' is not known{why}")


@functools.lru_cache(maxsize=4096)
def by_text(text: str) -> UnitOfMeasure | None:
    """Return the unit that a text names, with its other readings; None where it names none."""
    name = _DEGREES.sub(r"deg\1", plain(text)) if len(text) <= LONGEST else text
    if says_none(name):
        return UnitOfMeasure(text, _NONE)
    if name.startswith("[") and name.endswith("]"):
        name = name[1:-1].strip()
    if is_level(name) and len(name) <= LONGEST:
        return UnitOfMeasure(text, logarithmic=True)
    if (warming := _difference(name)) is not None:
        return UnitOfMeasure(text, warming[1], float(warming[0]), difference=True)
    for written in _written(name):
        found = {}
        for meaning in meanings(written) or (written,):
            for powers in parse(meaning):
                for unit in _units(text, powers, strict=meaning != written):
                    found[dataclasses.replace(unit, cycles=False)] = unit
        if found:
            first, *others = found.values()
            return dataclasses.replace(first, also=tuple(others))
    return None


def _written(name: str) -> Iterator[str]:
    """Yield a text, and how it is written otherwise: without annotation, with signs for its words."""
    marked = None if doubt([name]) else annotated(name)
    if marked is None or meanings(name) or symbol(name):
        for each in dict.fromkeys((name, _PER.sub("/", name))):
            if " " in each:
                yield each.replace(" ", "_")  # "nautical mile"
            yield each
        yield name.removesuffix(".")
    elif not marked[1]:
        yield marked[0]


def _by_case(names: Iterable[str]) -> str:
    """Return the units that the first unknown name is in other capitals, as a sentence to append."""
    for name in names:
        if _sizes(name, strict=False) or len(name) > _SHORT:
            continue
        written = map("".join, itertools.product(*({x.lower(), x.upper()} for x in name)))
        known = sorted(each for each in written if _sizes(each, strict=False))
        if known:
            return f": capitals count, and {name} may be {' or '.join(known[:4])}"
    return ""


def _by_hyphen(text: str) -> str:
    """Return how a text is written whose hyphens may be products, as a sentence to append."""
    product = _HYPHEN.sub(".", text)
    return f": where '-' is a product write {product}" if product != text and by_text(product) else ""


def names_difference(text: str) -> bool:
    """Return True for the text of a unit of differences of temperatures, as delta_degC."""
    unit = by_text(text)
    return unit is not None and unit.difference


def _difference(name: str) -> Size | None:
    """Return the size of the unit of differences that a name stands for, without an offset; None for another.

    It is a unit of temperature behind `delta_`, as pint writes it, `delta ` or the letter: delta_degC, ΔK.
    """
    found = _DELTA.fullmatch(name) if len(name) <= LONGEST else None
    if found is None:
        return None
    absolute = by_text(found[1])
    for unit in absolute.readings if absolute else ():
        if unit.exponents == TEMPERATURE and not unit.difference:
            return Fraction(unit.factor).limit_denominator(1_000_000), TEMPERATURE, Fraction(0)
    return None


def as_named(unit: UnitOfMeasure) -> UnitOfMeasure:
    """Return an FMU's definition of a unit, with the angle that its name says and its exponents leave out.

    Many tools define rad/s as 1/s, rpm as 1/s times 2 pi/60 or 1/60, and Hz as 1/s: where the factor is that
    of the name, counting radians or cycles as 1, the name decides. A definition that is empty, as some tools
    write it for every unit, is none.
    """
    named = by_text(unit.name)
    if named is None or named.exponents is None or unit.exponents is None:
        return unit
    if not any(unit.exponents) and unit.factor == 1.0 and unit.offset == 0.0 and any(named.exponents):
        return named
    for reading in named.readings:
        if unit.exponents == reading.exponents and _alike(unit.factor, reading.factor):
            return dataclasses.replace(unit, cycles=reading.cycles, difference=reading.difference)
        if unit.exponents == _without_angle(reading.exponents) != reading.exponents:
            in_cycles = reading.factor / (2.0 * math.pi) ** float((reading.exponents or _NONE)[_RAD])
            if _alike(unit.factor, reading.factor) or _alike(unit.factor, in_cycles):
                return dataclasses.replace(reading, name=unit.name, also=())
    return unit


def contradiction(unit: UnitOfMeasure) -> str:
    """Return what an FMU's definition says against the name of its unit; "" where they agree.

    The definition holds; but "km/h" with the factor of m/s is more often a slip than meant.
    """
    named = by_text(unit.name)
    if named is None or named.exponents is None or unit.exponents is None or as_named(unit) is not unit:
        return ""
    own, usual = (f"{u.factor:.6g} [{u.dimension}]" for u in (unit, named))
    return f"[{unit.name}] is defined as {own}, and usually is {usual}"


def _without_angle(exponents: Exponents | None) -> Exponents | None:
    return None if exponents is None else (*exponents[:_RAD], 0, *exponents[_RAD + 1 :])


def _alike(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=_FITS)


def _units(text: str, powers: Powers, strict: bool) -> list[UnitOfMeasure]:
    """Return the units that one reading of a text may be; `strict` admits symbols alone."""
    if any(is_level(name) for name, _ in powers):
        return [UnitOfMeasure(text, logarithmic=True)]
    sizes = [_sizes(name, strict) for name, _ in powers]
    if math.prod(len(each) for each in sizes) > 64:
        return []
    units = [_product(text, powers, chosen) for chosen in itertools.product(*sizes)]
    return [unit for unit in units if unit is not None]


def _product(text: str, powers: Powers, sizes: tuple[Size, ...]) -> UnitOfMeasure | None:
    """Return the product of symbols with their exponents; None where no double holds its factor."""
    exact, factor, offset = Fraction(1), 1.0, Fraction(0)
    exponents: list[int | Fraction] = list(_NONE)
    try:
        for (_, power), (size, dimension, zero) in zip(powers, sizes, strict=True):
            if power.denominator == 1:
                exact *= size ** int(power)
            else:
                factor *= float(size) ** float(power)
            for i, e in enumerate(dimension):
                exponents[i] += power * e
            if len(powers) == 1 and power == 1:  # an offset has a meaning only where the unit stands alone
                offset = zero
        factor *= float(exact)
    except OverflowError:
        return None
    if not 0.0 < factor < math.inf:
        return None
    whole = tuple(int(e) if e == int(e) else e for e in exponents)
    alone = powers[0][0].casefold() if len(powers) == 1 and powers[0][1] == 1 else ""
    cycles = powers == _A_MINUTE or alone.endswith(("hz", "hertz"))
    if powers == _A_MINUTE:  # a frequency, and not the reciprocal of a time
        whole, factor = (0, 0, -1, 0, 0, 0, 0, 1), 2.0 * math.pi / 60.0
    return UnitOfMeasure(text, whole, factor, float(offset), cycles)


@functools.lru_cache(maxsize=4096)
def _sizes(name: str, strict: bool) -> tuple[Size, ...]:
    """Return what a name in a unit text may stand for."""
    if strict:
        known = symbol(name)
        return () if known is None else (known,)
    said = meanings(name)
    if said:
        units = [unit for meaning in said for powers in parse(meaning) for unit in _units(name, powers, True)]
        return tuple(
            (Fraction(u.factor), u.exponents, Fraction(u.offset)) for u in units if u.exponents is not None
        )
    known = symbol(name) or _difference(name)
    if known is None and (marked := annotated(name)) is not None and not (marked[1] or doubt([name])):
        return _sizes(marked[0], strict)
    return () if known is None else (known,)
