"""Values of FMI types in memory: what machine code writes and reads is what ctypes writes and reads."""

from __future__ import annotations

import ctypes
import math
from typing import Any

import numpy as np
import pytest
from numba import njit

from evcosim.master.fmi.types import BOOLEAN, BUFFERS, REAL
from evcosim.master.machine.access import put_value, size_of, value_at


@njit
def put(address: int, code: int, value: float) -> Any:
    return put_value(address, code, value)


@njit
def get(address: int, code: int) -> Any:
    return value_at(address, code), size_of(code)


@pytest.mark.parametrize("code", BUFFERS)
def test_a_value_in_memory_is_that_of_ctypes(code: int) -> None:
    kind = BUFFERS[code]
    low, high = kind.doubles
    numbers = [x for x in (low, high, -7.0, -1.5, 0.0, -0.0, 0.3, 1.0, 100.75) if low <= x <= high]
    make = {REAL: float, BOOLEAN: lambda x: x != 0.0}.get(kind.kind, int)
    buffer, expected = (kind.c_type * 3)(), (kind.c_type * 3)()
    for number in numbers:
        expected[1] = make(number)
        place = ctypes.addressof(buffer) + ctypes.sizeof(kind.c_type)
        assert put(place, code, number) == ctypes.sizeof(kind.c_type)
        assert bytes(buffer) == bytes(expected), number
        assert get(place, code) == (float(expected[1]), ctypes.sizeof(kind.c_type))


@pytest.mark.parametrize("code", [code for code, kind in BUFFERS.items() if kind.kind is REAL])
def test_no_number_of_a_float_is_refused_by_its_code(code: int) -> None:
    kind = BUFFERS[code]
    buffer = kind.c_type()
    put(ctypes.addressof(buffer), code, math.nan)
    assert math.isnan(get(ctypes.addressof(buffer), code)[0])


@pytest.mark.parametrize("code", [code for code, kind in BUFFERS.items() if kind.kind is BOOLEAN])
def test_any_number_but_0_is_true(code: int) -> None:
    buffer = (ctypes.c_int8 * 8)(*[0] * 8)
    for number, truth in ((math.nan, 1.0), (-3.0, 1.0), (5e-324, 1.0), (0.0, 0.0), (-0.0, 0.0)):
        put(ctypes.addressof(buffer), code, number)
        assert get(ctypes.addressof(buffer), code)[0] == truth
    buffer[0] = -2  # an FMU may take any number for true
    assert np.isclose(get(ctypes.addressof(buffer), code)[0], 1.0)
