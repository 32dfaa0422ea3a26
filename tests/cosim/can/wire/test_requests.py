"""Requests for frames; tests/master/engine/test_timed_frames.py compares them with an oracle."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.requests import wanted
from evcosim.cosim.can.wire.tables import Wire


def sent(kind: int, values: list[int], cycle: int = 0, interval: int = 0) -> list[int]:
    """The steps at which one message of one signal is sent; 0 is its inactive value."""
    tables = {name: np.zeros((2, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables["messages"][0, [T.SEND_TYPE, T.CYCLE, T.INTERVAL, T.SIGNALS]] = kind, cycle, interval, 1
    w = Wire(**tables)
    found = []
    for k, value in enumerate(values):
        w.signals[0, [T.LOW, T.HIGH]] = value & 0xFFFFFFFF, value >> 32
        if wanted(w, 0, k):
            found.append(k)
    return found


VALUES = [0, 0, 0, 5, 5, 6, 0, 0, 0, 0, 7, 7, 7]


@pytest.mark.parametrize(
    ("kind", "cycle", "interval", "steps"),
    [
        (T.ON_CHANGE, 0, 0, [0, 3, 5, 6, 10]),
        (T.ON_CHANGE, 0, 3, [0, 3, 6, 10]),  # the change at 5 waits, and goes with that at 6
        (T.ON_CHANGE, 0, 4, [0, 4, 8, 12]),  # that at 8 tells what was changed at 5, and back at 6
        (T.MIXED, 4, 0, [0, 3, 4, 5, 6, 8, 10, 12]),
        (T.MIXED, 4, 2, [0, 3, 5, 7, 9, 11]),  # the cycle goes on behind what delays one of its frames
        (T.IF_ACTIVE, 2, 0, [3, 5, 6, 10, 12]),  # at 6 it tells that it is no longer active
        (T.ON_WRITE, 0, 0, list(range(13))),
        (T.ON_WRITE, 0, 5, [0, 5, 10]),
    ],
)
def test_when_a_frame_is_sent(kind, cycle, interval, steps):
    assert sent(kind, VALUES, cycle, interval) == steps


def test_a_change_of_the_high_word_is_one_and_a_change_back_within_the_interval_too():
    assert sent(T.ON_CHANGE, [1, 1, 2, 1, 1, 1, 1], interval=4) == [0, 4]
    assert sent(T.ON_CHANGE, [1, 1, 1 | 1 << 32, 1 | 1 << 32]) == [0, 2]
    assert sent(T.IF_ACTIVE, [0, 1 << 32, 0], cycle=1) == [1, 2]
