"""Vector's ASCII logs."""

from __future__ import annotations

import tempfile
from pathlib import Path

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim import ConfigError
from evcosim.cosim.can.logs.reading import asc
from evcosim.cosim.can.logs.reading.files import logged_blocks
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE
from support.log_readers import written
from support.logged import (
    check_reads_what_was_written,
    check_same_one_by_one,
    check_survives,
    frames_in,
    refused,
)

HEAD = "date Mon Jan 1 00:00:00 2024\nbase hex  timestamps absolute\nno internal events logged\n"


def test_what_was_written_is_read(tmp_path: Path) -> None:
    check_reads_what_was_written(tmp_path, ".asc")


def test_what_python_can_reads_is_read(tmp_path: Path) -> None:
    """The kinds of lines of its own test file, in the words of CANalyzer."""
    path = tmp_path / "a.asc"
    text = HEAD + (
        "// version 9.0.0\nBegin Triggerblock Mon Jan 1 00:00:00 2024\n   0.000000 Start of measurement\n"
        "   0.015991 CAN 1 Status:chip status error passive - TxErr: 132 RxErr: 0\n"
        "   2.501000 1  ErrorFrame\n   3.098426 1  18EBFF00x       Rx   d 8 01 A0 0F A6 60 3B D1 40\n"
        "   3.2 2  7FF             Tx   d 0\n   3.248765 1  6F9             Rx   r 8\n"
        "  17.876707 CAN 1 Status:overrun error\n   3.297743 1  J1939TP FEE3p 6 0 0 - Rx d 23 A0 0F\n"
        "  20.305233 2  Statistic: D 1 R 0 XD 0 XR 0 E 0 O 0 B 0.04%\n"
        "  30.005021 CANFD   1 Rx        300  Generic_Name_12      1 0 8 8 01 02 03 04 05 06 07 08\n"
        "  30.300981 CANFD   3 Tx   50005x 0 0 5 5 00 01 02 03 04  140000  73 200050 7a60 46500250\n"
        "End TriggerBlock\n"
    )
    found = frames_in(path, text)
    with can.LogReader(path) as reader:
        expected = list(reader)
    assert [f.kind for f in found] == [ERROR, DATA, DATA, REMOTE, DATA, DATA]
    for ours, theirs in zip(found, expected, strict=True):
        assert ours.time == round(theirs.timestamp * 1e9) and ours.data == bytes(theirs.data)
        assert (ours.frame_id, ours.extended) == (theirs.arbitration_id, theirs.is_extended_id) or ours.kind
        assert ours.channel == str(theirs.channel + 1)


def test_decimal_numbers_and_times_from_event_to_event(tmp_path: Path) -> None:
    head = "base dec  timestamps relative\n"
    frames = frames_in(
        tmp_path / "a.asc", head + "1.5 1 100 Rx d 2 10 255\n0.25 Status\n0.25 2 101x Rx d 1 7\n"
    )
    assert [f[:5] for f in frames] == [
        (1_500_000_000, "1", 100, False, b"\x0a\xff"),
        (2_000_000_000, "2", 101, True, b"\x07"),
    ]


@pytest.mark.parametrize(
    "line",
    [
        "1.0 1 123 Rx d 8 11 22",
        "1.0 1 123 Rx d 8 11 22 33 44 55 66 77 100",
        "1.0 1 800 Rx d 0",
        "1.0 1 XYZ Rx d 0",
        "1.0 CANFD 1 Rx 123 1 0 9 13 00",
        "1.0 CANFD 1 Rx 123 name 1",
    ],
)
def test_damaged_frames_are_refused_with_their_line(tmp_path: Path, line: str) -> None:
    assert refused(tmp_path / "a.asc", HEAD + line) == f"line 4: the frame cannot be read: {line}"


def test_damaged_logs_are_read_or_refused(tmp_path: Path) -> None:
    check_survives(tmp_path, ".asc", written(tmp_path, ".asc").read_bytes())


@pytest.mark.parametrize(
    "tail", [b"\0" * 40, b"\x00\xffgarbage\n", b"1.0 1 123 Rx d 1 11\x00\n", b"\x1b\x02"]
)
def test_bytes_that_no_text_has_are_refused_with_their_line(tmp_path: Path, tail: bytes) -> None:
    (tmp_path / "a.asc").write_bytes(HEAD.encode() + b"1.0 1 123 Rx d 1 11\n" + tail)
    with pytest.raises(ConfigError, match=r"a\.asc: line 5: bytes that no text has"):
        frames_in(tmp_path / "a.asc")


def test_a_time_is_as_exact_as_its_digits(tmp_path: Path) -> None:
    text = "base hex timestamps relative\n 0.01 1 123 Rx d 0\n 0.0100 1 123 Rx d 0\n 0.1 1 ErrorFrame\n"
    assert [f.resolution for f in frames_in(tmp_path / "a.asc", text)] == [10**7, 10**5, 10**8]


EVENTS = st.builds(
    lambda time, digits, channel, key, direction, kind, length, data, tail: (
        f"{f'{time // 10**9:5d}.{time % 10**9:09d}'[: -digits or None]} {channel}  {key} {direction}"
        f"   {kind} {length}"
        f"{''.join(f' {byte}' for byte in data)}{tail}"
    ),
    st.integers(0, 2 * 10**18),
    st.integers(0, 9),
    st.sampled_from(["1", "2", "10", "0", "01", "12345", "x"]),
    st.sampled_from(["123", "7FF", "800", "1ABCDEF0x", "3FFFFFFFx", "1X", "xyz", "123x"]),
    st.sampled_from(["Rx", "Tx", "rx", "TxRq", "Statistic:"]),
    st.sampled_from(["d", "d", "d", "r", "D", "x"]),
    st.sampled_from(["0", "1", "2", "3", "8", "9", "08"]),
    st.lists(st.sampled_from(["00", "1F", "ff", "A", "123", "zz"]), max_size=9),
    st.sampled_from(["", "", "", "  Length = 5", "\r", "\x01"]),
)
OTHERS = st.sampled_from(
    [
        "base dec  timestamps absolute", "base hex timestamps relative", "// a comment", "",
        "0.5 1 ErrorFrame", "0.5 CANFD 1 Rx 123 1 0 4 4 11 22 33 44", "End TriggerBlock",
        "0.5 1 Statistic: D 0",
    ]
)  # fmt: skip # lines that are no frames, or others


@given(st.lists(st.one_of(EVENTS, EVENTS, OTHERS), max_size=8))
def test_lines_in_bulk_are_those_one_by_one(lines: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        check_same_one_by_one(asc, Path(folder) / "a.asc", "\n".join(lines))


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("Begin Triggerblock Sat Jan 01\n 0.5 1 123 Rx d 0\n", 1),
        ("Begin TriggerBlock\n 0.5 1 123 Rx d 0\nEnd TriggerBlock\nbegin triggerblock\n", 4),
        ("Begin Triggerblock\n 0.5 1 123 Rx d 0\nEnd TriggerBlock\n", 0),
        (" 0.5 1 123 Rx d 0\n", 0),
    ],
)
def test_a_block_of_events_without_an_end_is_said(tmp_path: Path, text: str, line: int) -> None:
    (tmp_path / "a.asc").write_text(text)
    with logged_blocks(tmp_path / "a.asc") as blocks:
        notes = [block.note for block in blocks if block.note]
    assert len(notes) == bool(line)
    assert all(
        note.startswith(f'the "Begin Triggerblock" in line {line} has no "End Trigg') for note in notes
    )
