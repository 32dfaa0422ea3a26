"""The folders that FMUs are extracted to: all units of an FMU in this process have one, and so one library.

Its code then stands in the processor's caches once, however many units there are. The library is unloaded and
the folder removed with the last of them.
"""

from __future__ import annotations

import dataclasses
import threading
from pathlib import Path

from ...cosim.errors import ShortageError
from ...cosim.leftovers import remove_folder
from .fmu import Fmu, FmuError, is_true


@dataclasses.dataclass
class _Folder:
    path: Path
    units: list[str] = dataclasses.field(default_factory=list)  # their names, which two systems may share


_folders: dict[str, _Folder] = {}
_lock = threading.Lock()


def take(fmu: Fmu, unit: str) -> Path:
    """Return the folder of an FMU for one more unit.

    Raises FmuError where it cannot be extracted, or can be instantiated once in a process and is;
    ShortageError naming the unit where there is no room for it.
    """
    with _lock:
        there = _folders.get(fmu.digest)
        if there is not None and is_true(fmu.kind, "canBeInstantiatedOnlyOncePerProcess"):
            raise FmuError(
                f"{fmu.path}: can be instantiated only once in a process "
                f"(canBeInstantiatedOnlyOncePerProcess), and unit '{there.units[0]}' is it already: unit "
                f"'{unit}' needs isolation = \"process\""
            )
        folder = there or _Folder(_extracted(fmu, unit))
        _folders[fmu.digest] = folder
        folder.units.append(unit)
        return folder.path


def _extracted(fmu: Fmu, unit: str) -> Path:
    try:
        return fmu.extract()
    except ShortageError as error:
        raise ShortageError(f"unit '{unit}': {error}") from error


def give_back(fmu: Fmu, unit: str) -> None:
    """Remove the folder if this was the last unit that needs it; the unit's library is closed."""
    with _lock:
        folder = _folders[fmu.digest]
        folder.units.remove(unit)
        if not folder.units:
            del _folders[fmu.digest]
            remove_folder(folder.path)
