"""Tables whose cells are wrapped."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.master.cli.wrapping import (
    cell_lines,
    column_widths,
    is_narrow,
    message_lines,
    wrapped,
    wrapped_below,
)

HEAD = ("place", "what", "obtained")
ROWS = [
    ("(4)", "gain from throttle to speed", "linearized: 0.46; identified: 0.4555"),
    ("Table I", "stopping distance", "TwoMotorVehicle.rolling_coefficient = 0.01"),
]
WORDS = st.lists(st.text("abc_.", min_size=1, max_size=30), max_size=8).map(" ".join)


def test_a_table_that_fits_has_a_line_a_row():
    table = [("a", "b"), ("1", "two"), ("three", "4")]
    assert wrapped(table, 80) == [["a      b"], ["1      two"], ["three  4"]]
    assert wrapped(table, 80, ["b"]) == [["a        b"], ["1      two"], ["three    4"]]
    assert not is_narrow(table, 80, 24)


def test_each_cell_is_wrapped_in_its_column():
    assert wrapped([HEAD, *ROWS], 44) == [
        ["place  what      obtained"],
        [
            "(4)    gain      linearized: 0.46;",
            "       from      identified: 0.4555",
            "       throttle",
            "       to speed",
        ],
        ["Table  stopping  TwoMotorVehicle.", "I      distance  rolling_coefficient = 0.01"],
    ]


def test_the_last_column_stands_below_where_it_would_be_too_narrow():
    table = [("name", "about"), ("speed", "how fast the vehicle is"), ("mass", "")]
    assert is_narrow(table, 25, 20) and not is_narrow(table, 30, 20)
    assert wrapped_below(table, 20) == [
        ["name", "    about"],
        ["speed", "    how fast the", "    vehicle is"],
        ["mass"],
    ]


def test_a_word_is_cut_where_its_parts_do_not_fit():
    assert cell_lines("a.bc/def_ghij in 0.01", 8) == ["a.bc/", "def_ghij", "in 0.01"]
    assert cell_lines("a.bc/def_ghij in 0.01", 4) == ["a.", "bc/", "def_", "ghij", "in", "0.01"]
    assert cell_lines("abcdefg h", 4) == ["abcd", "efg", "h"]
    assert cell_lines("", 4) == cell_lines(" ", 4) == [""]


@given(st.lists(st.tuples(WORDS, WORDS, WORDS), max_size=5), st.integers(30, 120))
def test_nothing_is_lost_and_no_line_is_too_long(rows, width):
    lines = [line for some in wrapped([HEAD, *rows], width) for line in some]
    assert all(len(line) <= width for line in lines)
    assert all(line == line.rstrip() for line in lines)
    said = sorted("".join("".join(lines).split()))
    assert said == sorted("".join("".join(cell for row in (HEAD, *rows) for cell in row).split()))


@pytest.mark.parametrize(
    ("available", "widths"), [(100, [3, 10, 30]), (30, [3, 10, 17]), (20, [3, 8, 9]), (5, [3, 8, 8])]
)
def test_the_widest_columns_are_cut(available, widths):
    assert column_widths([["abc", "x" * 10, "y" * 30]], available) == widths


@pytest.mark.parametrize("width", [20, 40, 80])
@pytest.mark.parametrize(
    ("line", "whole"),
    [
        (
            "evcosim: a b/my system.toml: connect 1.to: a list is needed, not 'car.speed'",
            "a b/my system.toml:",
        ),
        ("evcosim: there is no unit 'ecm'; 'evcosim check a.fmu --as b.c' shows it all", "--as b.c'"),
        ("evcosim: warning: x is the user's, and it's /a/very/long/path/to/that.toml in it", "/to/that.toml"),
        ("evcosim: " + "x" * 90 + " and words behind it that are as long as this", "x" * 90),
    ],
)
def test_a_message_is_wrapped_between_words(line, whole, width):
    lines = message_lines(line, width)
    assert " ".join(part.strip() for part in lines) == line
    assert any(whole in part for part in lines)
    assert not lines[0].startswith(" ") and all(part.startswith("  ") for part in lines[1:])
    longest = max(len(part) for part in lines)
    assert longest <= width or any(len(part) > width for part in [*line.split(), line[: line.find(": ", 9)]])


def test_a_command_in_quotes_stays_on_a_line_that_has_room():
    line = "evcosim: unknown system 'scoter': type 'evcosim run scooter --set vehicle.mass=180' now"
    assert message_lines(line, 60) == [
        "evcosim: unknown system 'scoter': type",
        "  'evcosim run scooter --set vehicle.mass=180' now",
    ]
    assert message_lines(line, 100) == [line]
    assert message_lines("  as it is", 80) == ["  as it is"]


@given(st.text("ab '/.:", max_size=80), st.integers(10, 60))
def test_no_character_of_a_message_is_lost(line, width):
    assert "".join("".join(message_lines(line, width)).split()) == "".join(line.split())
