"""Rows of the log of frames."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.log import log
from evcosim.cosim.can.wire.tables import Wire


def wire(helper=None) -> Wire:
    tables = {name: np.zeros((8, T.MESSAGE), dtype=np.int64) for name in Wire._fields}
    tables |= {name: np.zeros(80, dtype=np.int64) for name in ("frame", "state")}
    tables["messages"][0, [T.LOGGED, T.LENGTH]] = 1, 12
    return Wire(**tables | {"helper": helper})


def test_bytes_stand_in_words_with_their_sign():
    w = wire()
    w.frame[:12] = [*range(1, 8), 200, 9, 10, 11, 255]
    assert log(w, 0, 3, 77) == T.DONE
    assert w.log[0, :3].tolist() == [3, 77, 0]
    assert w.log[0, 3:11].tobytes() == bytes([*range(1, 8), 200, 9, 10, 11, 255, *[0] * 52])


def test_a_full_log_is_handed_over():
    asked = []

    def help(what, i, k):
        asked.append(what)
        w.state[T.LOG_ROWS] = 0
        return T.DONE

    w = wire(help)
    for k in range(9):
        assert log(w, 0, k, k) == T.DONE
    assert asked == [T.FLUSH]
    assert w.log[0, T.LOG_STEP] == 8


def test_a_message_that_is_not_logged():
    w = wire()
    w.messages[0, T.LOGGED] = 0
    assert log(w, 0, 3, 77) == T.DONE
    assert w.state[T.LOG_ROWS] == 0
