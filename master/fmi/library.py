"""The shared library of an FMU: its C functions by name, without the argument lists of any FMI version.

Arguments must be ctypes objects, which ctypes then passes on as they are: that takes a third of the time of
functions with declared arguments. A function that the library lacks is missed only when it is looked up: real
FMUs leave out functions that the standard demands and nobody calls.
"""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from typing import Any

from . import binary
from .fmu import Fmu, FmuError


class Library:
    """A loaded library. `prefix` stands before every function's name (FMI 1.0).

    With `keeps_lock` Python's lock is kept over its calls: those into a pythonfmu FMU come back into this
    interpreter at once, and keeping the lock saves handing it over twice.
    Raises OSError with the loader's reason.
    """

    def __init__(self, path: Path, prefix: str = "", keeps_lock: bool = False) -> None:
        self.path, self.prefix = path, prefix
        before = os.getcwd()
        try:
            os.chdir(path.parent)  # some find the libraries that they need beside them by this alone
            if sys.platform == "win32":
                self._library: Any = ctypes.CDLL(str(path), winmode=0)
            else:
                self._library = (ctypes.PyDLL if keeps_lock else ctypes.CDLL)(str(path))
        finally:
            os.chdir(before)

    def function(self, name: str, result: Any = ctypes.c_int) -> Any:
        """Return a C function with a result of a ctypes type. Raises AttributeError for a missing one."""
        function = self._library[self.prefix + name]
        function.restype = result
        return function

    def has(self, name: str) -> bool:
        """Return True if the library has a function."""
        return hasattr(self._library, self.prefix + name)

    def close(self) -> None:
        """Unload the library."""
        handle = ctypes.c_void_p(self._library._handle)
        if sys.platform == "win32":
            ctypes.windll.kernel32.FreeLibrary(handle)
        else:
            ctypes.CDLL(None).dlclose(handle)


def load_library(fmu: Fmu, folder: Path, prefix: str) -> Library:
    """Load an FMU's library from the folder into which it was extracted.

    Raises FmuError naming the library and the reason.
    """
    path = folder / fmu.binary
    if reason := binary.problem(path):
        raise FmuError(f"{fmu.path}: its library cannot be loaded: {fmu.binary}: {reason}")
    try:
        return Library(path, prefix, keeps_lock=fmu.holds_python)
    except OSError as error:
        reason = str(error).replace(str(path), fmu.binary)
        raise FmuError(f"{fmu.path}: its library cannot be loaded: {reason}") from error
