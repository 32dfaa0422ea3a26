"""Frames under way, with a clock of 1 s steps and messages without signals."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.wire import medium
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def wire(delay: int, rows: int) -> Wire:
    """One message, of one byte, on a bus with a delay [ps], with a ring of so many rows."""
    tables = {name: np.zeros((8, 80), dtype=np.int64) for name in Wire._fields}
    tables |= {name: np.zeros(80, dtype=np.int64) for name in ("frame", "state")}
    tables["messages"][0, [T.LENGTH, T.RING]] = 1, 0 if rows else -1
    tables["rings"][0, T.ROWS] = rows
    tables["buses"][0, T.DELAY] = delay
    tables["state"][T.STEP_TIME] = 10**12
    return Wire(**tables)


def test_a_frame_arrives_after_the_delay():
    w = wire(2 * 10**12, rows=3)
    for k in range(4):
        w.base[0, 0] = k
        assert medium.act(w, T.ARRIVE, 0, k) == T.DONE
        assert w.messages[0, T.ARRIVED] == max(0, k - 1)
        assert medium.act(w, T.SEND, 0, k) == T.DONE
    assert w.rings[0, T.COUNT] == 2
    assert w.messages[0, [T.SENT, T.LATENCY_LEAST, T.LATENCY_MOST, T.SEEN_SUM]].tolist() == [
        4, 2 * 10**12, 2 * 10**12, 4 * 10**12,
    ]  # fmt: skip # one row


def test_without_a_ring_it_arrives_at_once_and_is_logged():
    w = wire(0, rows=0)
    w.messages[0, T.LOGGED] = 1
    w.base[0, 0] = 255
    assert medium.send(w, 0, 3) == T.DONE
    assert w.messages[0, T.ARRIVED] == 1
    assert w.log[0, [T.LOG_STEP, T.LOG_TIME, T.LOG_PAYLOAD]].tolist() == [3, 3 * 10**12, 255]


def test_a_payload_of_eight_bytes_is_one_word_of_the_log():
    w = wire(0, rows=0)
    w.messages[0, [T.LOGGED, T.LENGTH]] = 1, 8
    w.base[0, :8] = range(249, 257)
    w.base[0, 7] = 200
    assert medium.send(w, 0, 0) == T.DONE
    assert w.log[0, T.LOG_PAYLOAD : T.LOG_PAYLOAD + 1].tobytes() == bytes([*range(249, 256), 200])
