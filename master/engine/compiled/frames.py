"""The frame path in machine code: the functions of `cosim.can.wire`, compiled as they stand.

They are Python that numba compiles, in modules that know nothing of it: copies of them, with compiled ones in
place of the functions that they call, become one C function of actions. Each is compiled once, for the types
that its annotations say.
"""

# numba compiles functions without annotations, and has no types
# mypy: disable-error-code="no-untyped-def, no-untyped-call"

from __future__ import annotations

import functools
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload

from ....cosim.can.protection import counters, profiles
from ....cosim.can.timing import draws, lengths
from ....cosim.can.wire import (
    arbitration,
    babble,
    buffers,
    faults,
    log,
    medium,
    off,
    payload,
    protect,
    requests,
    uses,
    values,
)
from ...machine.access import call_3
from .wire_types import BY_ANNOTATION, wire_at

MODULES: tuple[ModuleType, ...] = (
    draws, lengths, profiles, counters, payload, off, values, log, babble, buffers, arbitration, protect,
    faults, requests, uses, medium,
)  # fmt: skip # by what they need
"""The modules whose functions are compiled."""
SIGNATURE = "int32(int64, int64, int64, int64)"
_FLAGS = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_SMALL = 600  # bytes of Python's code: with more, compiling takes longer and a frame no less


def function() -> Any:
    """Return the function action(address of a wire_table, what, i, k), to be compiled."""
    return _action


def _action(t, what, i, k):
    return _act(wire_at(t), what, i, k)


def _act(w, what, i, k):
    """Stand for `medium.act`, compiled."""


@overload(_act)
def _compiled_act(w, what, i, k):
    # numba asks for it when `_action` is compiled, and not where the cache has that
    act = _compiled()
    return lambda w, what, i, k: act(w, what, i, k)


@functools.cache
def _compiled() -> Any:
    """Return the compiled `medium.act`: what it calls is compiled first."""
    ask = FunctionType(_ask.__code__, globals(), "ask")
    ask.__annotations__ = values.ask.__annotations__
    made: dict[str, Any] = {"ask": _jitted(ask)}
    scopes = {m.__name__: {name: _constant(v) for name, v in vars(m).items()} for m in MODULES}

    def compiled(original: Any) -> Any:
        if original.__name__ not in made:
            scope = scopes[original.__module__]
            for name in original.__code__.co_names:
                called = scope.get(name)
                if called is original:  # `log` reads an attribute `log`
                    continue
                if isinstance(called, FunctionType) and called.__module__ in scopes:
                    scope[name] = compiled(called)
            copy = FunctionType(original.__code__, scope, original.__name__)
            copy.__annotations__ = original.__annotations__
            made[original.__name__] = _jitted(copy)
        return made[original.__name__]

    return compiled(medium.act)


def _constant(value: Any) -> Any:
    """Return a name's value as numba compiles it fast: a table of numbers as an array."""
    return np.array(value, dtype=np.int64) if isinstance(value, tuple) and len(value) == 256 else value


def _jitted(function: FunctionType) -> Any:
    """Return a function compiled for the types of its annotations; a small one is part of its callers."""
    kinds = {name: BY_ANNOTATION[text] for name, text in function.__annotations__.items()}
    code = function.__code__
    signature = kinds["return"](*(kinds[name] for name in code.co_varnames[: code.co_argcount]))
    return njit(signature, forceinline=len(code.co_code) < _SMALL, **_FLAGS)(function)


def _ask(w, what, i, k):
    return call_3(w.helper, what, i, k)
