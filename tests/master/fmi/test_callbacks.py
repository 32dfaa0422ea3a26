"""The callback structures have the layout of FMPy's, and messages arrive with their arguments in place."""

from __future__ import annotations

import ctypes
from typing import Any

import fmpy.fmi1
import fmpy.fmi2
import pytest

from evcosim.master.fmi import fmi2
from evcosim.master.fmi.callbacks import (
    Callbacks2,
    CoSimulationCallbacks1,
    Logger,
    ModelExchangeCallbacks1,
    complete,
)


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (CoSimulationCallbacks1, fmpy.fmi1.fmi1CallbackFunctions),
        (Callbacks2, fmpy.fmi2.fmi2CallbackFunctions),
        (fmi2._EventInfo, fmpy.fmi2.fmi2EventInfo),
    ],
)
def test_a_structure_is_laid_out_as_fmpy_s(ours: Any, theirs: Any) -> None:
    def layout(kind: Any) -> list[tuple[str, int, int]]:
        fields = [(name, getattr(kind, name)) for name, _ in kind._fields_]
        return [("", ctypes.sizeof(kind), 0), *((name, at.offset, at.size) for name, at in fields)]

    assert layout(ours) == layout(theirs)


@pytest.mark.parametrize("kind", [Callbacks2, CoSimulationCallbacks1, ModelExchangeCallbacks1])
def test_a_complete_structure_has_memory_and_formats_messages(kind: Any) -> None:
    heard: list[bytes] = []
    logger = Logger(lambda environment, name, status, category, text: heard.append(text))
    callbacks = kind()
    complete(callbacks, logger)
    place = callbacks.allocateMemory(3, 8)
    assert bytes((ctypes.c_char * 24).from_address(place)) == bytes(24)
    callbacks.freeMemory(place)
    address = ctypes.cast(callbacks.logger, ctypes.c_void_p).value or 0
    variadic = ctypes.CFUNCTYPE(
        None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_int
    )(address)
    variadic(None, b"name", 0, b"category", b"x = %d", 7)
    assert heard == [b"x = 7"]
