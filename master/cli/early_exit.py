"""exit() called by an FMU in this process: the command ends with an error, and the rows of its run are kept.

Else the process would end with the code that the FMU chose, 0 among them, as if all were done. C's exit() and
quick_exit() call a function that is registered here, while Python still runs; Python's own exits (`os._exit`
in a model) come to the same one. _exit() of machine code ends the process before anybody is asked: then the
rows that were saved stay, as after SIGKILL, and run.json says "running".
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import os
import sys
from typing import Any

from ...cosim.shortage import memory_left, no_memory
from ..fmi import crash
from . import interrupts
from .failures import FAILED

_LITTLE = 100e6  # bytes of memory
_ADVICE = "run again with --isolation process, and the run says which step it was"


class _Guard:
    """The function that is registered for every exit of this process, until `leave`."""

    def __init__(self) -> None:
        self._process = os.getpid()
        self._handle = ctypes.c_char(b"\0")  # its address names the registrations
        self._function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._exited)
        self._library = ctypes.CDLL(None)
        self._exit = os._exit

    def install(self) -> None:
        handle = ctypes.c_void_p(ctypes.addressof(self._handle))
        self._library["__cxa_atexit"](self._function, None, handle)
        self._library["__cxa_at_quick_exit"](self._function, handle)
        atexit.register(self._exited, None)
        os._exit = self._exit_of_python  # type: ignore[assignment] # it does not return either

    def leave(self) -> None:
        os._exit = self._exit
        atexit.unregister(self._exited)
        self._process = 0  # what is registered is called now, and forgotten
        self._library["__cxa_finalize"](ctypes.c_void_p(ctypes.addressof(self._handle)))

    def _exit_of_python(self, code: int) -> None:
        self._exited(None)
        self._exit(code)

    def _exited(self, _: Any) -> None:
        if os.getpid() != self._process:  # the end of the command, or a copy of this process that an FMU made
            return
        unit = last_unit()
        who = f"unit {unit}" if unit else "an FMU"
        error = f"{who} ended the process of evcosim: it called exit(); {_ADVICE}"
        if not unit and memory_left() < _LITTLE:
            error = f"a library ended the process of evcosim, as some do without memory: {no_memory()}"
        interrupts.end_failed(error, FAILED)


def last_unit() -> str:
    """Return the unit that was called last, with its file; "" where that is not known."""
    report = crash.report()
    return report.last() if report is not None else ""


_guard: _Guard | None = None


def install() -> None:
    """Guard this process, which is the command's own, where the system has the functions for it (Linux)."""
    global _guard
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):  # another C library
            _guard = _Guard()
            _guard.install()


def leave() -> None:
    """End the guard: the command has done all."""
    if _guard is not None:
        _guard.leave()
