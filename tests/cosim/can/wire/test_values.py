"""Rounding of the frame path; tests/master/engine/test_frame_path.py compares the whole way of a value."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.quantization import quantize
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.values import rounded

KINDS = {"nearest": T.NEAREST, "half_even": T.HALF_EVEN, "truncate": T.TRUNCATE}


@pytest.mark.parametrize("rounding", KINDS)
@given(q=st.one_of(st.floats(-(2.0**50), 2.0**50), st.integers(-100, 100).map(lambda n: n / 2)))
def test_rounding_is_that_of_the_channel(rounding, q):
    for x in (q, math.nextafter(q, math.inf), math.nextafter(q, -math.inf)):
        assert rounded(x, KINDS[rounding]) == quantize(Signal("S", 0, 64, signed=True), rounding, x)
