"""The map of values between two ends of a connection, by their units of measure."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterable, Mapping

from ..can.database import Signal
from ..errors import ConfigError
from ..system.scaling import Scaling
from ..units.conversion import conversion
from ..units.definition import contradiction, defined
from ..units.measure import (
    TEMPERATURE,
    Affine,
    DifferentQuantityError,
    OpenUnitError,
    UnitOfMeasure,
    UnknownUnitError,
)
from ..units.spellings import says_none
from ..visible import visible_json

_FACTOR = ", or `factor` with `convert = false` in its [[connect]]"

Definitions = Mapping[str, UnitOfMeasure]


@dataclasses.dataclass(frozen=True)
class End:
    """One end of a connection: a variable, a bus signal or a stimulus.

    `definitions` are those of its own FMU; `difference` says that its values have no absolute zero; `bus` is
    the bus that a signal belongs to. `advice` is what to do where nobody knows what the end is in; "" for a
    variable of a unit, whose `map` can say it.
    """

    name: str
    unit: str
    definitions: Definitions = dataclasses.field(default_factory=dict)
    difference: bool = False
    bus: str = ""
    advice: str = ""

    @property
    def bare(self) -> bool:
        """True without a unit of measure."""
        return not self.unit.strip()

    @property
    def defines(self) -> bool:
        """True where its own FMU defines its unit of measure."""
        unit = self.definitions.get(self.unit)
        return unit is not None and unit.exponents is not None

    def __str__(self) -> str:
        return f"{self.name} [{self.unit}]"


def unit_map(
    source: End, target: End, others: Iterable[Definitions], place: str, warnings: list[str]
) -> Affine:
    """Return the map from the unit of `source` to that of `target`; the identity where one has none.

    Each FMU's own definition comes first, then the reading of the text, then the definitions of `others`.
    Adds to `warnings` where numbers are taken over unconverted. Raises ConfigError, which starts with
    `place`, when they measure different quantities, or it is open whether they do.
    """
    if source.bare or target.bare:
        _note_missing_unit(source, target, warnings)
        return Affine()
    try:
        if source.unit == target.unit and not (source.defines and target.defines):
            map_ = _of_one_text(source, target, others)
            _note_zeros(source, target, others, warnings)
            return map_
        a, b = (defined(end.unit, end.definitions, *others) for end in (source, target))
        map_ = conversion(a, b, (source.difference, target.difference))
    except UnknownUnitError as error:
        if _is_taken_as_one(source, target, others, warnings):
            return Affine()
        raise _refused(source, target, others, place, error) from error
    except ConfigError as error:
        raise _refused(source, target, others, place, error) from error
    _note_zeros(source, target, others, warnings)
    for end in (source, target):
        if end.defines and (said := contradiction(end.definitions[end.unit])):
            _note(warnings, f"{end.name}: its FMU's definition is taken: {said}")
        if says_none(end.unit) and end.unit.strip("[( )]") != "1":
            _note(warnings, f"{end} names no unit of measure; it is taken as [1]")
    return map_


def _note(warnings: list[str], text: str) -> None:
    """Add a warning, unless it is there: a bus signal has several ends."""
    if text not in warnings:
        warnings.append(text)


def scaled_map(
    source: End,
    target: End,
    scaling: Scaling,
    others: Iterable[Definitions],
    place: str,
    warnings: list[str],
) -> Affine:
    """Return the map between two ends with the factor and offset that a file writes for it.

    They stand between two different quantities; where the units of measure convert, or say nothing, only with
    `convert`, so that no factor hides a missing unit. Raises ConfigError, which starts with `place`,
    otherwise.
    """
    if scaling.convert is False:
        return scaling.linear
    if scaling.convert or not scaling.written:
        bare = source if source.bare else target
        if scaling.convert and bare.bare:
            raise ConfigError(
                f"{place}: convert = true: {bare.name} declares no unit of measure, so that nothing is "
                "converted; convert = false takes factor and offset in place of a conversion"
            )
        map_ = unit_map(source, target, others, place, warnings).then(scaling.linear)
        if not (map_.scale and math.isfinite(map_.scale) and math.isfinite(map_.offset)):
            raise ConfigError(f"{place}: {scaling.in_words}: no number holds it with the unit conversion")
        return map_
    if not _are_different(source, target, others):
        raise ConfigError(
            f"{place}: {scaling.in_words}: {source} and {target} are not known to measure different "
            "quantities; say `convert = true` (after the unit conversion) or `false` (in its place) beside it"
        )
    return scaling.linear


def converts(source: End, target: End, others: Iterable[Definitions]) -> bool:
    """Return True where the units of measure of two ends convert by themselves, or one has none."""
    try:
        unit_map(source, target, others, "", [])
    except ConfigError:
        return False
    return True


def _are_different(source: End, target: End, others: Iterable[Definitions]) -> bool:
    """Return True where both units are known and measure different quantities."""
    if source.bare or target.bare:
        return False
    try:
        a, b = (defined(end.unit, end.definitions, *others) for end in (source, target))
        conversion(a, b)
    except DifferentQuantityError:
        return True
    except ConfigError:
        pass
    return False


def _of_one_text(source: End, target: End, others: Iterable[Definitions]) -> Affine:
    """Return the map between two ends of which one defines the text of both, or none."""
    end = source if source.defines else target
    try:
        unit = defined(end.unit, end.definitions, *others)
    except UnknownUnitError:
        return Affine()
    return conversion(unit, unit, (source.difference, target.difference))


def _note_zeros(source: End, target: End, others: Iterable[Definitions], warnings: list[str]) -> None:
    """Warn of a difference of temperatures at one end and a temperature at the other, without an offset.

    With one (degC) they are refused: nobody knows which number is right. In K it is the same one, unless one
    of the two ends means something else.
    """
    if source.difference == target.difference:
        return
    try:
        units = [defined(end.unit, end.definitions, *others) for end in (source, target)]
    except ConfigError:  # a name that both ends have, and nobody knows
        return
    kinds = [end.difference or unit.difference for end, unit in zip((source, target), units, strict=True)]
    if units[0].exponents == TEMPERATURE and kinds[0] != kinds[1]:
        first, second = ("a difference" if each else "an absolute temperature" for each in kinds)
        said = f"{source} is {first} and {target} {second} (FMI: relativeQuantity)"
        _note(warnings, f"{said}: the number is taken as it is")


def _note_missing_unit(source: End, target: End, warnings: list[str]) -> None:
    """Add a warning of an end without a unit of measure, unless the other end measures nothing either."""
    bare, other = (source, target) if source.bare else (target, source)
    if other.unit.strip() not in ("", "1"):
        _note(warnings, f"{bare.name} declares no unit of measure; it is taken as [{other.unit}]")


def _is_taken_as_one(source: End, target: End, others: Iterable[Definitions], warnings: list[str]) -> bool:
    """Return True, with a warning, where one end has a text that is not known and the other the unit 1."""
    for unknown, end in ((source, target), (target, source)):
        try:
            if not defined(end.unit, end.definitions, *others).bare:
                continue
        except UnknownUnitError:
            continue
        _note(warnings, f"{unknown}: this unit of measure is not known; it is taken as [{end.unit}]")
        return True
    return False


def _refused(
    source: End, target: End, others: Iterable[Definitions], place: str, error: ConfigError
) -> ConfigError:
    """Return the error of two ends that do not convert, with what to do at an end where that would help."""
    ends = [end for end in (source, target) if _is_to_blame(end, others, error)]
    if not ends and isinstance(error, OpenUnitError):  # only both together are open
        ends = [source if source.bus or not target.bus else target]
    said = "".join(f"; {_advice(end, target if end is source else source, others)}" for end in ends)
    return ConfigError(f"{place}: {source} cannot feed {target}: {error}{said}")


def _is_to_blame(end: End, others: Iterable[Definitions], error: ConfigError) -> bool:
    """Return True where another text for the unit of measure of this end would help."""
    unit = _known(end, others)
    match error:
        case UnknownUnitError():
            return unit is None
        case OpenUnitError():
            return unit is not None and (len(unit.readings) > 1 or unit.plain_rate)
        case _:
            return bool(end.bus) and says_none(end.unit)


def _known(end: End, others: Iterable[Definitions]) -> UnitOfMeasure | None:
    """Return the unit of measure of an end; None where nobody knows it."""
    try:
        return defined(end.unit, end.definitions, *others)
    except UnknownUnitError:
        return None


def _advice(end: End, other: End, others: Iterable[Definitions]) -> str:
    """Return what to do where the unit of measure of an end is unknown or open."""
    own = _known(end, others)
    factor = _FACTOR if own is None or own.also else ""
    if end.bus:
        unit = _quoted(end.unit)
        known = _quoted("..." if _known(other, others) is None else other.unit)
        return f"say what it is in the system file, [buses.{end.bus}.units]: {unit} = {known}{factor}"
    return end.advice or f"say what {end.name} is in: `unit` in the unit's `map`{factor}"


def with_unit(signal: Signal, units: Mapping[str, str]) -> Signal:
    """Return the signal in the unit of measure that the system file gives its text."""
    unit = units.get(signal.unit)
    return signal if unit is None else dataclasses.replace(signal, unit=unit)


def check_texts(units: Mapping[str, str], texts: set[str], place: str) -> list[str]:
    """Return a warning for each text of a bus' `units` that its database has not.

    Raises ConfigError, which starts with `place`, for a unit of measure that is not known.
    """
    for text, unit in units.items():
        try:
            defined(unit)
        except UnknownUnitError as error:
            raise ConfigError(f"{place}: {_quoted(text)}: {error}") from error
    return [f"{place}: no signal has the unit of measure [{text}]" for text in units if text not in texts]


def _quoted(text: str) -> str:
    """Return a text as a TOML file can hold it, between double quotes."""
    return visible_json(json.dumps(text, ensure_ascii=False))
