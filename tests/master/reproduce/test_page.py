"""The rows of a page: the verdict of the table, or "missed"."""

from __future__ import annotations

import math

import pytest

from evcosim.master.reproduce import printed
from evcosim.master.reproduce.page import (
    MISSED,
    OWN,
    Found,
    Picture,
    apart,
    at_least,
    at_most,
    holds,
    judged,
    near,
    page,
)
from evcosim.master.reproduce.printed import Printed

TABLE = (
    Printed("mine", "(1)", "number", "a length", 1.5, "calibrated", "m", "k is chosen", by="length"),
    Printed("mine", "Fig. 1", "figure", "the curve", "drawn", "reproduced", picture="curve"),
    Printed("mine", "2", "claim", "it is so", "stated", "by construction", where="in `Model`"),
    Printed(
        "mine", "3", "number", "the mass", 3904, "by construction", "kg",
        parameters=("two_motor_vehicle.TwoMotorVehicle.mass",),
    ),
)  # fmt: skip # a row a line
CURVE = Picture("curve", "the curve", None)


@pytest.fixture
def mine(monkeypatch):
    """The function from what was found and drawn to the rows of a paper of four."""
    monkeypatch.setattr(printed, "rows", lambda paper: TABLE)
    return lambda found, pictures=(CURVE,): judged("mine", found, pictures)


@pytest.mark.parametrize(
    ("found", "good"),
    [
        (near(1.05, 1.0, 0.1), True),
        (near(1.2, 1.0, 0.1), False),
        (near(math.nan, 1.0, 0.1), False),
        (apart(0.1, 0.1), True),
        (apart(0.2, 0.1), False),
        (apart(math.nan, 0.1), False),
        (holds("yes", True), True),
        (holds("no", False), False),
    ],
)
def test_a_verdict_is_that_of_the_table_unless_the_runs_do_not_bear_it_out(mine, found, good):
    row = mine({"length": found})[0]
    assert row.verdict == ("calibrated" if good else MISSED)
    assert row.reason == ("k is chosen" if good else "outside what was to be reached")


BOUNDS = [
    (at_most(2.0, 2.0), True),
    (at_most(2.1, 2.0), False),
    (at_most(math.nan, 2.0), False),
    (at_least(2.0, 2.0), True),
    (at_least(1.9, 2.0), False),
]


@pytest.mark.parametrize(("found", "good"), BOUNDS)
def test_a_bound_is_for_claims_and_for_numbers_printed_as_bounds(monkeypatch, found, good):
    claim = Printed("mine", "1", "claim", "it is small", "stated", "calibrated", reason="k is chosen", by="x")
    number = Printed("mine", "2", "number", "error", 2, "reproduced", by="x", bound="≤")
    for row in (claim, number):
        monkeypatch.setattr(printed, "rows", lambda paper, row=row: (row,))
        assert judged("mine", {"x": found}, ())[0].verdict == (row.verdict if good else MISSED)
    assert number.shown == "≤ 2"


@pytest.mark.parametrize("verdict", printed.VERDICTS)
@pytest.mark.parametrize(("found", "good"), BOUNDS)
def test_a_printed_number_does_not_come_out_by_a_bound(monkeypatch, verdict, found, good):
    row = Printed("mine", "1", "number", "error", 3.18, verdict, reason="no noise", by="x")
    monkeypatch.setattr(printed, "rows", lambda paper: (row,))
    for several in (found, [near(3.18, 3.18, 0.1), found]):
        if verdict in ("reproduced", "calibrated"):
            with pytest.raises(ValueError, match="a printed number is not"):
                judged("mine", {"x": several}, ())
        else:
            assert judged("mine", {"x": several}, ())[0].verdict == (verdict if good else MISSED)


def test_the_ways_to_a_value(mine):
    rows = mine({"length": near(1.5, 1.5, 0.1, "m")})
    assert [row.obtained for row in rows] == [
        "1.5 m",
        "redrawn",
        "in `Model`",
        "TwoMotorVehicle.mass = 3904 kg",
    ]
    assert [row.verdict for row in rows] == [row.verdict for row in TABLE]
    assert rows[0].printed == "1.5 m"
    assert [row.picture for row in rows] == ["", "curve", "", ""]


def test_each_variant_counts(mine):
    good, bad = near(1.5, 1.5, 0.1, of="over the bus"), near(2.0, 1.5, 0.1, of="ideal", reason="late")
    both = mine({"length": [good, bad]})[0]
    assert (both.obtained, both.verdict) == ("over the bus: 1.5; ideal: 2", MISSED)
    assert mine({"length": [good, good]})[0].verdict == "calibrated"


def test_reasons_stand_behind_each_other(mine):
    row = mine({"length": near(1.5, 1.5, 0.1, reason="late")})[0]
    assert row.reason == "k is chosen; late"


@pytest.mark.parametrize(
    ("found", "pictures", "message"),
    [
        ({}, (CURVE,), "nothing was found by 'length'"),
        (
            {"length": Found("1"), "width": Found("2")},
            (CURVE,),
            "no row of printed.toml is obtained by width",
        ),
        ({"length": Found("1")}, (), "there is no picture 'curve'"),
    ],
    ids=["missing", "too much", "no picture"],
)
def test_table_and_findings_fit_each_other(mine, found, pictures, message):
    with pytest.raises(KeyError, match=message):
        mine(found, pictures)


def test_a_page_knows_what_was_missed_of_both_tables(monkeypatch):
    monkeypatch.setattr(printed, "rows", lambda paper: TABLE[:1])
    monkeypatch.setattr(printed, "papers", lambda: {"mine": printed.Source("mine", "A. Author")})
    made = page(
        "mine", title="t", about="a", found={"length": near(1.5, 1.5, 0.1)},
        own={"x": near(2.0, 1.0, 0.1), "y": Found("1")}, pictures=(), commands=(),
    )  # fmt: skip # one page
    assert [row.verdict for row in made.own] == [MISSED, OWN]
    assert made.missed == (made.own[0],)
    assert made.source == "A. Author"


def test_texts_have_digits_and_units():
    found = near(1.23456, 1.2, 0.1, "m", digits=3)
    assert (found.reach, found.obtained) == ("1.2 m ± 0.1", "1.23 m")
    assert at_most(1.0, 2.0).reach == "≤ 2"
    assert at_least(1.0, 0.5, "%").reach == "≥ 0.5 %"
