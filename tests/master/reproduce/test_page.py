"""The verdicts of a page's rows."""

from __future__ import annotations

import math

import pytest

from evcosim.master.reproduce.page import VERDICTS, Page, at_least, at_most, holds, near, not_reproducible


@pytest.mark.parametrize(
    ("row", "verdict"),
    [
        (near("x", "1.0", 1.05, 1.0, 0.1), "reproduced"),
        (near("x", "1.0", 1.05, 1.0, 0.1, calibrated="k chosen"), "calibrated"),
        (near("x", "-", 1.05, 1.0, 0.1), "reached"),
        (near("x", "1.0", 1.2, 1.0, 0.1, calibrated="k chosen"), "missed"),
        (near("x", "-", math.nan, 1.0, 0.1), "missed"),
        (at_most("x", "2", 2.0, 2.0), "reproduced"),
        (at_most("x", "2", 2.1, 2.0), "missed"),
        (at_least("x", "2", 2.0, 2.0), "reproduced"),
        (at_least("x", "2", 1.9, 2.0), "missed"),
        (holds("x", "yes", "yes", "yes", True), "reproduced"),
        (holds("x", "yes", "yes", "no", False), "missed"),
        (not_reproducible("x", "9", "3", "because"), "not reproducible"),
    ],
)
def test_verdicts(row, verdict):
    assert row.verdict == verdict
    assert (row.reason == "") == (verdict in ("reproduced", "reached"))


def test_verdicts_from_best_to_worst():
    assert VERDICTS == ("reproduced", "calibrated", "reached", "not reproducible", "missed")


def test_texts_have_digits_and_units():
    row = near("x", "-", 1.23456, 1.2, 0.1, "m", digits=3)
    assert (row.reach, row.obtained) == ("1.2 m ± 0.1", "1.23 m")
    assert at_most("x", "-", 1.0, 2.0).reach == "≤ 2"
    assert at_least("x", "-", 1.0, 0.5, "%").reach == "≥ 0.5 %"


def test_a_page_knows_what_was_missed():
    good, bad = near("x", "1", 1.0, 1.0, 0.1), near("y", "1", 2.0, 1.0, 0.1)
    assert Page("a", "b", "c", "d", (good, bad), (), ()).missed == (bad,)
