"""The table of what the papers print."""

from __future__ import annotations

import pytest

from evcosim.master.reproduce import papers, printed
from evcosim.master.reproduce.printed import VERDICTS, Printed
from support import counts


def test_every_paper_has_rows_with_places():
    assert list(printed.papers()) == list(papers.NAMES)
    for name in papers.NAMES:
        assert len(printed.rows(name)) > 40
    assert sum(len(printed.rows(name)) for name in papers.NAMES) == len(printed.rows())
    assert all(row.place and row.quantity for row in printed.rows())


def test_no_statement_stands_twice_in_a_paper():
    names = [str(row) for row in printed.rows()]
    assert len(set(names)) == len(names)


def test_the_docs_show_the_table_of_the_package():
    shown = counts.README.parent / "docs" / "papers" / printed.FILE.name
    assert shown.samefile(printed.FILE) or shown.read_text(encoding="utf-8").endswith(printed.FILE.name)


def test_keys_are_those_of_one_row():
    keys = [(row.paper, row.by) for row in printed.rows() if row.by]
    assert len(set(keys)) == len(keys)
    assert printed.row("braking", "(a)").number == 33.34
    with pytest.raises(KeyError, match="0 rows by 'nothing'"):
        printed.row("braking", "nothing")


def test_numbers_stay_as_printed():
    assert printed.row("multi_drive", "rise MIMO-PID").shown == "0.50 s"
    assert printed.row("multi_drive", "poles").shown == "4"
    assert printed.row("scooter", "range of a_b").shown == "[0, 4] m/s²"
    assert printed.row("lane_keeping", "S").shown == "[0.2979 -0.9401; 0.9592 0.3409]"
    assert printed.row("lane_keeping", "S").numbers == [0.2979, -0.9401, 0.9592, 0.3409]
    assert printed.row("braking", "coupling").numbers == []
    assert printed.row("scooter", "estimate").shown == "≤ 0.5 km/h"
    with pytest.raises(ValueError, match="values"):
        _ = printed.row("lane_keeping", "S").number


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"verdict": "fine"}, "kind or verdict"),
        ({"kind": "number of sorts"}, "kind or verdict"),
        ({"where": ""}, "nothing says how"),
        ({"bound": "<"}, "bound must be"),
        ({"verdict": "reproduced"}, "words alone reproduce nothing"),
        ({"verdict": "calibrated", "by": "x", "where": ""}, "needs a reason"),
        ({"verdict": "not reproducible"}, "needs a reason"),
    ],
)
def test_a_row_without_way_or_reason_is_refused(changed, message):
    good = {
        "paper": "mine", "place": "1", "kind": "claim", "quantity": "so it is", "value": "stated",
        "verdict": "by construction", "where": "there",
    }  # fmt: skip # one row
    assert Printed(**good).shown == "stated"
    with pytest.raises(ValueError, match=message):
        Printed(**good | changed)


@pytest.mark.parametrize("row", [row for row in printed.rows() if row.kind == "figure"], ids=str)
def test_the_verdicts_on_figures_follow_one_rule(row):
    if not row.picture:
        assert row.verdict == "by construction"  # a scheme
    else:
        assert row.verdict == "calibrated" or (row.verdict == "reproduced" and row.by)


def test_sections_are_marked_and_other_places_are_not():
    places = {row.place: row.at for row in printed.rows()}
    assert [places[place] for place in ("II, IV-A", "Table 2, 6", "4.4, (31)")] == [
        "§II, §IV-A", "Table 2, §6", "§4.4, (31)",
    ]  # fmt: skip # three places
    same = {place for place, at in places.items() if place == at}
    assert {"Table I", "Figs. 2 and 3", "(13)-(24)", "Remark 3.3", "Abstract"} <= same


def test_counts_and_their_sentence():
    verdicts = ["reproduced", "calibrated", "calibrated", "not reproducible", "missed", "own"]
    assert list(printed.counted(verdicts).values()) == [1, 2, 0, 1]
    assert printed.sentence(verdicts) == (
        "4 printed numbers, equations, figures and claims: 1 reproduced, 2 calibrated, 0 by construction, "
        "1 not reproducible"
    )
    assert list(printed.about_verdicts()) == list(VERDICTS)


def test_the_readme_counts_as_the_pages_do():
    assert counts.counted(counts.README.read_text(encoding="utf-8")) == [counts.sentence()]
