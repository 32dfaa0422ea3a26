"""The swap file: another FMU in the place of a unit's (TOML; docs/how-to/vehicle.md)."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path

from .errors import ConfigError, nearest
from .files import read_toml
from .system import System, UnitEntry


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
