"""Tables whose cells are wrapped."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.master.cli.wrapping import column_widths, wrapped

HEAD = ("place", "what", "obtained")
ROWS = [
    ("(4)", "gain from throttle to speed", "linearized: 0.46; identified: 0.4555"),
    ("Table I", "stopping distance", "TwoMotorVehicle.rolling_coefficient = 0.01"),
]
WORDS = st.lists(st.text("abc_.", min_size=1, max_size=30), max_size=8).map(" ".join)


def test_a_table_that_fits_has_a_line_a_row():
    assert wrapped(("a", "b"), [("1", "two"), ("three", "4")], 80) == ["a      b", "1      two", "three  4"]


def test_each_cell_is_wrapped_in_its_column():
    assert wrapped(HEAD, ROWS, 46) == [
        "place    what               obtained",
        "",
        "(4)      gain from          linearized: 0.46;",
        "         throttle to speed  identified:",
        "                            0.4555",
        "",
        "Table I  stopping distance  TwoMotorVehicle.r",
        "                            olling_coefficien",
        "                            t = 0.01",
    ]


@given(st.lists(st.tuples(WORDS, WORDS, WORDS), max_size=5), st.integers(30, 120))
def test_nothing_is_lost_and_no_line_is_too_long(rows, width):
    lines = wrapped(HEAD, rows, width)
    assert all(len(line) <= width for line in lines)
    assert all(line == line.rstrip() for line in lines)
    said = sorted("".join("".join(lines).split()))
    assert said == sorted("".join("".join(cell for row in (HEAD, *rows) for cell in row).split()))


@pytest.mark.parametrize(
    ("available", "widths"), [(100, [3, 10, 30]), (30, [3, 10, 17]), (20, [3, 8, 8]), (5, [3, 8, 8])]
)
def test_the_widest_columns_are_cut(available, widths):
    assert column_widths([["abc", "x" * 10, "y" * 30]], available) == widths
