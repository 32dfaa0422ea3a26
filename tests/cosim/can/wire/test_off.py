"""When a node is off the bus, with a bit time of 1; tests/support/bus_oracle.py has the rest."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from evcosim.cosim.can.wire import off
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire


def wire(since: int = 1000, until: int = 2000) -> SimpleNamespace:
    """Two nodes on a bus, of which a fault takes the second off; message 0 is heard by both."""
    tables = {name: np.zeros((4, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables |= {name: np.zeros(80, dtype=np.int64) for name in ("frame", "state", "statuses")}
    tables["nodes"][2:, T.BUS_OF] = -1
    tables["buses"][0, [T.BIT, T.STRIKES]] = 1, 1
    tables["state"][T.FAULTS] = 1
    row = {T.FAULT_KIND: T.BUS_OFF, T.FAULT_NODE: 1, T.SINCE_TIME: since, T.UNTIL_TIME: until}
    tables["faults"][0, list(row)] = list(row.values())
    tables["messages"][0, T.LISTENERS] = 2
    tables["listeners"][:2, T.OWNER] = 0, 1
    made = SimpleNamespace(**tables)
    made.wire = Wire(**{name: table.data for name, table in tables.items()})
    return made


def test_a_fault_takes_its_node_off_once_until_128_rows_of_11_bits_after_its_end():
    w = wire()
    assert off.strike(w.wire, 0, 999) == 0
    assert off.strike(w.wire, 0, 1000) == 1
    assert off.strike(w.wire, 0, 1500) == 0
    assert [off.is_off(w.wire, 1, t) for t in (999, 1000, 2000 + 1407, 2000 + 1408)] == [0, 1, 1, 0]
    assert not off.is_off(w.wire, 0, 1500)
    assert w.nodes[1, [T.BUS_OFFS, T.OFF_BY]].tolist() == [1, 1]
    assert w.buses[0, [T.STRIKES, T.OFF_NODES]].tolist() == [0, 1]


def test_a_frame_is_one_row_of_recessive_bits_and_those_before_it_count_in_whole():
    w = wire()
    off.strike(w.wire, 0, 1000)
    w.buses[0, T.FREE_AT] = 2000 + 25 + 100
    off.recover(w.wire, 0, 2000 + 25)  # two rows, and three bits that are lost
    assert w.nodes[1, T.OFF_UNTIL] == 2000 + 125 + (128 - 2 - 1) * 11
    off.recover(w.wire, 0, int(w.nodes[1, T.OFF_UNTIL]))
    assert w.buses[0, T.OFF_NODES] == 0


def test_a_frame_during_the_fault_does_not_count():
    w = wire()
    off.strike(w.wire, 0, 1000)
    w.buses[0, T.FREE_AT] = 1600
    off.recover(w.wire, 0, 1500)
    assert w.nodes[1, T.OFF_UNTIL] == 2000 + 1408


def test_who_is_off_does_not_hear_a_frame_which_counts_once():
    w = wire()
    off.strike(w.wire, 0, 1000)
    assert off.hear(w.wire, 0, 999) == 2
    assert w.messages[0, T.UNHEARD] == w.faults[0, T.HITS] == 0
    assert off.hear(w.wire, 0, 1500) == 1
    assert w.listeners[:2, T.TAKES].tolist() == [1, 0]
    w.listeners[0, T.OWNER] = 1
    assert off.hear(w.wire, 0, 1500) == 0
    assert w.messages[0, T.UNHEARD] == 2
    w.listeners[:2, T.OWNER] = -1
    assert off.hear(w.wire, 0, 1500) == 2
