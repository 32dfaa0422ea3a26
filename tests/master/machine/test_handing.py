"""Turns cross between two sides in order, be they machine code that looks or sleeps, or Python."""

# mypy: disable-error-code="untyped-decorator"

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numba import njit

from evcosim.master.isolation.handover import Side
from evcosim.master.machine import handing
from evcosim.master.machine import slots as S
from evcosim.master.machine import tables as L
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.surroundings import Surroundings
from support.turns import hand_over

pytestmark = pytest.mark.skipif(
    not POSSIBLE, reason="a handover needs futexes and the order of stores of x86"
)

MASTER = S.REQUEST, S.MASTER_SLEEPS
PROCESS = S.ANSWER, S.CHILD_SLEEPS


@njit(nogil=True)
def arrives(t: int, slots: int, theirs: int, flag: int, count: float, look: float) -> Any:
    return handing.arrives(t, slots, theirs, flag, count, look)


@njit(nogil=True)
def answered(t: int, own: int, slots: int, count: float) -> Any:
    return handing.answered(t, own, slots, count)


@njit(nogil=True)
def post(t: int, h: int, slots: int, mine: int, they_sleep: int, count: float) -> Any:
    return handing.post(t, h, slots, mine, they_sleep, count)


class Machine:
    """A side in machine code, with the calls of `handover.Side`."""

    def __init__(self, connection: socket.socket, slots: Any, mine: Any, theirs: Any, look: float) -> None:
        self.state, self.numbers = np.zeros(L.STATE_SIZE, dtype=np.int64), np.zeros(L.NUMBERS_SIZE)
        self.own, self.hand = np.zeros(L.TURN_SIZE), np.zeros(L.HAND, dtype=np.int64)
        self.made = Surroundings(self.state, self.numbers)
        self.tables = np.zeros(L.TABLES, dtype=np.int64)
        for place, array in (self.made.tables | {L.STATE: self.state, L.NUMBERS: self.numbers}).items():
            self.tables[place] = array.ctypes.data
        self.hand[L.SOCKET] = connection.fileno()
        self.own[L.LOOKING] = self.look = look
        self.slots, self.mine, self.theirs = np.asarray(slots), mine, theirs
        self.side = Side(connection, slots, mine, theirs, 1e-4)  # for long waits

    def post(self, number: float) -> None:
        t, h, slots = (array.ctypes.data for array in (self.tables, self.hand, self.slots))
        post(t, h, slots, self.mine[0], self.theirs[1], number)

    def comes(self, number: float) -> bool:
        t, own, slots = (array.ctypes.data for array in (self.tables, self.own, self.slots))
        if self.mine == MASTER:
            return bool(answered(t, own, slots, number))
        return bool(arrives(t, slots, self.theirs[0], self.mine[1], number, self.look))

    def sleep_until(self, number: float, most: int) -> bytes:
        return self.side.sleep_until(number, most)


KINDS: dict[str, Callable[..., Any]] = {
    "python": lambda *about: Side(*about, 1e-4),
    "looking": lambda *about: Machine(*about, 1e-3),
    "sleeping": lambda *about: Machine(*about, 0.0),
}


@pytest.fixture(params=[(a, b) for a in KINDS for b in KINDS], ids="-".join)
def sides(request: pytest.FixtureRequest) -> Iterator[tuple[Any, Any]]:
    """A master and a process, each of a kind."""
    slots = memoryview(bytearray(8 * 32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        kinds = [KINDS[kind] for kind in request.param]
        yield kinds[0](one, slots, MASTER, PROCESS), kinds[1](other, slots, PROCESS, MASTER)


def test_turns_are_handed_over_in_order(sides: tuple[Any, Any]) -> None:
    master, process = sides
    hand_over(master, process, 300)


def test_a_side_that_waits_in_vain_gives_up_and_is_awake() -> None:
    slots = memoryview(bytearray(8 * 32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        for side in (Machine(one, slots, MASTER, PROCESS, 1e-4), Machine(other, slots, PROCESS, MASTER, 0.0)):
            assert not side.comes(1.0)
            assert slots[side.mine[1]] == S.AWAKE


@njit
def sleeps_with_the_lock(t: int, slots: int, theirs: int, flag: int, count: float) -> Any:
    return handing.sleeps(t, slots, theirs, flag, count)


@pytest.mark.parametrize("locked", [True, False])
def test_a_side_that_holds_the_lock_of_python_gives_it_back_while_it_sleeps(locked: bool) -> None:
    slots = memoryview(bytearray(8 * 32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        master, side = (
            Machine(one, slots, MASTER, PROCESS, 0.0),
            Machine(other, slots, PROCESS, MASTER, 0.0),
        )
        made = Surroundings(side.state, side.numbers, locked)
        side.numbers[L.NAP] = 0.5  # s, enough for a busy machine
        made.tables[L.NAP_TIME][:] = 0, 500_000_000
        for place, array in made.tables.items():
            side.tables[place] = array.ctypes.data
        t, at = side.tables.ctypes.data, side.slots.ctypes.data
        sleeps_with_the_lock(t, at, S.REQUEST, S.CHILD_SLEEPS, 0.0)  # compiled
        came: list[bool] = []
        thread = threading.Thread(
            target=lambda: came.append(sleeps_with_the_lock(t, at, S.REQUEST, S.CHILD_SLEEPS, 1.0))
        )
        thread.start()
        while slots[S.CHILD_SLEEPS] != S.ON_WORD and thread.is_alive():
            pass
        master.post(1.0)
        thread.join()
        assert came == [locked]


def test_a_master_that_looked_in_vain_sleeps_at_once_more_often() -> None:
    slots = memoryview(bytearray(8 * 32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        master = Machine(one, slots, MASTER, PROCESS, 1e-6)
        pauses = []
        for _ in range(12):
            assert not master.comes(1.0)
            pauses.append(int(master.own[L.PAUSE]))
        assert pauses == [1, 0, 3, 2, 1, 0, 7, 6, 5, 4, 3, 2]


def test_a_bell_is_rung_for_a_side_that_sleeps_on_its_socket() -> None:
    slots = memoryview(bytearray(8 * 32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        master = Machine(one, slots, MASTER, PROCESS, 0.0)
        other.setblocking(False)
        master.post(1.0)
        with pytest.raises(BlockingIOError):
            other.recv(1)
        slots[S.CHILD_SLEEPS] = S.ON_SOCKET
        master.post(2.0)
        assert other.recv(8) == bytes(4)
        other.close()
        master.post(3.0)  # nobody is there to hear it
