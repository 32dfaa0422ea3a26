"""The turns of a process in machine code: done in order, and left to Python where they are something else."""

# mypy: disable-error-code="untyped-decorator"

from __future__ import annotations

import ctypes
import socket
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numba import njit

from evcosim.master.isolation.handover import Side
from evcosim.master.machine import serving
from evcosim.master.machine import slots as S
from evcosim.master.machine import tables as L
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.rows import table
from evcosim.master.machine.surroundings import Surroundings, address

pytestmark = pytest.mark.skipif(
    not POSSIBLE, reason="a handover needs futexes and the order of stores of x86"
)

_DO_STEP = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_double, ctypes.c_double, ctypes.c_int)
run = njit(nogil=True)(serving.run)  # compiled at its first call


class Process:
    """Machine code that serves a unit with an input, an output, and steps that `status` ends.

    A step doubles the input.
    """

    def __init__(self, connection: socket.socket, slots: np.ndarray) -> None:
        self.memory, self.status, self.times = np.zeros(3), 0, []
        self._function = _DO_STEP(self._step)
        self.state, self.own = np.zeros(L.STATE_SIZE, dtype=np.int64), np.zeros(L.TURN_SIZE)
        numbers = np.zeros(L.NUMBERS_SIZE)
        self._surroundings = Surroundings(self.state, numbers)
        hand = {L.SLOTS: slots.ctypes.data, L.SOCKET: connection.fileno(), L.TURN: self.own.ctypes.data}
        copy = {L.KIND: L.COPY, L.A: 1, L.B: 2, L.C: 1}
        self._arrays = self._surroundings.tables | {
            L.STATE: self.state, L.NUMBERS: numbers, L.MEMORY: self.memory, L.OPS: table([copy], L.OPERATION),
            L.UNITS: table([{L.FUNCTION: address(self._function)}], L.UNIT),
            L.HANDS: table([{**hand, L.BACK: 1}], L.HAND),
        }  # fmt: skip # what a turn needs
        self.tables = np.zeros(L.TABLES, dtype=np.int64)
        for place, array in self._arrays.items():
            self.tables[place] = array.ctypes.data

    def _step(self, component: int, time: float, size: float, flag: int) -> int:
        self.times.append((time, size))
        self.memory[1] = 2.0 * self.memory[0]
        return self.status

    def serve(self) -> int:
        return int(run(self.tables.ctypes.data))


@pytest.fixture
def sides() -> Iterator[tuple[Any, Process, np.ndarray]]:
    """The master, the process, and the slots between them."""
    slots = np.zeros(32)
    one, other = socket.socketpair()
    with one, other:
        view = slots.data.cast("B").cast("d")
        master = Side(one, view, (S.REQUEST, S.MASTER_SLEEPS), (S.ANSWER, S.CHILD_SLEEPS), 1e-3)
        yield master, Process(other, slots), slots


def test_turns_are_done_as_they_come_and_another_request_is_left_to_python(
    sides: tuple[Any, Process, np.ndarray],
) -> None:
    master, process, slots = sides
    slots[S.STEPS : S.STEPS_END] = 5.0, 1.0, 10.0, 2.0, 0.1, 0.05, 0.65
    slots[S.KIND], slots[S.LOOK] = S.STEP, 1.0  # it waits until the test comes to the next
    results: list[int] = []
    thread = threading.Thread(target=lambda: results.append(process.serve()))
    thread.start()
    for number in range(1, 51):
        process.memory[0] = number
        master.post(float(number))
        if not master.comes(float(number)):
            master.sleep_until(float(number), 100)
        assert process.memory[2] == 2.0 * number
    slots[S.KIND] = S.CALL
    master.post(51.0)
    thread.join()
    assert results == [L.OTHER_REQUEST]
    assert process.own[L.REQUESTS] == 50.0  # the other one is still to be answered
    assert process.times == 50 * [(0.5, 0.1), (0.6, 0.05)]


def test_it_gives_up_where_no_request_comes(sides: tuple[Any, Process, np.ndarray]) -> None:
    assert sides[1].serve() == L.NOTHING_CAME


@pytest.mark.parametrize(("status", "result"), [(1, L.WARNED), (3, L.BAD_STATUS)])
def test_a_turn_with_a_warning_or_an_error_is_not_answered(
    sides: tuple[Any, Process, np.ndarray], status: int, result: int
) -> None:
    master, process, slots = sides
    process.status = status
    slots[S.STEPS : S.STEPS_END] = 0.0, 0.0, 1.0, 1.0, 0.1, 0.1, 0.1
    slots[S.KIND] = S.STEP
    master.post(1.0)
    assert process.serve() == result
    assert (process.own[L.REQUESTS], slots[S.ANSWER]) == (1.0, 0.0)
