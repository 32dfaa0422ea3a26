"""The page of the braking two-wheeler: verdicts, pictures, and rows that are missed when they should be."""

from __future__ import annotations

from evcosim.master.reproduce import braking_runs as runs
from evcosim.master.reproduce import printed
from evcosim.master.reproduce.papers import load
from evcosim.models.road_friction import Road


def missed(page):
    """The keys of the rows that are missed, and the names of own ones."""
    keys = [row.by for row in printed.rows("braking")]
    rows = [by for by, row in zip(keys, page.rows, strict=True) if row.verdict == "missed"]
    return rows + [row.what for row in page.own if row.verdict == "missed"]


def test_no_row_is_missed(braking_page):
    assert not braking_page.missed, braking_page.missed


def test_verdicts(braking_page):
    """Table I is calibrated, the lock and the propositions were fitted to nothing."""
    verdicts = {row.by: row.verdict for row in printed.rows("braking")}
    table = ("(a)", "(c)", "(d)", "(c) longer", "(d) longer")
    assert {verdicts[by] for by in table} == {"calibrated"}
    assert {verdicts[by] for by in ("(b)", "3.1 equilibria", "3.1 spread", "3.2")} == {"reproduced"}
    assert {row.verdict for row in braking_page.own} == {"own"}


def test_every_row_of_table_1_has_its_variants(braking_page):
    rows = [row for row in braking_page.rows if row.place.startswith("Table I") and "distance" in row.what]
    assert len(rows) == 3
    for variant in ("over the bus", "ideal signals", "detailed plant"):
        assert all(f"{variant}: " in row.obtained for row in rows)
    assert [row.printed for row in rows] == ["33.34 m", "51.32 m", "46.4 m"]


def test_a_stop_that_is_too_long_is_missed(braking_runs):
    late = braking_runs | {"known_speed": braking_runs["2 late"]}
    assert missed(load("braking").page(late)) == ["pid", "(a)", "(c) longer", "(d) longer"]


def test_a_detailed_plant_that_does_something_else_is_missed(braking_runs):
    other = {
        "front_only, detailed": braking_runs["estimated_speed, detailed"],
        "estimated_speed, detailed": braking_runs["known_speed, detailed"],
    }
    assert missed(load("braking").page(braking_runs | other)) == ["(b)", "(c)", "(c) longer"]


def test_wheels_that_do_not_lock_are_missed(braking_runs):
    unlocked = braking_runs | {"estimated_speed": braking_runs["known_speed"]}
    assert missed(load("braking").page(unlocked)) == ["pid", "(b)"]


def test_a_start_that_goes_elsewhere_is_missed(braking_runs):
    name = f"propositions on {Road.SNOW.name.lower()}"
    astray = runs.Propositions(spread=(1e-5, 0.0), equilibria=(2, 1), locked=29)
    assert missed(load("braking").page(braking_runs | {name: astray})) == [
        "both",
        "3.1 equilibria",
        "3.1 spread",
        "3.1 set points",
        "3.2",
    ]


def test_a_front_wheel_that_swings_without_delay_is_missed(braking_runs):
    """The row claims that the delay is the reason."""
    swinging = [stop._replace(swing=0.6) for stop in braking_runs["delay front_only"]]
    page = load("braking").page(braking_runs | {"delay front_only": swinging})
    assert missed(page) == ["(c) front brake only, brakes two steps later: front wheel"]
