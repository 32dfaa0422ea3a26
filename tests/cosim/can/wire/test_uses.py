"""When values are used; tests/master/engine/test_effective_delays.py has the rest."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire
from evcosim.cosim.can.wire.uses import count_use, note, use


@pytest.mark.parametrize(
    ("every", "first", "later", "arrivals", "delays"),
    [
        (1, 0, 0, [(3, 1), (4, 4)], [2, 0]),
        (1, 0, 1, [(3, 1), (4, 4)], [3, 1]),
        (10, 4, 0, [(0, 0), (4, 3), (5, 4), (14, 12), (15, 15)], [1, 2, 9]),  # of two before a turn the newer
    ],
)
def test_a_value_is_used_in_the_next_turn(every, first, later, arrivals, delays):
    tables = {name: np.zeros((2, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables["state"] = np.ones(8, dtype=np.int64)
    tables["messages"][0, [T.USES, T.LISTENERS]] = 1
    tables["uses"][0, [T.TURN_EVERY, T.FIRST_TURN, T.LATER, T.USED_AT]] = every, first, later, -1
    w = Wire(**tables)
    for k, sampled in arrivals:
        use(w, 0, k, sampled)
    count_use(w, 0)
    found = w.uses[0, [T.USE_COUNT, T.USE_LEAST, T.USE_SUM, T.USE_MOST]].tolist()
    assert found == [len(delays), min(delays), sum(delays), max(delays)]


def test_who_does_not_take_a_frame_uses_none_of_its_values():
    tables = {name: np.zeros((2, 80), dtype=np.int64) for name in Wire._fields}
    tables["state"] = np.ones(8, dtype=np.int64)
    tables["messages"][0, [T.USES, T.LISTENERS]] = 2
    tables["uses"][:, [T.TURN_EVERY, T.USED_AT]] = 1, -1
    tables["uses"][1, T.USER] = 1
    tables["listeners"][1, T.TAKES] = 1
    w = Wire(**tables)
    use(w, 0, 3, 1)
    assert w.uses[:2, T.USED_AT].tolist() == [-1, 3]


def test_a_sum_of_times_may_be_beyond_64_bits():
    row = np.zeros((1, 4), dtype=np.int64)
    times = [4 * 10**18, 10**18, 3 * 10**18 + 7] * 3
    for count, time in enumerate(times):
        note(row.data, 0, 0, 3, time, count)
    least, total, most, high = row[0].tolist()
    assert (least, most, total + high * T.SUM) == (10**18, 4 * 10**18, sum(times)) and 0 <= total <= T.SUM
