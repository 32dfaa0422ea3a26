"""The decision for or against a process of its own for a unit."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from ...cosim.errors import ConfigError
from ...cosim.system.system import Isolation, System, UnitEntry
from ...cosim.system.toml import is_built_in
from ..builtin import is_ours
from ..fmi.fmu import Fmu
from .process import ProcessLimits


def decided(fmu: Fmu, entry: UnitEntry, wanted: Isolation | None) -> Isolation:
    """Return the isolation wanted for all units or for this one; else "none" for our FMUs alone:
    the built-in ones, and those that this user built with `build_model`.
    """
    asked = wanted or entry.isolation
    return asked or ("none" if is_ours(fmu.description.modelName, fmu.path, fmu.digest) else "process")


def chosen(name: str, fmu: Fmu, entry: UnitEntry, wanted: Isolation | None) -> Isolation:
    """Return what `decided` does.

    Raises ConfigError for "process" on a system that has none: nobody else's code comes into this process
    unasked.
    """
    asked = wanted or entry.isolation
    found = decided(fmu, entry, wanted)
    if found == "process" and not available():
        why = 'isolation = "process"' if asked else f"evcosim did not build {fmu.path.name}"
        raise ConfigError(
            f"unit '{name}': {why}, and on this system no unit can be put into a process of its own; with "
            "--isolation none it runs in the process of evcosim, which then ends with it"
        )
    return found


def check_trusted(system: System, fmus: Mapping[str, Fmu], wanted: Isolation | None, trust: bool) -> None:
    """Raise ConfigError for a file that lets an FMU that evcosim did not build into this process.

    A file that somebody else wrote cannot give that right to an FMU: `trust` does, or what is `wanted` for
    all units. What evcosim brings is trusted.
    """
    if wanted is not None or trust:
        return
    for unit, fmu in fmus.items():
        if needs_trust(fmu, system.file.units[unit], system.swaps.get(unit, system.path)):
            raise ConfigError(
                f'{system.keys_of(unit)}isolation = "none": {fmu.path} is not an FMU that evcosim built, and '
                "would run in the process of evcosim; if you trust it, --trust (trust=True) lets it; without "
                "this key it has a process of its own"
            )


def needs_trust(fmu: Fmu, entry: UnitEntry, file: Path) -> bool:
    """Return True for a unit that a file alone puts into this process, although evcosim did not build it.

    `file` is the system or swap file of the entry.
    """
    if entry.isolation != "none" or is_built_in(file):
        return False
    return decided(fmu, entry.model_copy(update={"isolation": None}), None) == "process"


def available() -> bool:
    """Return True on a system where units can have processes: not on Windows."""
    return os.name == "posix"


def process_limits(entry: UnitEntry) -> ProcessLimits:
    """Return the limits of a unit's process from its entry in the system file."""
    return ProcessLimits(entry.memory_limit, entry.file_limit, entry.load_timeout, entry.step_timeout)
