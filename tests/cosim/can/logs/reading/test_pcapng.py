"""Captures of SocketCAN frames."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE
from support.log_readers import written
from support.logged import check_reads_what_was_written, check_survives, frames_in, refused


def block(kind: int, body: bytes, order: str = "<") -> bytes:
    length = struct.pack(order + "I", len(body) + 12)
    return struct.pack(order + "I", kind) + length + body + length


def capture(order: str, link: int, packets: list[bytes], options: bytes = b"") -> bytes:
    """Return a capture of one interface, with a packet at 3, 4, ... units of time."""
    made = block(0x0A0D0D0A, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1), order)
    made += block(1, struct.pack(order + "HHI", link, 0, 0) + options, order)
    for i, packet in enumerate(packets, 3):
        head = struct.pack(order + "IIIII", 0, 0, i, len(packet), len(packet))
        made += block(6, head + packet + bytes(-len(packet) % 4), order)
    return made


FRAME = struct.pack(">IBBxx", 0x123, 2, 0) + b"ab"


def test_what_was_written_is_read(tmp_path: Path) -> None:
    check_reads_what_was_written(tmp_path, ".pcapng")


@pytest.mark.parametrize("order", ["<", ">"])
def test_both_byte_orders_and_all_kinds_of_frames(tmp_path: Path, order: str) -> None:
    packets = [
        FRAME,
        struct.pack(">IBBxx", 0x40000123, 8, 0),
        struct.pack(">IBBxx", 0x20000080, 8, 0) + bytes(8),
    ]
    frames = frames_in(tmp_path / "a.pcapng", capture(order, 227, packets) + block(5, bytes(4), order))
    assert [f.kind for f in frames] == [DATA, REMOTE, ERROR]
    assert frames[0][:5] == (3000, "1", 0x123, False, b"ab")  # without an option a unit of time is 1 us


def test_units_of_time_and_offsets(tmp_path: Path) -> None:
    options = struct.pack("<HHB3x", 9, 1, 128 | 10) + struct.pack("<HHq", 14, 8, 100)
    (frame,) = frames_in(tmp_path / "a.pcapng", capture("<", 227, [FRAME], options))
    assert frame.time == 100 * 10**9 + 3 * 10**9 // 1024


@pytest.mark.parametrize(
    ("power", "resolution"), [(3, 10**6), (6, 1000), (9, 1), (12, 1), (128 + 10, 976_562)]
)
def test_times_are_as_exact_as_the_unit_of_the_interface(tmp_path: Path, power: int, resolution: int) -> None:
    content = capture("<", 227, [FRAME], struct.pack("<HHBxxx", 9, 1, power))
    assert [f.resolution for f in frames_in(tmp_path / "a.pcapng", content)] == [resolution]


def test_other_links_are_passed_over(tmp_path: Path) -> None:
    assert frames_in(tmp_path / "a.pcapng", capture("<", 1, [FRAME])) == []


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"\xd4\xc3\xb2\xa1" + bytes(20), "byte 0: the file does not begin as a pcapng capture does"),
        (capture("<", 227, [FRAME])[:-5], "byte 48: the capture is cut off: 39 bytes are left of 44"),
        (capture("<", 227, [FRAME])[:50], "byte 48: the capture is cut off: 2 bytes are left of a block"),
        (capture("<", 227, [b"abc"]), "byte 48: the block is damaged: "),
        (capture("<", 227, [FRAME[:-1]]), "byte 48: the block is damaged: a frame of 2 bytes, of which 1"),
    ],
)  # fmt: skip # one line for each
def test_damaged_captures_say_where(tmp_path: Path, content: bytes, said: str) -> None:
    assert refused(tmp_path / "a.pcapng", content).startswith(said)


def test_flipped_bits_are_read_or_refused(tmp_path: Path) -> None:
    check_survives(tmp_path, ".pcapng", written(tmp_path, ".pcapng").read_bytes())
