"""The folders that FMUs are extracted to: all units of an FMU in this process have one, and so one library.

Its code then stands in the processor's caches once, however many units there are. The library is unloaded
with the last of them, and the folder removed, unless it is the one in the cache that a built-in FMU has.
"""

from __future__ import annotations

import dataclasses
import threading
from pathlib import Path

from ...cosim.errors import ShortageError
from ...cosim.leftovers import remove_folder
from ..builtin import unpacked
from .fmu import Fmu, FmuError, is_true


@dataclasses.dataclass
class _Folder:
    path: Path
    kept: bool
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
        folder = there or _folder(fmu, unit)
        _folders[fmu.digest] = folder
        folder.units.append(unit)
        return folder.path


def _folder(fmu: Fmu, unit: str) -> _Folder:
    if fmu.sha256 and (kept := unpacked(fmu.path, fmu.binary)) is not None:  # a file of the cache
        return _Folder(kept, kept=True)
    try:
        return _Folder(fmu.extract(), kept=False)
    except ShortageError as error:
        raise ShortageError(f"unit '{unit}': {error}") from error


def give_back(fmu: Fmu, unit: str) -> None:
    """Remove the folder if this was the last unit that needs it; the unit's library is closed."""
    with _lock:
        folder = _folders[fmu.digest]
        folder.units.remove(unit)
        if not folder.units:
            del _folders[fmu.digest]
            if not folder.kept:
                remove_folder(folder.path)
