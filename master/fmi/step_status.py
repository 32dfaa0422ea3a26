"""What a unit of FMI 1.0 or 2.0 says about a step that it did not do, beside the status."""

from __future__ import annotations

import ctypes
from typing import Any

from .library import Library

_DISCARD, _PENDING = 2, 5
_LAST_SUCCESSFUL_TIME, _TERMINATED = ctypes.c_int(2), ctypes.c_int(3)  # fmiStatusKind, fmi2StatusKind


def beside(status: int, fmi: str, library: Library, component: Any) -> str:
    """A clause that begins with ": " for Discard and Pending; "" where nothing is known."""
    if status == _PENDING:
        return ": it computes the step asynchronously, which is not supported"
    if status != _DISCARD:
        return ""
    known = []
    time, ending = ctypes.c_double(), ctypes.c_int()
    if _asked(library, f"{fmi}GetRealStatus", component, _LAST_SUCCESSFUL_TIME, time):
        known.append(f"it got to t = {time.value:g} s")
    if fmi == "fmi2" and _asked(library, "fmi2GetBooleanStatus", component, _TERMINATED, ending) and ending:
        known.append("it asks to terminate the simulation")
    return ": " + ", ".join(known) if known else ""


def _asked(library: Library, name: str, component: Any, kind: Any, answer: Any) -> bool:
    """Whether the unit answered; few do."""
    return library.has(name) and library.function(name)(component, kind, ctypes.byref(answer)) == 0
