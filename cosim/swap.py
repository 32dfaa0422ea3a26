"""The swap file: another FMU in the place of a unit's (TOML; docs/how-to/vehicle.md)."""

from __future__ import annotations

import dataclasses
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from .errors import ConfigError, nearest
from .files import read_toml
from .fit import Row
from .system import System, UnitEntry
from .writing import replacing


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


def written(path: Path, fmu: str, place: str, rows: Sequence[Row]) -> None:
    """Write a swap file from the rows of a check, with the reason beside each. Raises ConfigError."""
    lines = [
        f"# {Path(fmu).name} in the place of {place}; made by evcosim check, to be edited.",
        f"fmu = {json.dumps(os.path.relpath(fmu, path.parent or Path('.')))}",
        f'replaces = "{place}"',
    ]
    missing = [row.need for row in rows if row.verdict == "missing" and row.need]
    lines.append("# names of the system that the FMU does not have; what needs them is left out")
    lines.append(f"absent = {json.dumps(missing)}")
    for role in ("input", "output", "parameter"):
        lines += ["", f"[map.{role}s]"]
        lines += [line for row in rows if row.role == role for line in _line(row)]
    with replacing(path) as file:
        file.write(("\n".join(lines) + "\n").encode())


def _line(row: Row) -> list[str]:
    comment = f"# {row.reason}" + (f"; others: {', '.join(row.others)}" if row.others else "")
    if row.verdict == "unused":
        return [f"# {row.variable}: {row.reason}"]
    if not row.variable:
        return [f"# {row.need} = ?  {comment}"]
    name = row.need if re.fullmatch(r"[A-Za-z0-9_-]+", row.need) else json.dumps(row.need)
    if "declares no unit" in row.reason:
        unit = row.reason.rpartition("[")[2].rstrip("]")
        entry = f"{{ variable = {json.dumps(row.variable)}, unit = {json.dumps(unit)} }}"
        return [f"{name} = {entry}  {comment}: assumed"]
    return [f"{name} = {json.dumps(row.variable)}  {comment}"]
