"""Saving and restoring the state of a unit of FMI 2.0 or 3.0. No run needs it; a trial tests it.

The FMU's own declaration that it can is not looked at here: it is often wrong, in both directions.
"""

from __future__ import annotations

import ctypes
import itertools
from typing import TYPE_CHECKING

from ..unit import UnitError

if TYPE_CHECKING:
    from .instance import Instance

_NAMES = {"fmi2": "FMUstate", "fmi3": "FMUState"}


class States:
    """The states of a unit that were saved, by number."""

    def __init__(self, unit: Instance) -> None:
        self._unit = unit
        self._saved: dict[int, ctypes.c_void_p] = {}
        self._numbers = itertools.count(1)

    def save(self) -> int:
        """Save the state and return its number. Raises FmuError for a missing function, else UnitError."""
        saved, number = ctypes.c_void_p(), next(self._numbers)
        self._call("Get", ctypes.byref(saved))
        if not saved:
            raise UnitError(f"unit '{self._unit.name}': saved its state, but gives nothing for it")
        self._saved[number] = saved
        return number

    def restore(self, number: int) -> None:
        """Go back to a saved state. Raises as `save` does."""
        self._call("Set", self._saved[number])

    def free(self, number: int) -> None:
        """Forget a saved state. Raises as `save` does."""
        self._call("Free", ctypes.byref(self._saved.pop(number)))

    def _call(self, what: str, state: object) -> None:
        unit = self._unit
        if unit.fmi not in _NAMES:
            raise UnitError(f"unit '{unit.name}': FMI 1.0 has no functions that save a state")
        unit.call(f"{unit.fmi}{what}{_NAMES[unit.fmi]}", state)
