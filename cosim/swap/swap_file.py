"""The swap file: another FMU in the place of a unit's (TOML; docs/how-to/vehicle.md)."""

from __future__ import annotations

import dataclasses
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import ConfigError, nearest
from ..system.system import MapEntry, MapTables, System, UnitEntry
from ..system.toml import read_toml
from ..writing import replacing
from .matching import Row


class SwapFile(UnitEntry):
    """What stands in a swap file: a unit's entry, and in `replaces` the "system.unit" it was written for."""

    replaces: str | None = None


def swapped(system: System, swaps: Mapping[str, str | Path]) -> System:
    """The system with the swap files in the place of the named units' entries.

    The FMU's path is relative to the swap file; the period stays the system's unless the file has one.
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
        units[unit] = _entry(read_toml(path, SwapFile), path, f"{system.file.name}.{unit}", units[unit])
    return dataclasses.replace(system, file=system.file.model_copy(update={"units": units}))


def _entry(file: SwapFile, path: Path, target: str, before: UnitEntry) -> UnitEntry:
    if file.replaces is not None and file.replaces != target:
        raise ConfigError(f"{path}: replaces = '{file.replaces}': it was not written for {target}")
    beside = path.parent / file.fmu
    fmu = str(beside.resolve()) if beside.is_file() else file.fmu
    period = before.period if file.period is None else file.period
    given = {name: getattr(file, name) for name in UnitEntry.model_fields}
    return UnitEntry(**{**given, "fmu": fmu, "period": period})


@dataclasses.dataclass(frozen=True)
class Proposal:
    """What a trial proposes for a swap file: `substeps` where it is more than 1, the sign of the variables
    ("inputs" or "outputs", name of the system) in `invert`, each with its reason, and `remarks` above them.
    """

    substeps: int = 1
    why_substeps: str = ""
    invert: Mapping[tuple[str, str], str] = dataclasses.field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def entry_of(fmu: str, rows: Sequence[Row], entry: UnitEntry | None = None) -> UnitEntry:
    """The entry of a unit with an FMU mapped as the rows of a check say, the rest as in `entry`."""
    tables: dict[str, dict[str, MapEntry]] = {}
    for row in rows:
        if row.need and row.variable and row.verdict != "missing":
            mapped = MapEntry(variable=row.variable, unit=row.unit or None, invert=row.invert)
            tables.setdefault(f"{row.role}s", {})[row.need] = mapped
    return (entry or UnitEntry(fmu=fmu)).model_copy(
        update={"fmu": fmu, "map": MapTables.model_validate(tables), "absent": _absent(rows)}
    )


def _absent(rows: Sequence[Row]) -> list[str]:
    return [row.need for row in rows if row.need and (row.verdict == "missing" or not row.variable)]


def written(
    path: Path,
    fmu: str,
    place: str,
    rows: Sequence[Row],
    entry: UnitEntry | None = None,
    proposal: Proposal | None = None,
) -> None:
    """Write a swap file from the rows of a check, with the reason beside each; `entry`'s other keys are kept.

    What a trial proposes stands in it, marked as proposed. Raises ConfigError.
    """
    proposal = proposal or Proposal()
    lines = [
        _comment(f"{Path(fmu).name} in the place of {place}; made by evcosim check, to be edited."),
        f"fmu = {_value(os.path.relpath(fmu, path.parent or Path('.')))}",
        f"replaces = {_value(place)}",
        *_kept(entry, proposal),
        "# names of the system that the FMU does not have; what needs them is left out",
        f"absent = {_value(_absent(rows))}",
        *([""] if proposal.remarks else []),
        *map(_comment, proposal.remarks),
    ]
    for role in ("input", "output", "parameter"):
        lines += ["", f"[map.{role}s]"]
        lines += [_line(row, proposal) for row in rows if row.role == role]
    for table in ("parameters", "start"):
        values = getattr(entry, table, {})
        lines += (
            ["", f"[{table}]", *(f"{_key(n)} = {_value(x)}" for n, x in values.items())] if values else []
        )
    with replacing(path) as file:
        file.write(("\n".join(lines) + "\n").encode())


def _kept(entry: UnitEntry | None, proposal: Proposal) -> list[str]:
    """The lines of the plain keys that are not as usual, and of the substeps that are proposed."""
    given = entry.model_dump(exclude_defaults=True) if entry else {}
    names = ("period", "substeps", "isolation", "step_timeout", "strict")
    values = {name: given[name] for name in names if given.get(name) is not None}
    comment = ""
    if proposal.substeps > 1:
        values["substeps"] = proposal.substeps
        comment = "  " + _comment(f"proposed: {proposal.why_substeps}")
    return [f"{n} = {_value(x)}{comment if n == 'substeps' else ''}" for n, x in values.items()]


def _line(row: Row, proposal: Proposal) -> str:
    if not row.need:
        return _comment(f"{row.variable}: {row.reason}")
    name = _key(row.need)
    if not row.variable or row.verdict == "missing":
        also = f"; others: {', '.join(row.others)}" if row.others else ""
        return _comment(f"{name} = ?  # {row.reason}{also}")
    proposed = proposal.invert.get((f"{row.role}s", row.need))
    invert = row.invert != (proposed is not None)
    reasons = [row.reason + (": assumed" if row.unit and not row.reason.startswith("as mapped") else "")]
    reasons += [f"others: {', '.join(row.others)}"] if row.others else []
    reasons += [f"proposed: invert = {str(invert).lower()}, since {proposed}"] if proposed else []
    parts = [f"variable = {_value(row.variable)}"]
    parts += [f"unit = {_value(row.unit)}"] if row.unit else []
    parts += ["invert = true"] if invert else []
    mapped = _value(row.variable) if len(parts) == 1 else f"{{ {', '.join(parts)} }}"
    return f"{name} = {mapped}  {_comment('; '.join(reasons))}"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _value(name)


def _value(value: object) -> str:
    """A value as TOML writes it: as JSON does, but for the characters that it has no room for."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _comment(text: str) -> str:
    """A comment on one line: what an FMU says must not end it."""
    return "# " + "".join(c if c.isprintable() else " " for c in text)
