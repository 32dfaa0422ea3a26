"""The buffers of a message; tests/master/engine/test_timed_frames.py compares them with an oracle."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.wire import buffers
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def wire(pages: int = 1) -> Wire:
    """One message of one byte, with so many pages, on a bus."""
    tables = {name: np.zeros((4, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables["frame"] = np.zeros(T.BYTES, dtype=np.int64)
    for i in range(pages):
        tables["messages"][i, [T.LENGTH, T.PAGE, T.PAGES]] = 1, i, pages
    tables["buses"][0, [T.MESSAGES, T.NEXT_QUEUED]] = pages, buffers.NEVER
    return Wire(**tables)


def stage(w: Wire, i: int, value: int, sampled: int, since: int) -> None:
    w.frame[0] = value
    buffers.stage(w, i, sampled, since)


def test_the_frame_before_waits_until_the_next_one_is_queued():
    w = wire()
    stage(w, 0, 7, 0, 30)
    buffers.admit(w, 0, 30)
    stage(w, 0, 8, 100, 150)
    assert w.buses[0, [T.PENDING, T.NEXT_QUEUED]].tolist() == [2, 150]
    buffers.admit(w, 0, 149)
    assert w.waiting[0, 0] == 7
    assert w.messages[0, [T.QUEUED, T.SINCE, T.SAMPLED, T.STAGED, T.REPLACED]].tolist() == [1, 30, 0, 1, 0]
    buffers.admit(w, 0, 150)
    assert w.waiting[0, 0] == 8
    assert w.messages[0, [T.QUEUED, T.SINCE, T.SAMPLED, T.STAGED, T.REPLACED]].tolist() == [1, 150, 100, 0, 1]
    assert w.buses[0, [T.PENDING, T.NEXT_QUEUED]].tolist() == [1, buffers.NEVER]


def test_the_next_time_is_the_soonest_of_those_that_are_left():
    w = wire(pages=3)
    w.messages[:3, T.PAGES] = 1  # messages of their own
    for i, since in enumerate((40, 20, 30)):
        stage(w, i, i, 0, since)
    for now, following in ((10, 20), (20, 30), (35, 40), (40, buffers.NEVER)):
        buffers.admit(w, 0, now)
        assert w.buses[0, T.NEXT_QUEUED] == following
    assert w.messages[:3, T.SINCE].tolist() == [40, 20, 30]
    assert w.buses[0, T.PENDING] == 3


def test_another_page_waits_until_the_next_one_is_queued():
    w = wire(pages=2)
    stage(w, 0, 5, 0, 10)
    buffers.admit(w, 0, 10)
    stage(w, 1, 6, 100, 120)
    buffers.admit(w, 0, 119)
    assert w.messages[:2, T.QUEUED].tolist() == [1, 0]
    buffers.admit(w, 0, 120)
    assert w.messages[:2, T.QUEUED].tolist() == [0, 1]
    assert w.messages[:2, T.REPLACED].tolist() == [1, 0]
    assert w.waiting[1, 0] == 6
    assert w.buses[0, T.PENDING] == 1
