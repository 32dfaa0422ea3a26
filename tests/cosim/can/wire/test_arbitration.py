"""Who starts, and what wrong bits do, with a bit time of 1: tests/support/bus_oracle.py has the rest."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from evcosim.cosim.can.timing.lengths import classic_bits, fd_bits
from evcosim.cosim.can.wire import arbitration
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def contend(w, bus, end):
    """Let frames have the bus until one is carried, or none waits: past those that end with a wrong bit."""
    while (i := arbitration.contend(w, bus, end)) < -1:
        assert w.messages[-2 - i, T.QUEUED] == 1
    return i


def wire(count: int = 2, chance: float = 0.0) -> SimpleNamespace:
    """Messages of one byte, identifiers 16, 17 ..., each of a node of its own, on one bus; all wait."""
    tables = {name: np.zeros((8, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables |= {name: np.zeros(80, dtype=np.int64) for name in ("frame", "state")}
    tables["nodes"][count:, T.BUS_OF] = -1
    tables["chances"] = np.full((1, 1024), chance)
    tables["chances"][0, 0] = 0.0
    for i in range(count):
        tables["messages"][i, [T.LENGTH, T.ID, T.NODE, T.QUEUED]] = 1, 16 + i, i, 1
    tables["buses"][0, [T.MESSAGES, T.BIT, T.DATA_BIT, T.PENDING, T.NOISY]] = count, 1, 1, count, chance > 0.0
    made = SimpleNamespace(**tables)
    made.wire = Wire(**{name: table.data for name, table in tables.items()})  # with Python's own numbers
    return made


BITS = [classic_bits(16 + i, 0, [0], 0, 1) for i in range(3)]


def test_the_lowest_identifier_first_then_the_next_after_the_interframe_space():
    w = wire()
    assert contend(w.wire, 0, 10**6) == 0
    assert w.buses[0, T.FREE_AT] == BITS[0] + 3
    assert contend(w.wire, 0, 10**6) == 1
    assert w.buses[0, T.FREE_AT] == BITS[0] + BITS[1] + 6
    assert w.messages[:2, T.BUSY].tolist() == [BITS[0] + 3, BITS[1] + 3]
    assert contend(w.wire, 0, 10**6) == -1


def test_who_is_ready_first_starts_whatever_its_identifier():
    w = wire(3)
    w.messages[:3, T.SINCE] = 50, 20, 20
    assert [contend(w.wire, 0, 10**6) for _ in range(3)] == [1, 0, 2]
    assert w.buses[0, T.FREE_AT] == 20 + sum(BITS) + 9


def test_nobody_starts_at_the_end_or_later():
    w = wire()
    w.messages[:2, T.SINCE] = 50
    assert contend(w.wire, 0, 50) == -1
    assert contend(w.wire, 0, 51) == 0
    assert contend(w.wire, 0, w.buses[0, T.FREE_AT]) == -1


def test_fd_has_two_rates():
    w = wire(1)
    w.messages[0, [T.FD, T.SWITCHED, T.LENGTH]] = 1, 1, 8
    w.buses[0, [T.BIT, T.DATA_BIT]] = 4, 1
    assert contend(w.wire, 0, 10**6) == 0
    nominal, fast = fd_bits(16, 0, [0] * 8, 0, 8, 1)
    assert w.buses[0, T.FREE_AT] == 4 * nominal + fast + 12


def test_always_wrong_bits_lead_to_error_passive_then_bus_off():
    w = wire(2, chance=1.0)
    w.messages[1, T.QUEUED] = 0
    assert contend(w.wire, 0, 40) == -1
    assert w.messages[0, T.ERRORS] == 2  # the first bit, the flags, the delimiter and the space are 24 bits
    assert w.nodes[:2, [T.ERROR_COUNT, T.RECEIVE_COUNT]].tolist() == [[16, 0], [0, 2]]
    assert contend(w.wire, 0, 16 * 24 + 1) == -1
    assert w.nodes[0, T.ERROR_COUNT] == 128  # beyond 127: 8 more bits before the next
    assert w.nodes[0, T.READY_AT] == w.buses[0, T.FREE_AT] + 8
    contend(w.wire, 0, 32 * 32 + 1000)
    assert w.nodes[0, [T.BUS_OFFS, T.ERROR_COUNT]].tolist() == [1, 0]
    assert w.messages[0, T.ERRORS] == 32
    assert w.nodes[0, T.READY_AT] == w.buses[0, T.FREE_AT] + 128 * 11


@pytest.mark.parametrize("chance", [0.1, 0.5])
def test_a_frame_is_sent_until_its_bits_are_right(chance):
    w = wire(1, chance)
    carried = 0
    for _ in range(200):
        w.messages[0, T.QUEUED], w.buses[0, T.PENDING] = 1, 1
        w.nodes[0, T.ERROR_COUNT] = 0
        carried += contend(w.wire, 0, 10**9) == 0
        w.messages[0, T.CARRIED] += 1
    assert carried == 200
    share = w.messages[0, T.ERRORS] / (200 + w.messages[0, T.ERRORS])
    assert share == pytest.approx(chance, abs=0.1)


def test_a_receive_counter_beyond_127_is_error_passive_too_and_falls_to_127():
    w = wire(2, chance=1e-9)
    w.nodes[0, T.RECEIVE_COUNT] = w.nodes[1, T.RECEIVE_COUNT] = 140
    assert arbitration.contend(w.wire, 0, 10**6) == 0
    assert w.nodes[:2, T.RECEIVE_COUNT].tolist() == [140, 127]
    assert w.nodes[:2, T.READY_AT].tolist() == [w.buses[0, T.FREE_AT] + 8, 0]
