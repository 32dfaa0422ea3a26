"""Whether a unit gets a process of its own."""

from __future__ import annotations

import os

from ...cosim.errors import ConfigError
from ...cosim.system.system import Isolation, UnitEntry
from ..builtin import is_builtin
from ..fmi.fmu import Fmu
from .process import ProcessLimits


def chosen(name: str, fmu: Fmu, entry: UnitEntry, wanted: Isolation | None) -> Isolation:
    """What is asked for, for all units or for this one; else processes for FMUs that evcosim did not build.

    Raises ConfigError where that is a process and the system has none: nobody else's code comes into this
    process unasked.
    """
    asked = wanted or entry.isolation
    found = asked or ("none" if is_builtin(fmu.description.modelName, fmu.path) else "process")
    if found == "process" and not available():
        why = 'isolation = "process"' if asked else f"evcosim did not build {fmu.path.name}"
        raise ConfigError(
            f"unit '{name}': {why}, and on this system no unit can be put into a process of its own; with "
            '--isolation none (isolation = "none") it runs in the process of evcosim, which then ends with it'
        )
    return found


def available() -> bool:
    """Whether this system has what processes of units need: Windows has not."""
    return os.name == "posix"


def process_limits(entry: UnitEntry) -> ProcessLimits:
    """The limits of a unit's process."""
    return ProcessLimits(entry.memory_limit, entry.file_limit, entry.load_timeout, entry.step_timeout)
