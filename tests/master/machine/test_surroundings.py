"""The C functions that machine code calls are where its tables say."""

from __future__ import annotations

import ctypes
import threading
import time

import numpy as np
import pytest

from evcosim.master.machine import slots as S
from evcosim.master.machine import tables as L
from evcosim.master.machine.calling import clock
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.surroundings import BELL, Surroundings, wake


@pytest.fixture
def tables() -> dict[int, np.ndarray]:
    """The tables of the clock and of a handover."""
    state, numbers = np.zeros(L.STATE_SIZE, dtype=np.int64), np.zeros(L.NUMBERS_SIZE)
    made = Surroundings(state, numbers)
    return {L.STATE: state, L.NUMBERS: numbers} | made.tables | {-1: made}  # which must live


def test_the_clock_is_the_one_of_python(tables: dict[int, np.ndarray]) -> None:
    addresses = np.zeros(L.TABLES, dtype=np.int64)
    for place in (L.STATE, L.NUMBERS, L.TICKS):
        addresses[place] = tables[place].ctypes.data
    before = time.perf_counter()
    found = clock(addresses.ctypes.data)
    assert before <= found <= time.perf_counter()


@pytest.mark.skipif(not POSSIBLE, reason="a handover needs futexes and the order of stores of x86")
def test_a_handover_has_all_its_functions(tables: dict[int, np.ndarray]) -> None:
    state = tables[L.STATE]
    assert all(state[[L.YIELD, L.SYSCALL, L.FUTEX, L.SEND_BELL]])
    seconds, nanoseconds = tables[L.NAP_TIME].tolist()
    assert seconds + 1e-9 * nanoseconds == tables[L.NUMBERS][L.NAP]
    assert tables[L.BELL].tobytes() == BELL


@pytest.mark.skipif(not POSSIBLE, reason="a handover needs futexes and the order of stores of x86")
def test_wake_wakes_who_sleeps_on_the_word_of_a_flag(tables: dict[int, np.ndarray]) -> None:
    flag, woken = np.array([S.ON_WORD]), []
    place, state = flag.ctypes.data + S.WORD, tables[L.STATE].tolist()

    def sleep() -> None:
        call = ctypes.CFUNCTYPE(ctypes.c_long, *[ctypes.c_long] * 7)(state[L.SYSCALL])
        woken.append(call(state[L.FUTEX], place, 0, S.ON_WORD_BITS, 0, 0, 0))

    thread = threading.Thread(target=sleep)
    thread.start()
    while not woken:  # it may not be asleep yet
        wake(place)
        time.sleep(0.001)
    thread.join()
    assert woken == [0]
