"""Lengths of frames: against bits that another program writes and reads, and against published sizes."""

from __future__ import annotations

import random

import numpy as np
import pytest

from evcosim.cosim.can.timing import lengths
from evcosim.cosim.can.timing.lengths import (
    FD_LENGTHS,
    INTERFRAME,
    classic_bits,
    fd_bits,
    fd_code,
    fd_length,
    least_bits,
    most_bits,
)
from support.can_bits import FormError, Frame, random_frame, read, wire
from support.compiled import in_machine_code


def counted(frame: Frame) -> int:
    """Return the bits of a frame as evcosim counts them."""
    arguments = (frame.identifier, int(frame.extended), frame.data, 0, len(frame.data))
    if frame.fd:
        return sum(fd_bits(*arguments, int(frame.switch)))
    return classic_bits(*arguments)


def test_frames_have_the_bits_that_are_read_back() -> None:
    draw = random.Random(11)
    for _ in range(1500):
        frame = random_frame(draw)
        bits = wire(frame)
        assert read(bits) == frame
        assert counted(frame) == len(bits), frame


def test_the_reader_refuses_a_flipped_bit() -> None:
    draw = random.Random(12)
    for _ in range(300):
        frame = random_frame(draw)
        bits = wire(frame)
        place = draw.randrange(len(bits))
        bits[place] ^= 1
        try:
            found = read(bits)
        except FormError:
            continue
        assert found == frame  # a bit that says nothing of the content, as ESI
        assert place < len(bits)


def test_switched_bits_are_those_between_brs_and_the_delimiter() -> None:
    draw = random.Random(13)
    for _ in range(200):
        frame = random_frame(draw)
        if not frame.fd:
            continue
        arguments = (frame.identifier, int(frame.extended), frame.data, 0, len(frame.data))
        nominal, fast = fd_bits(*arguments, 1)
        head = wire(Frame(frame.identifier, frame.extended, frame.data, True, True))
        # behind the fast part: acknowledge, its delimiter and seven bits of EOF
        assert nominal + fast == len(head)
        assert 26 <= nominal <= 26 + 19 + 9
        assert fd_bits(*arguments, 0)[1] == 0


@pytest.mark.parametrize(
    ("extended", "length", "fd", "bits"),
    [
        # fields of ISO 11898-1 as Linux' include/linux/can/length.h lists them, with the interframe space
        *((False, n, False, 19 + 8 * n + 16 + 9 + 3) for n in range(9)),
        *((True, n, False, 39 + 8 * n + 16 + 9 + 3) for n in range(9)),
        *((False, n, True, 22 + 8 * n + (28 if n <= 16 else 33) + 9 + 3) for n in FD_LENGTHS),
        *((True, n, True, 41 + 8 * n + (28 if n <= 16 else 33) + 9 + 3) for n in FD_LENGTHS),
    ],
)
def test_without_stuff_bits_frames_have_published_sizes(
    extended: bool, length: int, fd: bool, bits: int
) -> None:
    for switch in {False, fd}:
        assert sum(least_bits(extended, length, fd, switch)) + INTERFRAME == bits


@pytest.mark.parametrize(
    ("fd", "extended", "least", "most"),
    [
        # the table in the commit "can: length: refactor frame lengths definition to add size in bits" of
        # Linux (V. Mailhol, 2023), for the greatest payload, with the interframe space
        (False, False, 111, 135),
        (False, True, 131, 160),
        (True, False, 579, 712),
        (True, True, 598, 736),
    ],
)
def test_the_greatest_frames_are_those_of_a_published_table(
    fd: bool, extended: bool, least: int, most: int
) -> None:
    for switch in {False, fd}:
        kind = (extended, 64 if fd else 8, fd, switch)
        assert sum(least_bits(*kind)) + INTERFRAME == least
        assert sum(most_bits(*kind)) + INTERFRAME == most


def test_stuff_bits_and_rates_of_can_fd_are_as_published() -> None:
    """The sums for all payloads, and the split of base frames.

    Sums are those of `can_frame_bits` in Linux' include/linux/can/length.h with stuff bits, the split that of
    P. Molinaro (github.com/pierremolinaro/codes-can, calcul-debit-utile-canfd.cpp): with the interframe space
    29 to 33 bits at the nominal rate, and at that of the data 33 + 8 n (38 + 8 n from 20 bytes on) to 1 + 2 n
    more.
    """
    for n in FD_LENGTHS:
        for extended, header in ((False, 22), (True, 41)):
            stuffed = header + 8 * n + (header + 8 * n - 1) // 4
            published = stuffed + (28 if n <= 16 else 33) + 9 + 3
            assert sum(most_bits(extended, n, True, True)) + INTERFRAME == published
            assert most_bits(extended, n, True, False) == (published - INTERFRAME, 0)
        nominal, fast = least_bits(False, n, True, True)
        assert (nominal + INTERFRAME, fast) == (29, (33 if n <= 16 else 38) + 8 * n)
        assert most_bits(False, n, True, True) == (nominal + 4, fast + 1 + 2 * n)


def test_the_longest_classic_frames_are_those_of_davis() -> None:
    for n in range(9):
        assert most_bits(False, n)[0] + INTERFRAME == 55 + 10 * n
        assert most_bits(True, n)[0] + INTERFRAME == 80 + 10 * n


def test_every_frame_lies_between_least_and_most() -> None:
    draw = random.Random(14)
    for _ in range(1500):
        frame = random_frame(draw)
        kind = (frame.extended, len(frame.data), frame.fd, frame.switch)
        arguments = (frame.identifier, int(frame.extended), frame.data, 0, len(frame.data))
        found = fd_bits(*arguments, int(frame.switch)) if frame.fd else (classic_bits(*arguments), 0)
        least, most = least_bits(*kind), most_bits(*kind)
        for rate in (1.0, 0.25, 0.1):  # of the data bit rate's bits, beside one of the nominal
            times = [a + rate * b for a, b in (least, found, most)]
            assert times == sorted(times)


def test_the_most_is_reached() -> None:
    """A bound that no frame comes near would hide what it is for."""
    longest = max(counted(Frame(i, False, bytes([a] * 8))) for i in (0, 0x78, 0x787) for a in range(256))
    assert longest >= most_bits(False, 8)[0] - 5
    for extended, n in ((False, 8), (False, 64), (True, 64)):
        frames = (Frame(i, extended, bytes([a] * n), True) for i in (0, 0x78, 0x787) for a in range(256))
        assert max(map(counted, frames)) >= sum(most_bits(extended, n, True)) - 5


def test_dlc_and_padding() -> None:
    assert [fd_code(length) for length in FD_LENGTHS] == list(range(16))
    for length in range(65):
        padded = fd_length(length)
        assert padded in FD_LENGTHS and padded >= length
        assert not any(length <= other < padded for other in FD_LENGTHS)


def test_machine_code_counts_the_same() -> None:
    machine = in_machine_code(lengths)
    draw = random.Random(15)
    for _ in range(200):
        frame = random_frame(draw)
        data = np.frombuffer(b"\x99" + frame.data, dtype=np.uint8).astype(np.int64)
        arguments = (frame.identifier, int(frame.extended), data, 1, len(frame.data))
        if frame.fd:
            assert sum(machine["fd_bits"](*arguments, int(frame.switch))) == counted(frame)
        else:
            assert machine["classic_bits"](*arguments) == counted(frame)


def test_times_of_frames_hold_interframe_space_and_both_rates():
    bits, fast = lengths.most_bits(False, 12, True, True)
    least, most = lengths.frame_times(False, 12, True, 500_000, 2_000_000)
    assert most == (bits + 3) * 2_000_000 + fast * 500_000
    assert least < most < lengths.frame_times(False, 12, True, 500_000, None)[1]
    assert lengths.frame_times(True, 8, False, 500_000, 2_000_000) == (131 * 2_000_000, 160 * 2_000_000)
