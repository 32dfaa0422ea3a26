"""Values of all types of FMI in machine code against those that ctypes has."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

from evcosim.master.engine.compiled.llvm_text import DOUBLE, Function
from evcosim.master.engine.compiled.straight_calls import _from_double, _in_memory, _to_double
from evcosim.master.engine.compiled.straight_making import IS_OPAQUE, linked_code
from evcosim.master.fmi.types import BOOLEAN, BUFFERS, REAL, FmiType
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")


def values_of(kind: FmiType) -> list[float]:
    """Numbers that the type holds."""
    if kind.kind is BOOLEAN:
        return [0.0, 1.0]
    if kind.kind is REAL:
        return [0.0, 0.1, -2.5, 1e30]
    return [float(kind.low), 0.0, 1.0, min(math.floor(kind.doubles[1]), 2.0**52)]


@pytest.mark.parametrize("kind", BUFFERS.values(), ids=lambda kind: f"{kind.name} of FMI {kind.versions}")
def test_a_number_comes_back_as_its_type_holds_it(kind: FmiType) -> None:
    f = Function("f", ["a"], IS_OPAQUE)
    size = ctypes.sizeof(kind.c_type)
    f.store(_in_memory(kind), _from_double(f, kind, f.load(DOUBLE, "%a", 0)), "%a", 1, align=size)
    f.store(DOUBLE, _to_double(f, kind, f.load(_in_memory(kind), "%a", 1, align=size)), "%a", 2)
    f.give(0)
    loaded = Loaded(linked_code(f.text(), "f") or b"")
    for value in values_of(kind):
        memory = np.array([value, math.nan, math.nan])
        ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(loaded.address)(memory.ctypes.data)
        held = kind.c_type.from_address(memory.ctypes.data + 8).value
        assert held == (
            value if kind.kind is REAL and size == 8 else kind.c_type(kind.kind.from_c(value)).value
        )
        assert memory[2] == held
