"""Lines of logs, and their times."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.logs.reading.logged import nanoseconds, unprintable


def test_times_are_whole_nanoseconds() -> None:
    assert nanoseconds("1700000000", "123456") == 1_700_000_000_123_456_000
    assert nanoseconds("0", "0000000019") == 1


def test_a_time_beyond_all_logs_is_none() -> None:
    with pytest.raises(ValueError, match="a time of 999999999999 s"):
        nanoseconds("999999999999", "0")


def test_control_characters_but_those_of_white_space_are_damage() -> None:
    assert not unprintable("1.0 1 123\tRx d 1 11 \N{LATIN SMALL LETTER U WITH DIAERESIS}")
    assert unprintable("a\0b") and unprintable("\x1b")
