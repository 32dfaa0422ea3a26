"""The kernel's own computations against those of the channel and of Python, one by one."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest

from evcosim.cosim.can.wire import tables as T
from evcosim.master.engine.compiled import kernel
from evcosim.master.machine import tables as L

HALVES = [0.5, 1.5, 2.5, 0.49999999999999994, 1e15 + 0.5, 2.0**50 - 0.5]  # raw values in doubles end at 2**50
RANDOM = [random.Random(1).uniform(-1e6, 1e6) for _ in range(200)]
VALUES = [sign * value for value in (0.0, 1.0, 0.3, 0.7, *HALVES, *RANDOM) for sign in (1.0, -1.0)]


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (T.NEAREST, lambda q: math.copysign(math.floor(Fraction(abs(q)) + Fraction(1, 2)), q)),
        (T.HALF_EVEN, round),
        (T.TRUNCATE, math.trunc),
        (T.FLOAT32, lambda q: float(np.float32(q))),
        (T.FLOAT64, lambda q: q),
    ],
    ids=["nearest", "half even", "truncate", "float32", "float64"],
)
def test_rounding(mode, expected):
    for value in VALUES:
        assert kernel.rounded(value, mode) == expected(value), value


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [2, 3, 4])
def test_a_number_that_is_not_finite_is_found_where_it_stands(value, place):
    memory = np.array([math.nan, math.inf, 1.0, -1.7976931348623157e308, 5e-324, math.nan])
    assert kernel.check(memory.ctypes.data, 2, 3) == L.DONE
    memory[place] = value
    assert kernel.check(memory.ctypes.data, 2, 3) == L.NOT_FINITE
    assert kernel.check(memory.ctypes.data, place, 0) == L.DONE
