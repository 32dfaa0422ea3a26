"""The swap file: another FMU in the place of a unit's (TOML; docs/how-to/vehicle.md)."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from ..errors import ConfigError, nearest
from ..reading import is_file
from ..system.kinds import kind_of
from ..system.system import MapEntry, MapTables, System, UnitEntry
from ..system.toml import read_toml
from ..visible import visible, visible_toml
from ..writing import write_text
from .matching import LIKENESS, Match, is_open
from .requirements import ROLES, Role

if TYPE_CHECKING:
    from tomlkit import TOMLDocument
    from tomlkit.items import Comment, InlineTable, Item, Table

_WRITTEN_APART = ("fmu", "absent", "open", "map", "parameters", "start")
"""The keys of a unit that have a place of their own in a swap file that is written."""


_ABOUT_OPEN = (
    "names of the system with no choice yet: guesses of a likeness below {:g} stand below as comments; take "
    "one, map another variable, or run with --allow-open, which leaves out what needs them"
)


class SwapFile(UnitEntry):
    """Another FMU in the place of a unit: the keys of `[units.NAME]`, instead of the system's."""

    replaces: str | None = Field(default=None, examples=["scooter.vehicle"])
    """The unit that it was written for, as `system.unit`; in the place of another one it is refused."""


def swapped(system: System, swaps: Mapping[str, str | Path]) -> System:
    """Return the system with the entries of the swap files in the place of the named units' entries.

    The FMU's path is relative to the swap file; period and offset stay the system's unless the file has them.
    Raises ConfigError naming the swap file.
    """
    units = dict(system.file.units)
    for unit, name in swaps.items():
        path = Path(name)
        if unit not in units:
            raise ConfigError(
                f"--swap {unit}={path}: there is no unit '{unit}' in system '{system.file.name}'"
                f"{nearest(unit, units)}: {', '.join(units)}"
            )
        _check_kind(path, unit, f"{system.file.name}.{unit}")
        units[unit] = _entry(read_toml(path, SwapFile), path, f"{system.file.name}.{unit}", units[unit])
    return dataclasses.replace(
        system,
        file=system.file.model_copy(update={"units": units}),
        swaps={**system.swaps, **{unit: Path(name) for unit, name in swaps.items()}},
    )


def _check_kind(path: Path, unit: str, place: str) -> None:
    """Raise ConfigError for a file or folder that is no swap file, with what is done with it."""
    if path.suffix.lower() == ".fmu" and path.is_file():
        raise ConfigError(
            f"--swap {unit}={path}: is an FMU, not a swap file; 'evcosim check {path} --as {place} --write "
            f"swap.toml' writes one for it, and --fmu {unit}={path} puts it in with its own names"
        )
    if said := kind_of(path, "swap file"):
        raise ConfigError(f"--swap {unit}={said}")


def _entry(file: SwapFile, path: Path, target: str, before: UnitEntry) -> UnitEntry:
    if file.replaces is not None and file.replaces != target:
        raise ConfigError(f"{path}: replaces = '{file.replaces}': it was not written for {target}")
    beside = path.parent / file.fmu
    fmu = str(beside.resolve()) if is_file(beside) else file.fmu
    given = {name: getattr(file, name) for name in UnitEntry.model_fields}
    for name in ("period", "offset"):
        if given[name] is None:
            given[name] = getattr(before, name)
    return UnitEntry(**{**given, "fmu": fmu})


def entry_of(fmu: str, matches: Sequence[Match], entry: UnitEntry | None = None) -> UnitEntry:
    """Return the entry of a unit with an FMU mapped as the matches say, the other keys as in `entry`."""
    tables: dict[str, dict[str, MapEntry]] = {}
    for match in matches:
        if match.need and match.variable and match.verdict != "missing":
            tables.setdefault(f"{match.role}s", {})[match.need] = MapEntry(
                variable=match.variable,
                unit=match.unit or None,
                invert=match.invert,
                factor=match.factor,
                offset=match.offset,
                convert=match.convert,
            )
    return (entry or UnitEntry(fmu=fmu)).model_copy(
        update={"fmu": fmu, "map": MapTables.model_validate(tables), "absent": _absent(matches), "open": []}
    )


def _absent(matches: Sequence[Match]) -> list[str]:
    return [m.need for m in matches if m.need and (m.verdict == "missing" or not m.variable)]


def open_names(matches: Sequence[Match], likeness: float = LIKENESS) -> list[str]:
    """Return the names of the system for which a swap file that is written has a commented guess only."""
    return [match.need for match in matches if is_open(match, likeness)]


@dataclasses.dataclass(frozen=True)
class Proposal:
    """Changes that a trial proposes for a swap file.

    `substeps` counts where it is more than 1; `invert` holds the variables ("inputs" or "outputs", name of
    the system) that need the other sign, each with its reason; `remarks` stand above the mapping.
    """

    substeps: int = 1
    why_substeps: str = ""
    invert: Mapping[tuple[str, str], str] = dataclasses.field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def write(
    path: Path,
    fmu: str,
    place: str,
    matches: Sequence[Match],
    entry: UnitEntry | None = None,
    proposal: Proposal | None = None,
    likeness: float = LIKENESS,
) -> None:
    """Write a swap file of matches, with the reason beside each; the other keys of `entry` are kept.

    Guesses of a lower `likeness` stand in it as comments, and their names as `open`. `place` is
    "system.unit". What a trial proposes stands in it, marked as proposed. Raises ConfigError when
    the file cannot be written.
    """
    from tomlkit import dumps

    relative = os.path.relpath(fmu, path.parent or Path("."))
    if re.search("[\ud800-\udfff]", relative):
        raise ConfigError(f"{fmu}: the bytes of this name are no UTF-8, so that no TOML file can hold it")
    document = _document(relative, place, matches, entry, proposal or Proposal(), likeness)
    write_text(path, visible_toml(dumps(document)))


def _document(
    fmu: str,
    place: str,
    matches: Sequence[Match],
    entry: UnitEntry | None,
    proposal: Proposal,
    likeness: float,
) -> TOMLDocument:
    import tomlkit

    document = tomlkit.document()
    about = f"{Path(fmu).name} in the place of {place}; made by evcosim check, to be edited."
    document.add(_comment(about))
    document.add("fmu", tomlkit.item(fmu))
    document.add("replaces", tomlkit.item(place))
    for name, item in _kept(entry, proposal).items():
        document.add(name, item)
    document.add(_comment("names of the system that the FMU does not have; what needs them is left out"))
    document.add("absent", tomlkit.item(_absent(matches)))
    if left := open_names(matches, likeness):
        document.add(_comment(_ABOUT_OPEN.format(likeness)))
        document.add("open", tomlkit.item(left))
    if proposal.remarks:
        document.add(tomlkit.nl())
    for remark in proposal.remarks:
        document.add(_comment(remark))
    tables = tomlkit.table(is_super_table=True)
    for role in ROLES:
        tables.add(f"{role}s", _map_table([m for m in matches if m.role == role], role, proposal, likeness))
    document.add("map", tables)
    for name in ("parameters", "start"):
        if values := getattr(entry, name, {}):
            document.add(name, tomlkit.item(values))
    return document


def _kept(entry: UnitEntry | None, proposal: Proposal) -> dict[str, Item]:
    """Return the plain keys that are not as usual, and the substeps that are proposed."""
    import tomlkit

    given = entry.model_dump(exclude_defaults=True, include=set(UnitEntry.model_fields)) if entry else {}
    kept = {name: tomlkit.item(value) for name, value in given.items() if name not in _WRITTEN_APART}
    if proposal.substeps > 1:
        kept["substeps"] = _commented(proposal.substeps, f"proposed: {proposal.why_substeps}")
    return kept


def _map_table(matches: Sequence[Match], role: Role, proposal: Proposal, likeness: float) -> Table:
    """Return the table `[map.ROLEs]`; what is missing, unused or open stands in it as a comment."""
    import tomlkit

    table = tomlkit.table()
    for match in matches:
        if not match.need:
            table.add(_comment(f"{match.variable}: {match.reason}"))
        elif not match.variable or match.verdict == "missing":
            others = f"; others: {', '.join(match.others)}" if match.others else ""
            name = tomlkit.key(match.need).as_string()
            table.add(_comment(f"{name} = ?  # {match.reason}{others}"))
        else:
            item = _mapped(match, proposal.invert.get((f"{role}s", match.need)))
            if is_open(match, likeness):
                name = tomlkit.key(match.need).as_string()
                table.add(
                    _comment(f"{name} = {item.as_string()}{item.trivia.comment_ws}{item.trivia.comment}")
                )
            else:
                table.add(match.need, item)
    return table


def _mapped(match: Match, proposed: str | None) -> Item:
    """Return the FMU's variable of a match with the reasons; `proposed` is the reason to turn its sign."""
    turned = proposed is not None
    scaled = any(x is not None for x in (match.factor, match.offset, match.convert))
    invert = not scaled and match.invert != turned
    assumed = match.unit and not match.reason.startswith("as mapped")
    reasons = [match.reason + (": assumed" if assumed else "")]
    reasons += [f"others: {', '.join(match.others)}"] if match.others else []
    new = "the other sign" if scaled else f"invert = {str(invert).lower()}"
    reasons += [f"proposed: {new}, since {proposed}"] if turned else []
    values: dict[str, object] = {"variable": match.variable}
    values |= {"unit": match.unit} if match.unit else {}
    values |= {"invert": True} if invert else {}
    values |= _scaling(match, -1.0 if turned else 1.0) if scaled else {}
    return _commented(match.variable if len(values) == 1 else _inline(values), "; ".join(reasons))


def _scaling(match: Match, sign: float) -> dict[str, object]:
    """Return the keys of a match's scaling, with `sign` to both numbers."""
    numbers = {"factor": 1.0 if match.factor is None else match.factor, "offset": match.offset or 0.0}
    given: dict[str, object] = {name: sign * x for name, x in numbers.items()} if sign < 0.0 else {}
    as_it_is = {"factor": match.factor, "offset": match.offset, "convert": match.convert}
    return {name: x for name, x in {**as_it_is, **given}.items() if x is not None}


def _inline(values: Mapping[str, object]) -> InlineTable:
    """Return a table on one line, with a space inside its braces."""
    import tomlkit

    table, items = tomlkit.inline_table(), [tomlkit.item(value) for value in values.values()]
    items[0].trivia.indent, items[-1].trivia.trail = " ", " "
    for name, item in zip(values, items, strict=True):
        table.add(name, item)
    return table


def _commented(value: object, text: str) -> Item:
    import tomlkit

    item = tomlkit.item(value)
    item.comment(_in_a_comment(text))
    item.trivia.comment_ws = "  "
    return item


def _comment(text: str) -> Comment:
    from tomlkit import comment

    return comment(_in_a_comment(text))


def _in_a_comment(text: str) -> str:
    """Return the text of a comment: a name of an FMU must not end its line."""
    return visible(text.replace("\n", " "))
