"""The callback structures of FMI 1.0 and 2.0, and the C functions that stand in them.

They are FMPy's but for the import of FMPy, which takes a tenth of a short run. One part of FMPy is used: the
library that formats messages, whose number of arguments varies, before they come to Python.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.util
import os
import sys
from pathlib import Path
from typing import Any

from .binary import SUFFIX, folder_of_libraries

Logger = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)
"""Component or its environment, name of the instance, status, category, message."""
AllocateMemory = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
FreeMemory = ctypes.CFUNCTYPE(None, ctypes.c_void_p)

_COMMON = [("logger", Logger), ("allocateMemory", AllocateMemory), ("freeMemory", FreeMemory)]


class ModelExchangeCallbacks1(ctypes.Structure):
    """The callback structure of FMI 1.0 Model Exchange."""

    _fields_ = _COMMON


class CoSimulationCallbacks1(ctypes.Structure):
    """The callback structure of FMI 1.0 Co-Simulation."""

    _fields_ = [*_COMMON, ("stepFinished", ctypes.c_void_p)]


class Callbacks2(ctypes.Structure):
    """The callback structure of FMI 2.0."""

    _fields_ = [*_COMMON, ("stepFinished", ctypes.c_void_p), ("componentEnvironment", ctypes.c_void_p)]


def complete(callbacks: Any, logger: Any) -> None:
    """Fill in a callback structure; `logger` receives messages that are formatted.

    The library that formats them remembers one logger for the whole process. Raises OSError without it.
    """
    callbacks.logger = logger
    callbacks.allocateMemory, callbacks.freeMemory = _memory()
    _formatting()(ctypes.byref(callbacks))


@functools.cache
def _memory() -> tuple[Any, Any]:
    """Return calloc and free of the C library."""
    library = ctypes.cdll.msvcrt if sys.platform == "win32" else ctypes.CDLL(None)
    return ctypes.cast(library.calloc, AllocateMemory), ctypes.cast(library.free, FreeMemory)


@functools.cache
def _formatting() -> Any:
    """Return the function that puts itself before the logger of a callback structure."""
    found = importlib.util.find_spec("fmpy")  # which is not imported by it
    if found is None or found.origin is None:
        raise ModuleNotFoundError("fmpy is not installed: pip install fmpy", name="fmpy")
    folder = Path(found.origin).parent / "logging"
    function = ctypes.CDLL(os.fspath(folder / folder_of_libraries("2.0") / f"logging{SUFFIX}")).addLoggerProxy
    function.argtypes, function.restype = [ctypes.c_void_p], None
    return function
