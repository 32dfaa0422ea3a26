"""The reason that a unit of FMI 1.0 or 2.0 gives for a step that it did not do, beside the status."""

from __future__ import annotations

import ctypes
from typing import Any

from .library import Library

_DISCARD, _PENDING = 2, 5
_LAST_SUCCESSFUL_TIME, _TERMINATED = ctypes.c_int(2), ctypes.c_int(3)  # fmiStatusKind, fmi2StatusKind


def beside(status: int, fmi: str, library: Library, component: Any) -> str:
    """Return a clause that begins with ": " for Discard and Pending; "" where nothing is known."""
    if status == _PENDING:
        return ": it computes the step asynchronously, which is not supported"
    if status != _DISCARD:
        return ""
    known = []
    time, ending = ctypes.c_double(), ctypes.c_int()
    if _answered(library, f"{fmi}GetRealStatus", component, _LAST_SUCCESSFUL_TIME, time):
        known.append(f"it got to t = {time.value:g} s")
    if (
        fmi == "fmi2"
        and _answered(library, "fmi2GetBooleanStatus", component, _TERMINATED, ending)
        and ending
    ):
        known.append("it asks to terminate the simulation")
    return ": " + ", ".join(known) if known else ""


def _answered(library: Library, name: str, component: Any, kind: Any, answer: Any) -> bool:
    """Call a function that writes `answer`, and return True if the unit did; few do."""
    return library.has(name) and library.function(name)(component, kind, ctypes.byref(answer)) == 0
