"""Units of measure in names of columns of CSV files, as `speed [km/h]`, `speed_kmh` or `speed in km/h`."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence

from ..csv_numbers import CsvFile
from ..errors import ConfigError
from ..units.definition import defined
from ..units.measure import Affine, DifferenceError, UnknownUnitError
from .unit_maps import End, unit_map

_IN_BRACKETS = re.compile(r"\[([^][]+)\]|\(([^()]+)\)|\{([^{}]+)\}|<([^<>]+)>")
_BEHIND = re.compile(r"[\s_/,;:|@=-]+")
_CAPITAL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_PER = re.compile(r"Per(?=[A-Z])")
_WORDS = ("in", "min", "at", "are", "set")  # of beginnings and of parts with capitals: minimum is no minute
_NO_UNITS = ("in",)  # behind a name it is the input, or the word; inches are [in]


def note_units(
    file: CsvFile, columns: Sequence[int], target: End, given: str | None, where: str
) -> list[str]:
    """Return the warnings of a stimulus whose columns' names say other units than those they are taken in.

    `columns` are those of the time and of the values, which are in `given`, else in the unit of their input,
    `target`. `where` can a unit of measure be given.
    """
    place = f"{file.path}: column "
    time, values = (file.names[j] for j in columns)
    found = []
    if said := _other_unit(time, End("the time", "s")):
        found.append(f"{place}'{time}': its values are taken in [s], the unit of the time, not [{said[0]}]")
    unit = target.unit if given is None else given
    if not unit.strip() or not (said := _other_unit(values, dataclasses.replace(target, unit=unit))):
        return found
    text, impossible = said
    if given is not None:
        found.append(
            f"{place}'{values}': its values are taken in [{given}], the `unit` of {where}, not [{text}]"
        )
        return found
    then = impossible or f'`unit = "{text}"` in {where} converts them'
    found.append(f"{place}'{values}': its values are taken in [{unit}], the unit of {target.name}; {then}")
    return found


def _other_unit(name: str, taken: End) -> tuple[str, str] | None:
    """Return the unit of the quantity of `taken` that a name says, where numbers in it are other ones.

    With it comes the reason why nothing converts them; "" where its conversion does.
    """
    for text in _texts(name):
        try:
            defined(text, taken.definitions)
            map_ = unit_map(dataclasses.replace(taken, unit=text), taken, (), "", [])
        except UnknownUnitError:
            continue
        except ConfigError as error:
            if isinstance(error.__cause__, DifferenceError):
                return text, str(error.__cause__)
            continue  # it is of another quantity
        return None if map_ == Affine() else (text, "")
    return None


def _texts(name: str) -> Iterator[str]:
    """Yield the parts of a name that may be a unit of measure: in brackets, then its ends, longest first.

    `_` between units divides them, where the text is no unit otherwise: `speed_km_h`. Then come beginnings
    (`kmh_speed`), and both in names that have capitals for spaces (`speedKmh`), of two letters at least.
    """
    for match in _IN_BRACKETS.finditer(name):
        inside = next(filter(None, match.groups())).strip()
        yield inside.removeprefix("in ")
    for begin in (0, *(match.end() for match in _BEHIND.finditer(name))):
        end = name[begin:].strip()
        if end and end not in _NO_UNITS and not end.isdigit():
            yield end
            if "_" in end:
                yield re.sub("_+per_+|_+", "/", end)
    yield from filter(_is_long, (name[: match.start()].strip() for match in _BEHIND.finditer(name)))
    for match in _CAPITAL.finditer(name):
        for part in (name[match.start() :], name[: match.start()]):
            if _is_long(part):
                yield from dict.fromkeys((part, part[0].lower() + part[1:], _PER.sub("/", part).lower()))


def _is_long(part: str) -> bool:
    """Return True for a part of a name that is more than a letter, and no word that is a unit too."""
    return len(part) > 1 and part.lower() not in _WORDS
