"""The reason that a unit of FMI 1.0 or 2.0 gives for a step that it did not do, beside the status."""

from __future__ import annotations

import ctypes
import math
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
    reached = _last_time(fmi, library, component)
    return "" if reached is None else f": it got to t = {reached:g} s"


def asked_end(status: int, library: Library, component: Any) -> float | None:
    """Return the time [s] to which a unit of FMI 2.0 got that asks to end the simulation; NaN: unknown.

    None for any other status than Discard, and for a step that it could not do.
    """
    ending = ctypes.c_int()
    if status != _DISCARD or not _answered(library, "fmi2GetBooleanStatus", component, _TERMINATED, ending):
        return None
    if not ending:
        return None
    reached = _last_time("fmi2", library, component)
    return math.nan if reached is None else reached


def _last_time(fmi: str, library: Library, component: Any) -> float | None:
    time = ctypes.c_double()
    known = _answered(library, f"{fmi}GetRealStatus", component, _LAST_SUCCESSFUL_TIME, time)
    return time.value if known else None


def _answered(library: Library, name: str, component: Any, kind: Any, answer: Any) -> bool:
    """Call a function that writes `answer`, and return True if the unit did; few do."""
    return library.has(name) and library.function(name)(component, kind, ctypes.byref(answer)) == 0
