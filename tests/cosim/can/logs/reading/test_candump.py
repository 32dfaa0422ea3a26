"""Logs of candump -L."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.reading import candump
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE
from support.log_readers import written
from support.logged import (
    check_reads_what_was_written,
    check_same_one_by_one,
    check_survives,
    frames_in,
    refused,
)


def test_what_was_written_is_read(tmp_path: Path) -> None:
    check_reads_what_was_written(tmp_path, ".log")


def test_lines_of_can_utils(tmp_path: Path) -> None:
    text = (
        "(1436509052.249713) vcan0 044#2A366C2BBA R\n\n(1436509052.249714) vcan0 0F6#R8\n"
        "(1436509052.65) can1 20000088#0000000000000000\n(1.000001) c 12345678##15566 T\n"
        "(2.0) c 123#1122.3344\n"
    )
    frames = frames_in(tmp_path / "a.log", text)
    assert [f.kind for f in frames] == [DATA, REMOTE, ERROR, DATA, DATA]
    assert frames[0][:5] == (1_436_509_052_249_713_000, "vcan0", 0x44, False, bytes.fromhex("2A366C2BBA"))
    assert frames[3][:5] == (1_000_001_000, "c", 0x12345678, True, b"\x55\x66")
    assert frames[4].data == b"\x11\x22\x33\x44" and frames[4].place == 6


@pytest.mark.parametrize(
    "line",
    ["can0  123   [2]  11 22", "(1.0) can0 123#1", "(nan) can0 123#", "(-1.0) can0 1#", "(1.0) a 1234#"],
)
def test_other_lines_are_refused_with_their_number(tmp_path: Path, line: str) -> None:
    assert refused(tmp_path / "a.log", f"(0.5) can0 123#11\n{line}\n").startswith(
        "line 2: no line of candump -L"
    )


def test_a_classic_frame_has_eight_bytes_at_most(tmp_path: Path) -> None:
    assert refused(tmp_path / "a.log", "(0.5) can0 123#" + "11" * 9) == "line 1: a frame of 9 bytes"


def test_damaged_logs_are_read_or_refused(tmp_path: Path) -> None:
    check_survives(tmp_path, ".log", written(tmp_path, ".log").read_bytes())


def test_a_time_is_as_exact_as_its_digits(tmp_path: Path) -> None:
    text = "(1.5) a 123#\n(1.000001) a 123#\n(1.123456789) a 123#\n"
    assert [f.resolution for f in frames_in(tmp_path / "a.log", text)] == [10**8, 1000, 1]


NAMES = st.sampled_from(["can0", "c", "vcan-of-a-long-name", "a\tb", "ü", "x" * 16])
PARTS = st.one_of(
    st.none(), st.sampled_from(["(1.0)", "( 1.0)", "(1)", "(4611686018.5)", "(9999999999.5)", "  "])
)
LINES = st.builds(
    lambda time, digits, name, key, mark, data, tail, instead: (
        f"{instead or f'({time // 10**9}.{time % 10**9:09d}'[: -digits or None] + ')'} {name} "
        f"{key}{mark}{data}{tail}"
    ),
    st.integers(0, 2 * 10**18),
    st.integers(0, 8),
    NAMES,
    st.sampled_from(["123", "7FF", "FFF", "1ABCDEF0", "20000088", "12", "xyz", "00000001"]),
    st.sampled_from(["#", "#", "#", "##1", "##", "#R", "##5", ""]),
    st.text("0123456789abcdefABCDEF", max_size=20),
    st.sampled_from(["", "", "", "", " R", ".", "_9", "#", "\r", " "]),
    PARTS,
)


@given(st.lists(LINES, max_size=6))
def test_lines_in_bulk_are_those_one_by_one(lines: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        check_same_one_by_one(candump, Path(folder) / "a.log", "\n".join(lines))


def test_an_interface_of_a_long_name_and_one_of_another_alphabet(tmp_path: Path) -> None:
    text = "(1.5) vcan-of-a-long-name 123#11\n(1.5) ü 123##1112233\n\n(2.5) can0 123#1122\n"
    assert [(f.channel, f.data.hex()) for f in frames_in(tmp_path / "a.log", text)] == [
        ("vcan-of-a-long-name", "11"), ("ü", "112233"), ("can0", "1122"),
    ]  # fmt: skip # a frame in a line
