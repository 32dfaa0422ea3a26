"""Functions of a module as numba compiles them: what the python engine runs, in machine code."""

from __future__ import annotations

import types
from types import ModuleType
from typing import Any

import numba
import numpy as np


def in_machine_code(*modules: ModuleType) -> dict[str, Any]:
    """Return the functions of modules that know each other's, compiled, by name."""
    scope: dict[str, Any] = {}
    functions: dict[str, types.FunctionType] = {}
    for module in modules:
        for name, value in vars(module).items():
            if isinstance(value, types.FunctionType):
                functions[name] = value
            elif not name.startswith("__"):
                table = isinstance(value, tuple) and len(value) == 256
                scope[name] = np.array(value) if table else value
    for name, function in functions.items():
        scope[name] = numba.njit(types.FunctionType(function.__code__, scope, name))
    return {name: scope[name] for name in functions}
