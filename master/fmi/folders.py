"""Where FMUs are extracted to: all units of an FMU in this process have one folder, and so one library.

Its code then stands in the processor's caches once, however many units there are. The library is unloaded and
the folder removed with the last of them.
"""

from __future__ import annotations

import dataclasses
import shutil
import threading
from pathlib import Path

from .fmu import Fmu


@dataclasses.dataclass
class _Folder:
    path: Path
    units: int = 0


_folders: dict[str, _Folder] = {}
_lock = threading.Lock()


def take(fmu: Fmu) -> Path:
    """The folder of an FMU for one more unit. Raises FmuError where it cannot be extracted."""
    with _lock:
        if fmu.digest not in _folders:
            _folders[fmu.digest] = _Folder(fmu.extract())
        folder = _folders[fmu.digest]
        folder.units += 1
        return folder.path


def give_back(fmu: Fmu) -> None:
    """A unit no longer needs the folder; its library is closed."""
    with _lock:
        folder = _folders[fmu.digest]
        folder.units -= 1
        if not folder.units:
            del _folders[fmu.digest]
            shutil.rmtree(folder.path, ignore_errors=True)
