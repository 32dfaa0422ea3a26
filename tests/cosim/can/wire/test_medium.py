"""Frames under way, with a clock of 1 s steps and messages without signals."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.wire import medium
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def wire(delay: int, rows: int) -> Wire:
    """One message, of one byte, on a bus with a delay [ps], with a ring of so many rows."""
    tables = {name: np.zeros((8, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
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
    assert w.messages[0, [T.SENT, T.CARRIED, T.SEEN_LEAST]].tolist() == [4, 4, 2 * 10**12]
    assert w.messages[0, [T.SEEN_SUM, T.SEEN_MOST]].tolist() == [4 * 10**12, 2 * 10**12]


def test_without_a_ring_it_arrives_at_once_and_is_logged():
    w = wire(0, rows=0)
    w.messages[0, T.LOGGED] = 1
    w.base[0, 0] = 255
    assert medium.send(w, 0, 3) == T.DONE
    assert w.messages[0, T.ARRIVED] == 1
    assert w.log[0, [T.LOG_STEP, T.LOG_TIME, T.LOG_PAYLOAD]].tolist() == [3, 3 * 10**12, 255]


def test_a_frame_that_waits_is_replaced_by_the_newest():
    w = wire(0, rows=4)
    w.buses[0, [T.TIMED, T.MESSAGES, T.BIT]] = 1, 1, 10**10
    for value in (7, 8):
        w.base[0, 0] = value
        assert medium.send(w, 0, 0) == T.DONE
    assert w.messages[0, [T.SENT, T.REPLACED]].tolist() == [2, 1]
    assert medium.act(w, T.CONTEND, 0, 0) == T.DONE
    assert medium.act(w, T.ARRIVE, 0, 1) == T.DONE
    assert w.frame[0] == 8
    assert w.messages[0, [T.CARRIED, T.ARRIVED]].tolist() == [1, 1]


def test_a_standard_and_an_extended_message_of_one_number_have_draws_of_their_own():
    w = wire(0, rows=4)
    w.buses[0, [T.TIMED, T.MESSAGES, T.BIT]] = 1, 2, 10**10
    for i in range(2):
        w.messages[i, [T.LENGTH, T.ID, T.EXTENDED, T.JITTER]] = 1, 256, i, 10**11
        assert medium.send(Wire(*(table.data for table in w)), i, 0) == T.DONE  # in integers of Python
    assert 0 < w.messages[0, T.STAGED_SINCE] != w.messages[1, T.STAGED_SINCE] > 0
    assert w.messages[:2, T.SINCE].tolist() == [0, 0]


def test_a_frame_that_a_jitter_delays_lets_the_one_before_it_go_first():
    """A frame of no bytes takes 1.2 steps, so that one often waits when the next is sampled."""
    made = wire(0, rows=4)
    made.buses[0, [T.TIMED, T.MESSAGES, T.BIT]] = 1, 1, 25 * 10**9
    made.messages[0, [T.LENGTH, T.JITTER]] = 0, 10**12 - 1
    w = Wire(*(table.data for table in made))  # in integers of Python
    frames = []
    for k in range(40):
        assert medium.send(w, 0, k) == T.DONE
        sampled, since = w.messages[0, T.STAGED_SAMPLED], w.messages[0, T.STAGED_SINCE]
        assert sampled == k * 10**12 <= since < (k + 1) * 10**12
        assert medium.act(w, T.CONTEND, 0, k) == T.DONE
        assert medium.act(w, T.ARRIVE, 0, k) == T.DONE
        assert w.messages[0, T.STAGED] == 0
        frames.append(since)
    carried, free, length = [], 0, w.messages[0, T.BUSY] // w.messages[0, T.CARRIED]
    for since, following in zip(frames, [*frames[1:], 40 * 10**12], strict=True):
        start = max(since, free)
        if start < following:  # else the next one is queued before the bus is free
            carried.append(start - since)
            free = start + length
    waiting = w.messages[0, T.QUEUED]
    assert (w.messages[0, T.CARRIED], w.messages[0, T.REPLACED] + waiting) == (
        len(carried),
        40 - len(carried),
    )
    assert 0 < len(carried) < 40 - 1
    assert max(carried) > 0


def test_the_pages_of_a_message_have_one_buffer():
    w = wire(0, rows=4)
    w.buses[0, [T.TIMED, T.MESSAGES, T.BIT]] = 1, 2, 10**10
    for i in range(2):
        w.messages[i, [T.LENGTH, T.PAGE, T.PAGES]] = 1, i, 2
        w.base[i, 0] = 5 + i
    for i in (1, 0, 1):
        assert medium.send(w, i, 0) == T.DONE
    assert w.messages[:2, T.QUEUED].tolist() == [0, 1]
    assert w.messages[:2, T.REPLACED].tolist() == [1, 1]
    assert w.buses[0, T.PENDING] == 1
    assert medium.act(w, T.CONTEND, 0, 0) == T.DONE
    assert w.frame[0] == 6
