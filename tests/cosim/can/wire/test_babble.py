"""Frames of a node that babbles, as they wait; tests/support/bus_oracle.py has those that are carried."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from evcosim.cosim.can.wire import babble
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def wire(period: int) -> SimpleNamespace:
    """A bus with one fault that babbles from 100 to 1000."""
    tables = {name: np.zeros((4, 80), dtype=np.int64) for name in Wire._fields}
    tables["messages"][0, T.BABBLES] = 1
    tables["buses"][0, [T.MESSAGES, T.TO_BABBLE]] = 1, 1
    tables["faults"][0, [T.SINCE_TIME, T.UNTIL_TIME, T.AMOUNT]] = 100, 1000, period
    made = SimpleNamespace(**tables)
    made.wire = Wire(**{name: table.data for name, table in tables.items()})
    return made


def test_it_begins_once_in_its_step():
    w = wire(50)
    babble.begin(w.wire, 0, 100)
    assert w.buses[0, T.PENDING] == 0
    for _ in range(2):
        babble.begin(w.wire, 0, 101)
    assert w.buses[0, [T.PENDING, T.TO_BABBLE]].tolist() == [1, 0]
    assert w.messages[0, [T.QUEUED, T.SINCE, T.SENT]].tolist() == [1, 100, 1]


def test_frames_whose_time_came_while_one_waited_take_its_place():
    w = wire(50)
    babble.begin(w.wire, 0, 200)
    w.messages[0, T.QUEUED] = 0
    w.buses[0, [T.BEGUN, T.FREE_AT]] = 220, 300
    babble.go_on(w.wire, 0)  # those of 150 and 200
    assert w.messages[0, [T.SINCE, T.SENT, T.REPLACED]].tolist() == [250, 4, 2]
    assert w.faults[0, T.HITS] == 1


def test_back_to_back_the_next_waits_when_the_bus_is_free():
    w = wire(0)
    babble.begin(w.wire, 0, 200)
    w.buses[0, T.FREE_AT] = 300
    babble.go_on(w.wire, 0)
    assert w.messages[0, T.SINCE] == 300
    w.messages[0, T.QUEUED] = 0
    w.buses[0, T.FREE_AT] = 1000
    babble.go_on(w.wire, 0)
    assert w.messages[0, T.QUEUED] == 0


def test_a_frame_that_waits_at_the_end_of_the_fault_is_not_sent():
    w = wire(50)
    babble.begin(w.wire, 0, 200)
    assert babble.ended(w.wire, 0, 999) == 0
    assert babble.ended(w.wire, 0, 1000) == 1
    assert w.messages[0, T.QUEUED] == w.buses[0, T.PENDING] == 0
    assert babble.ended(w.wire, 1, 1000) == 0  # a message
