"""The frame path in machine code: the functions of `cosim.can.wire`, compiled as they stand.

They are Python that numba compiles, in modules that know nothing of it: copies of them, with compiled ones in
place of the functions that they call, become one C function of actions.
"""

# numba compiles functions without annotations, and has no types
# mypy: disable-error-code="no-untyped-def, no-untyped-call"

from __future__ import annotations

from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import carray, njit
from numpy.typing import NDArray

from ....cosim.can.protection import counters, profiles
from ....cosim.can.timing import draws, lengths
from ....cosim.can.wire import arbitration, faults, log, medium, payload, protect, tables, values
from ....cosim.can.wire.tables import Wire
from ...machine import access
from ...machine.access import call_3, pointer, word
from ..wire_tables import Arrays

MODULES: tuple[ModuleType, ...] = (
    draws, lengths, profiles, counters, payload, values, log, arbitration, protect, faults, medium,
)  # fmt: skip # by what they need
"""The modules whose functions are compiled."""
SOURCES: tuple[ModuleType, ...] = (*MODULES, tables, access)
SIGNATURE = "int32(int64, int64, int64, int64)"


def wire_table(arrays: Arrays, helper: int) -> NDArray[np.int64]:
    """Return address and shape of each table, in the order of `Wire`, shape (tables, 3).

    `helper` is the address of the function of Python that `ask` calls.
    """
    found = np.zeros((len(Wire._fields), 3), dtype=np.int64)
    for row, name in zip(found, Wire._fields, strict=True):
        if name == "helper":
            row[0] = helper
        else:
            row[: 1 + arrays[name].ndim] = (arrays[name].ctypes.data, *arrays[name].shape)
    return found


def function() -> Any:
    """Return the function action(address of a wire_table, what, i, k), to be compiled."""
    jitted: dict[str, Any] = {"ask": njit(forceinline=True, error_model="numpy")(_ask)}
    scopes = [{name: _constant(value) for name, value in vars(module).items()} for module in MODULES]
    for module, scope in zip(MODULES, scopes, strict=True):
        for name, value in vars(module).items():
            if isinstance(value, FunctionType) and value.__module__ == module.__name__ and name not in jitted:
                copy = FunctionType(value.__code__, scope, name)
                inline = "w" in value.__code__.co_varnames[:1]  # all tables, which no call should copy
                jitted[name] = njit(forceinline=inline, error_model="numpy")(copy)
    for scope in scopes:
        scope.update({name: made for name, made in jitted.items() if name in scope})
    return FunctionType(_action.__code__, {**globals(), "act": jitted["act"]}, "wire_action")


def _constant(value: Any) -> Any:
    """Return a name's value as numba compiles it fast: a table of numbers as an array."""
    return np.array(value, dtype=np.int64) if isinstance(value, tuple) and len(value) == 256 else value


@njit(forceinline=True, error_model="numpy")
def _ints(t, i):
    return carray(pointer(word(t, 3 * i)), (word(t, 3 * i + 1), word(t, 3 * i + 2)), np.int64)


@njit(forceinline=True, error_model="numpy")
def _reals(t, i):
    return carray(pointer(word(t, 3 * i)), (word(t, 3 * i + 1), word(t, 3 * i + 2)), np.float64)


@njit(forceinline=True, error_model="numpy")
def _row(t, i, kind):
    return carray(pointer(word(t, 3 * i)), (word(t, 3 * i + 1),), kind)


@njit(forceinline=True, error_model="numpy")
def _wire(t):
    """Return the tables at the addresses of a `wire_table`."""
    return Wire(
        _ints(t, 0), _ints(t, 1), _reals(t, 2), _ints(t, 3), _reals(t, 4),  # messages to maps
        _ints(t, 5), _ints(t, 6), _ints(t, 7), _ints(t, 8),  # base to faults
        _ints(t, 9), _ints(t, 10), _ints(t, 11), _ints(t, 12),  # rings to nodes
        _reals(t, 13), _ints(t, 14), _ints(t, 15),  # chances to log
        _row(t, 16, np.float64), _row(t, 17, np.float64),  # fallback and memory
        _row(t, 18, np.int64), _row(t, 19, np.int64), _row(t, 20, np.float64), _row(t, 21, np.int64),
        _row(t, 22, np.float32), _row(t, 23, np.int32), _row(t, 24, np.float64), _row(t, 25, np.int64),
        _row(t, 26, np.int64), word(t, 3 * 27),  # state and helper
    )  # fmt: skip # in the order of Wire


def _ask(w, what, i, k):
    return call_3(w.helper, what, i, k)


def _action(t, what, i, k):
    return act(_wire(t), what, i, k)  # type: ignore[name-defined] # noqa: F821 - see `function`
