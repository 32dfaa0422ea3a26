"""Lines of logs, and their times."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from evcosim.cosim.can.logs.reading.logged import lines_of, nanoseconds, unprintable
from evcosim.cosim.errors import ConfigError


def test_times_are_whole_nanoseconds() -> None:
    assert nanoseconds("1700000000", "123456") == 1_700_000_000_123_456_000
    assert nanoseconds("0", "0000000019") == 1


def test_a_line_without_an_end_is_not_held_whole() -> None:
    with pytest.raises(ConfigError, match="x: line 2 has 65536 bytes or more"):
        list(lines_of(io.BytesIO(b"one\n" + b"1" * 70_000), Path("x")))


def test_control_characters_but_those_of_white_space_are_damage() -> None:
    assert not unprintable("1.0 1 123\tRx d 1 11 \N{LATIN SMALL LETTER U WITH DIAERESIS}")
    assert unprintable("a\0b") and unprintable("\x1b")
