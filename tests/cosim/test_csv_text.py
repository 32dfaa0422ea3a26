"""The text of CSV files: the encoding that a file has, the header, and the column of the time by its name."""

from __future__ import annotations

import codecs
import math
import os
import re
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.csv_text import Header, as_date, encoding_of, is_date, number_in, read_header, time_column
from evcosim.cosim.errors import ConfigError


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"", "utf-8"),
        (b"t,v\n", "utf-8"),
        ("t,\N{DEGREE SIGN}C".encode(), "utf-8"),
        ("t,\N{DEGREE SIGN}C".encode("cp1252"), "cp1252"),
        ("t,v".encode("utf-16-le"), "utf-16-le"),
        ("t,v".encode("utf-16-be"), "utf-16-be"),
        ("t,v".encode("utf-16"), "utf-16"),
        ("t,v".encode("utf-32"), "utf-32"),
        (codecs.BOM_UTF32_BE + "t,v".encode("utf-32-be"), "utf-32"),
        ("t,v".encode("utf-8-sig"), "utf-8-sig"),
        (b"x" * ((1 << 20) - 1) + "\N{DEGREE SIGN}".encode(), "utf-8"),  # its bytes stand in two blocks
        (b"x" * (1 << 20) + b"\xc2", "cp1252"),  # a character of UTF-8 that is cut
    ],
)
def test_the_encoding_is_known_by_the_bytes(content: bytes, name: str, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(content)
    assert encoding_of(path) == name


@given(st.datetimes(datetime(1980, 1, 1), datetime(2102, 1, 1)), st.sampled_from([0, 3, 6, 9]))
def test_a_date_is_told_in_each_of_its_units(date: datetime, power: int) -> None:
    seconds = int(date.replace(tzinfo=UTC).timestamp())
    name = {0: "seconds", 3: "milliseconds", 6: "microseconds", 9: "nanoseconds"}[power]
    said = re.fullmatch(rf"{name} since 1970 \((.*) UTC\)", as_date(float(seconds * 10**power)))
    assert said and abs((datetime.fromisoformat(said[1]) - date).total_seconds()) <= 1.0


@pytest.mark.parametrize("time", [0.0, 1.0, -1.7e9, 1e6, 2.9e8, 4.2e9, 2e11, 5e12, 1e30, math.inf, math.nan])
def test_other_times_are_no_dates(time: float) -> None:
    assert as_date(time) == ""


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_decimal_comma_is_a_point_where_no_comma_separates(number: float) -> None:
    text = repr(number)
    assert number_in(text, ",") == number_in(text.replace(".", ","), ";") == number
    if "." in text:
        assert number_in(text.replace(".", ","), ",") is None
    assert number_in("1,234,567", ";") is number_in("1.234,5", "\t") is number_in("1_0", ",") is None


@pytest.mark.parametrize(
    "text",
    ["2024-01-01 00:00:00", "2024-01-01T00:00:00.5Z", "00:00:01", " 12:30 ", "1:02:03,5", "31.12.2024",
     "12/31/24", "04-May-2026 12:00", "2024/1/1", "01:00 PM"],
)  # fmt: skip # a table
def test_a_date_or_a_time_of_day(text: str) -> None:
    assert is_date(text) and number_in(text, ";") is None


@pytest.mark.parametrize(
    "text", ["", "fast", "1.5", "2024", "1e5", "-3", "1.500.000", "1/2", "nan", "a:12:30", "1-2"]
)
def test_a_text_that_is_no_date(text: str) -> None:
    assert not is_date(text)


@pytest.mark.parametrize("names", [("a", "b"), ("time [ms]", "a"), ("Zeitpunkt", "a"), ("temperature", "tx")])
def test_a_column_that_is_not_the_time_is_not_taken_for_it(names: tuple[str, ...]) -> None:
    with pytest.raises(ConfigError, match="here: no column has a name of the time in s"):
        time_column(names, "here")


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (("time", "a", "time"), "columns 1 ('time') and 3 ('time')"),
        (("a", "Time", "time"), "columns 2 ('Time') and 3 ('time')"),
        (("t", "t", "a"), "columns 1 ('t') and 2 ('t')"),
        (("T", "T", "a"), "columns 1 ('T') and 2 ('T')"),
        (("time_s", "a", "Time_S", "t"), "columns 1 ('time_s') and 3 ('Time_S')"),
    ],
)
def test_a_name_of_the_time_that_is_there_twice_is_no_choice(names: tuple[str, ...], said: str) -> None:
    with pytest.raises(ConfigError) as refusal:
        time_column(names, "here: line 1")
    assert str(refusal.value) == f"here: line 1: {said} both have the name of the time: which is meant?"


def test_a_name_of_the_time_that_does_not_count_may_be_there_twice() -> None:
    assert time_column(("t", "t", "time"), "here") == 2
    assert time_column(("T", "t"), "here") == time_column(("T", "a", "t"), "here") - 1 == 1  # a temperature
    assert time_column(("a", "T"), "here") == 1


def test_the_header_says_the_lines_above_the_first_row(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text('# a\n\n"time\n[s]";v\n0;1\n')
    assert read_header(path, "utf-8") == Header(("time\n[s]", "v"), 4, ";")


@pytest.mark.skipif(os.name != "posix", reason="a pipe in the file system is a thing of POSIX systems")
def test_a_device_or_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", Path("/dev/zero")):
        with pytest.raises(ConfigError, match=f"{path}: cannot be read: it is no file, but a pipe"):
            encoding_of(path)
