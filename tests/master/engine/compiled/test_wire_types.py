"""The tables of frames as machine code reads them; test_frame_path.py has what is done with them."""

from __future__ import annotations

import numpy as np
import pytest
from numba import cfunc, types

from evcosim.master.engine.compiled.addresses import wire_table
from evcosim.master.engine.compiled.wire_types import TABLES, wire_at
from evcosim.master.engine.wire_tables import wire_arrays


@cfunc("float64(int64, int64, int64)", error_model="numpy")
def moved(address, i, j):
    """Read and write tables of both shapes and all kinds of numbers; return what was read."""
    w = wire_at(address)
    found = w.reals[i, j] + w.single[0] + len(w.log)
    w.signals[i, j] = w.single_bits[0]
    w.signals[i, j] += i > 0
    w.memory[j] = w.signals[i, j]
    m = w.messages
    m[i, j] = m[i, j + 1] = 7
    return found


def test_tables_are_read_and_written_where_arrays_have_their_numbers():
    arrays = wire_arrays([], np.zeros(9), 0.01, logs=False)
    for name in ("reals", "signals", "messages"):
        arrays[name] = np.zeros((4, 9), dtype=arrays[name].dtype)
    arrays["reals"][2, 5], arrays["single"][0] = 1.25, 0.5
    table = wire_table(arrays, 0)
    assert moved.ctypes(table.ctypes.data, 2, 5) == 1.25 + 0.5 + len(arrays["log"])
    expected = np.zeros((4, 9), dtype=np.int64)
    expected[2, 5] = arrays["single_bits"][0] + 1
    assert np.array_equal(arrays["signals"], expected)
    assert arrays["memory"].tolist() == [0.0] * 5 + [float(expected[2, 5])] + [0.0] * 3
    assert np.flatnonzero(arrays["messages"]).tolist() == [2 * 9 + 5, 2 * 9 + 6]


@pytest.mark.parametrize("name", TABLES)
def test_the_types_are_those_of_the_arrays(name):
    arrays = wire_arrays([], np.zeros(9), 0.01, logs=False)
    assert str(arrays[name].dtype) == str(TABLES[name].kind)
    assert set(arrays) == set(TABLES)
    assert isinstance(TABLES[name], types.Type)
