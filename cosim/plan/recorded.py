"""The variables that are recorded, by patterns: each fits something, and something is left."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping, Sequence
from fnmatch import fnmatchcase

from ..errors import ConfigError, nearest
from ..interface import UnitInterface, fitting

_SHOWN = ("input", "output", "local")


@dataclasses.dataclass(frozen=True)
class Record:
    """Patterns of what is recorded, those that begin with `!` of what is left out, and where they stand.

    `place` is a file, or "" for the option of a run; `option` are those of the option that leave out beside
    the file's. The `changed` units are others than those that the file was written for, or are not there: a
    pattern of the file that leaves out may name a variable that they lack.
    """

    place: str
    patterns: Sequence[str]
    option: Sequence[str] = ()
    changed: Collection[str] = ()

    @property
    def start(self) -> str:
        """The beginning of a message about a pattern of the file."""
        return f"{self.place}: record" if self.place else "record"


def recorded_names(interfaces: Mapping[str, UnitInterface], record: Record) -> set[str]:
    """Return the names, unit.variable, that are recorded.

    Raises ConfigError for a pattern that fits no variable, and where patterns leave nothing.
    """
    names = {
        f"{unit}.{v.name}": v.causality
        for unit, interface in interfaces.items()
        for v in interface.variables.values()
        if v.causality in _SHOWN
    }
    taken = _taken(interfaces, record, names)
    left_out: set[str] = set()
    for pattern, start, changed in _exclusions(record):
        fits = fitting(pattern, names)
        if not fits and not any(fnmatchcase(unit, pattern.partition(".")[0]) for unit in changed):
            raise ConfigError(f"{start}: '!{pattern}' {_why_not(interfaces, pattern, names)}")
        left_out.update(fitting(pattern, taken))
        if taken and taken <= left_out:
            raise ConfigError(f"{start}: '!{pattern}' leaves nothing to record")
    return taken - left_out


def _taken(interfaces: Mapping[str, UnitInterface], record: Record, names: Mapping[str, str]) -> set[str]:
    """Return the names that fit a pattern without `!`.

    A pattern means inputs and outputs; a local variable is recorded where it is named in full.
    """
    public = [name for name, causality in names.items() if causality != "local"]
    wanted = [pattern for pattern in record.patterns if not pattern.startswith("!")]
    if record.patterns and not wanted:
        raise ConfigError(
            f"{record.start}: {', '.join(map(repr, record.patterns))}: nothing is left out of nothing; put "
            "'*' before, for all inputs and outputs"
        )
    taken: set[str] = set()
    for pattern in wanted:
        fits = {pattern} if pattern in names else set(fitting(pattern, public))
        if not fits and pattern != "*":
            raise ConfigError(f"{record.start}: '{pattern}' {_why_not(interfaces, pattern, names)}")
        taken |= fits
    return taken


def _exclusions(record: Record) -> list[tuple[str, str, Collection[str]]]:
    """Return the patterns that leave out, the beginning of a message, and the units that excuse each."""
    of_file = [(p[1:], record.start, record.changed) for p in record.patterns if p.startswith("!")]
    return [*of_file, *((p.removeprefix("!"), "record", ()) for p in record.option)]


def _why_not(interfaces: Mapping[str, UnitInterface], pattern: str, names: Collection[str]) -> str:
    """Return why a pattern fits nothing: why that variable is not recorded, or the nearest name."""
    unit, _, variable = pattern.partition(".")
    if unit in interfaces:
        found = interfaces[unit].variables.get(variable)
        if found is not None:
            return f"is of causality {found.causality}, not input, output or local"
        if variable in interfaces[unit].unusable:
            return interfaces[unit].unusable[variable]
    return f"fits no variable{nearest(pattern, [*names, *(f'{unit}.*' for unit in interfaces)])}"
