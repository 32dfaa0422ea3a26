"""A turn is handed over with nothing lost, whether the sides look or sleep."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from evcosim.master.isolation import framing, handover
from evcosim.master.isolation.handover import Side, spin_time
from evcosim.master.simulation import simulate
from support.pairs import pair
from support.turns import hand_over


def test_units_give_the_same_where_both_sides_only_sleep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = pair(tmp_path, 0)
    looking = simulate(path)
    monkeypatch.setattr(handover, "SPIN", 0.0)
    assert np.array_equal(simulate(path).data, looking.data)


MINE, THEIRS = (0, 1), (2, 3)  # slots of the number and of the flag that its side sleeps


@pytest.fixture(params=[0.0, 300e-6], ids=["sleeping", "looking"])
def sides(request: pytest.FixtureRequest) -> Iterator[tuple[Side, Side, memoryview]]:
    """Both sides, which only sleep or look first, and their slots."""
    slots = memoryview(bytearray(32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        yield (
            Side(one, slots, MINE, THEIRS, request.param),
            Side(other, slots, THEIRS, MINE, request.param),
            slots,
        )


def test_turns_are_handed_over_in_order(sides: tuple[Side, Side, memoryview]) -> None:
    first, second, _ = sides
    hand_over(first, second, 500)


def test_a_frame_that_comes_before_the_number_is_returned(sides: tuple[Side, Side, memoryview]) -> None:
    first, second, slots = sides
    framing.send(first._connection, b"content")
    assert second.sleep_until(1.0, 100) == b"content"
    assert list(slots) == [0.0, 0.0, 0.0, 0.0]  # it does not sleep any more


def test_a_bell_is_rung_for_a_side_that_sleeps_and_passed_over_by_one_that_does_not() -> None:
    slots = memoryview(bytearray(32)).cast("d")
    one, other = socket.socketpair()
    with one, other:
        first = Side(one, slots, MINE, THEIRS, 1e-4)
        second = Side(other, slots, THEIRS, MINE, 1e-4)
        other.setblocking(False)
        first.post(1.0)
        with pytest.raises(BlockingIOError):
            other.recv(1)
        slots[THEIRS[1]] = 1.0  # the other side sleeps
        first.post(2.0)
        other.setblocking(True)
        framing.send(one, b"content")
        assert second.frame(100) == b"content"


def test_a_side_whose_partner_has_gone_is_not_left_asleep(sides: tuple[Side, Side, memoryview]) -> None:
    first, second, slots = sides
    first._connection.close()
    with pytest.raises(EOFError):
        second.sleep_until(1.0, 100)
    assert slots[THEIRS[1]] == 0.0


def test_a_machine_that_promises_no_order_of_stores_only_sleeps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(handover, "_ORDERED", False)
    assert spin_time() == 0.0
    monkeypatch.setattr(handover, "_ORDERED", True)
    assert spin_time() == handover.SPIN > 0.0


def test_a_side_that_looked_in_vain_sleeps_at_once_more_often(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slots, looked = memoryview(bytearray(32)).cast("d"), []
    monkeypatch.setattr(handover, "_give_way", lambda: looked.append(1))
    one, other = socket.socketpair()
    with one, other:
        side = Side(one, slots, MINE, THEIRS, 1e-6)

        def looks(times: int) -> list[bool]:
            """Whether each of so many waits in vain looked."""
            found = []
            for _ in range(times):
                looked.clear()
                assert not side.comes(1.0)
                found.append(bool(looked))
            return found

        assert looks(12) == [True, False, True, *[False] * 3, True, *[False] * 5]
        assert sum(looks(2000)) < 25
        slots[THEIRS[0]] = 1.0
        assert side.comes(1.0)  # what is there is seen without a look
        side._spin, side._pause = 10.0, 0
        monkeypatch.setattr(handover, "_give_way", lambda: slots.__setitem__(THEIRS[0], 2.0))
        assert side.comes(2.0)
        side._spin = 1e-6
        monkeypatch.setattr(handover, "_give_way", lambda: looked.append(1))
        assert looks(3) == [True, False, True]  # a look that was worth it begins anew
