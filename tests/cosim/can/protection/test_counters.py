"""What a receiver makes of counters: the examples of the specification, and what holds for all of them."""

from __future__ import annotations

import random

import pytest

from evcosim.cosim.can.protection import counters, profiles
from evcosim.cosim.can.protection.counters import (
    INITIAL,
    NO_NEW_DATA,
    OK,
    OK_SOME_LOST,
    REPEATED,
    STATUSES,
    WRONG_CRC,
    WRONG_SEQUENCE,
    judged,
    nothing_new,
    taken,
)
from evcosim.cosim.can.protection.profiles import CODES, P1A, P5, modulus
from support.compiled import in_machine_code

PROFILES = pytest.mark.parametrize("profile", CODES.values(), ids=CODES)


def statuses(profile: int, received: list[int | None], max_delta: int = 1, wrong: int = -1) -> list[int]:
    """Return the status after each frame by its counter, None: none came; frame `wrong` has a wrong CRC."""
    last, gap, found = -1, max_delta, []
    for i, counter in enumerate(received):
        if counter is None:
            status, gap = nothing_new(profile, gap, max_delta)
        else:
            status, last, gap = judged(profile, i != wrong, counter, last, gap, max_delta)
        found.append(status)
    return found


@PROFILES
def test_a_counter_that_goes_round_is_ok(profile: int) -> None:
    counts = [i % modulus(profile) for i in range(3 * modulus(profile))]
    assert statuses(profile, counts) == [INITIAL, *[OK] * (len(counts) - 1)]


def test_a_gap_of_the_specification() -> None:
    """After counter 1, with the greatest initial difference 1, the counters 2 and 3 are taken, 4 is not."""
    assert [statuses(P1A, [1, n])[1] for n in (2, 3, 4)] == [OK, OK_SOME_LOST, WRONG_SEQUENCE]
    # each cycle without a frame lets one more be missing
    assert statuses(P1A, [1, None, 4]) == [INITIAL, NO_NEW_DATA, OK_SOME_LOST]
    assert statuses(P1A, [1, None, 5]) == [INITIAL, NO_NEW_DATA, WRONG_SEQUENCE]


@PROFILES
def test_frames_after_lost_ones_are_those_of_the_documentation(profile: int) -> None:
    """With max_delta = 1 profile 5 takes no frame behind a lost one, the others do after any number."""
    for lost in range(1, 14):
        found = statuses(profile, [0, *[None] * lost, 1 + lost, 2 + lost])[-2:]
        if profile == P5:
            assert found == [WRONG_SEQUENCE, OK]
        elif 2 + lost < modulus(profile):
            assert found == [OK_SOME_LOST, OK]
        assert statuses(P5, [0, *[None] * lost, 1 + lost], 1 + lost)[-1] == OK_SOME_LOST
        assert statuses(P5, [0, *[None] * lost, 1 + lost], lost)[-1] == WRONG_SEQUENCE


@PROFILES
def test_a_frozen_frame_is_seen(profile: int) -> None:
    assert statuses(profile, [3, 4, 4, 4, 5]) == [INITIAL, OK, REPEATED, REPEATED, OK]


@PROFILES
def test_a_wrong_checksum_is_never_taken_and_changes_no_counter(profile: int) -> None:
    found = statuses(profile, [3, 9, 4], wrong=1)
    assert found[1] == WRONG_CRC
    assert found[2] == OK


@PROFILES
def test_a_receiver_finds_back_after_a_jump(profile: int) -> None:
    size = modulus(profile)
    counts = [0, *((size // 2 + i) % size for i in range(2 * size))]
    found = statuses(profile, counts)
    assert found[1] == WRONG_SEQUENCE
    back = next(i for i, status in enumerate(found) if i > 1 and taken(status))
    assert back <= size
    assert set(found[back + 1 :]) == {OK}


def test_fifteen_is_no_counter_of_profile_1() -> None:
    assert statuses(P1A, [14, 15, 0]) == [INITIAL, WRONG_SEQUENCE, OK]


def test_profile_5_compares_with_the_last_right_frame() -> None:
    assert statuses(P5, [0, 100, 101]) == [INITIAL, WRONG_SEQUENCE, OK]


@PROFILES
def test_only_right_checksums_in_sequence_are_taken(profile: int) -> None:
    draw = random.Random(4)
    for _ in range(500):
        last = draw.randrange(-1, modulus(profile))
        counter, gap = draw.randrange(modulus(profile)), draw.randrange(1, 14)
        status, kept, _ = judged(profile, draw.random() < 0.8, counter, last, gap, 2)
        assert status in STATUSES
        if taken(status):
            assert kept == counter and counter != last
        elif profile != P5:
            assert kept == last


def test_machine_code_judges_the_same() -> None:
    machine = in_machine_code(profiles, counters)
    draw = random.Random(6)
    for profile in CODES.values():
        for _ in range(200):
            counter, last, gap = draw.randrange(16), draw.randrange(-1, 15), draw.randrange(1, 15)
            arguments = (profile, draw.random() < 0.8, counter, last, gap, 1)
            assert machine["judged"](*arguments) == judged(*arguments)
            assert machine["nothing_new"](profile, gap, 1) == nothing_new(profile, gap, 1)
        assert machine["taken"](OK) and not machine["taken"](REPEATED)
