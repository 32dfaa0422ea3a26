"""Which frames a fault hits; tests/cosim/plan/test_faults.py runs systems with faults."""

from __future__ import annotations

import random
from types import SimpleNamespace

import numpy as np
import pytest

from evcosim.cosim.can.wire import faults
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.protect import wipe
from evcosim.cosim.can.wire.tables import Wire
from support.bus_oracle import struck


def wire(**columns: int) -> SimpleNamespace:
    """Two messages of the nodes 4 and 5 with the keys 7 and 8, and one fault from time 10 to 20."""
    tables = {name: np.zeros((8, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables |= {name: np.zeros(80, dtype=np.int64) for name in ("frame", "state")}
    tables["odds"] = np.ones(8)
    tables["messages"][:2, T.NODE], tables["messages"][:2, T.KEY] = (4, 5), (7, 8)
    tables["messages"][:2, T.ID] = 7, 8
    row = {
        "SINCE_TIME": 10,
        "UNTIL_TIME": 20,
        "LEFT": -1,
        "EACH": 1,
        "FAULT_KEY": -1,
        "FAULT_NODE": -1,
    } | columns
    for name, value in row.items():
        tables["faults"][0, getattr(T, name)] = value
    tables["state"][T.FAULTS] = 1
    made = SimpleNamespace(**tables)
    made.wire = Wire(**{name: table.data for name, table in tables.items()})
    return made


def hits(made: SimpleNamespace, i: int, times: range) -> list[int]:
    return [now for now in times if faults.hit(made.wire, T.LOSE, i, now) == 0]


def test_a_fault_hits_its_message_or_its_node_in_its_time():
    assert hits(wire(FAULT_KEY=7), 0, range(30)) == [*range(10, 20)]
    assert hits(wire(FAULT_KEY=7), 1, range(30)) == []
    assert hits(wire(FAULT_NODE=5), 1, range(30)) == [*range(10, 20)]
    assert hits(wire(FAULT_NODE=5), 0, range(30)) == []
    assert hits(wire(FAULT_KEY=7, FAULT_KIND=T.FREEZE), 0, range(30)) == []
    assert hits(wire(FAULT_KEY=7, FAULT_BUS=1), 0, range(30)) == []


@pytest.mark.parametrize(
    ("columns", "expected"),
    [({"EACH": 3}, [10, 13, 16, 19]), ({"LEFT": 2}, [10, 11]), ({"LEFT": 2, "EACH": 4}, [10, 14])],
)
def test_each_how_many_th_and_how_many_at_most(columns, expected):
    made = wire(FAULT_KEY=7, **columns)
    assert hits(made, 0, range(30)) == expected
    assert made.faults[0, T.HITS] == len(expected)


def test_by_chance():
    made = wire(FAULT_KEY=7, UNTIL_TIME=4010, FAULT_SEED=3)
    made.odds[0] = 0.25
    assert 900 < len(hits(made, 0, range(4010))) < 1100


@pytest.mark.parametrize("kind", [T.LOSE, T.SILENCE, T.CORRUPT, T.FREEZE, T.LATE])
@pytest.mark.parametrize("seed", range(4))
def test_each_fault_counts_all_frames_whatever_others_hit(kind, seed):
    """Faults of one kind against the oracle's, each alone: frames and credit are its own, in any order."""
    draw = random.Random(seed)
    made = wire()
    made.state[T.FAULTS] = 4
    expected = []
    for row in range(4):
        since, every, count = draw.randrange(20), draw.choice([1, 2, 3]), draw.choice([None, 5])
        until = since + draw.randrange(10, 40)
        made.faults[row, [T.FAULT_KIND, T.FAULT_KEY, T.SINCE_TIME, T.UNTIL_TIME]] = kind, 7, since, until
        made.faults[row, [T.EACH, T.LEFT]] = every, -1 if count is None else count
        expected.append(struck(range(60), since, until, every, count, lambda n: True))
    if kind == T.CORRUPT:
        made.faults[:4, T.MASK] = 1, 2, 4, 8
        made.messages[0, T.LENGTH] = 1
        for now in range(60):
            made.frame[0] = 0
            faults.corrupt(made.wire, 0, now)
            assert made.frame[0] == sum(1 << row for row in range(4) if now in expected[row])
    else:
        found = [now for now in range(60) if faults.hit(made.wire, kind, 0, now) >= 0]
        assert found == sorted(set().union(*expected))
    assert made.faults[:4, T.HITS].tolist() == [len(frames) for frames in expected]


def test_draws_of_two_faults_are_independent():
    """By kind and by number, at one seed: a share of 0.3 x 0.3 of the frames is hit by both."""
    for columns in ({T.FAULT_KIND: T.CORRUPT}, {T.FAULT_NUMBER: 1}, {T.FAULT_NUMBER: 2}):
        made = wire(FAULT_KEY=7, UNTIL_TIME=10010)
        made.faults[1] = made.faults[0]
        for column, value in columns.items():
            made.faults[1, column] = value
        made.odds[:2] = 0.3
        hit = [[faults.strikes(made.wire, row, 0, now) for now in range(10, 10010)] for row in (0, 1)]
        both = [one and other for one, other in zip(*hit, strict=True)]
        assert 800 < sum(both) < 1000


def test_the_bits_of_the_counter_alone_are_wiped():
    for little, start, expected in ((1, 4, [0x0F, 0xF0]), (0, 4, [0xF0, 0x0F])):
        made = wire()
        made.frame[:2] = 255
        wipe(made.wire, little, start, 8)
        assert made.frame[:2].tolist() == expected
