"""The page of the braking two-wheeler: verdicts, pictures, and rows that are missed when they should be."""

from __future__ import annotations

from evcosim.master.reproduce import braking_runs as runs
from evcosim.master.reproduce.papers import load
from evcosim.models.road_friction import Road

CALIBRATED = {
    "(a) full slip control, speed known: stopping distance",
    "(c) front brake only: stopping distance",
    "(c) front brake only: longer than (a)",
    "(d) front brake, rear wheel compensated: stopping distance",
    "(d) front brake, rear wheel compensated: longer than (a)",
}
VARIANTS = ("over the bus", "ideal signals")


def test_no_row_is_missed(braking_page):
    assert not braking_page.missed, braking_page.missed


def test_verdicts(braking_page):
    by_verdict = {
        v: {r.what for r in braking_page.rows if r.verdict == v} for v in ("calibrated", "not reproducible")
    }
    assert by_verdict["calibrated"] == {f"{what}, {variant}" for what in CALIBRATED for variant in VARIANTS}
    assert by_verdict["not reproducible"] == set()
    reproduced = [r.what for r in braking_page.rows if r.verdict == "reproduced"]
    assert sum(what.startswith("(b)") for what in reproduced) == 2
    assert sum(what.startswith("Proposition") for what in reproduced) == len(reproduced) - 2 == 5
    assert all(r.verdict == "reached" for r in braking_page.rows if r.published == "-")


def test_every_calibrated_row_says_what_was_chosen(braking_page):
    assert all("chosen" in r.reason for r in braking_page.rows if r.verdict == "calibrated")


def test_published_numbers_stand_as_printed(braking_page):
    printed = {r.published for r in braking_page.rows}
    assert {"33.34 m", "51.32 m", "+54 %", "46.4 m", "+39.2 %", "wheels lock"} <= printed


def test_a_stop_that_is_too_long_is_missed(braking_runs):
    late = braking_runs | {"known_speed": braking_runs["2 late"]}
    missed = {r.what for r in load("braking").page(late).missed}
    assert "(a) full slip control, speed known: stopping distance, over the bus" in missed
    assert all("over the bus" in what for what in missed)


def test_wheels_that_do_not_lock_are_missed(braking_runs):
    (row,) = load("braking").page(braking_runs | {"estimated_speed": braking_runs["known_speed"]}).missed
    assert row.what.startswith("(b)")


def test_a_start_that_goes_elsewhere_is_missed(braking_runs):
    name = f"propositions on {Road.SNOW.name.lower()}"
    astray = runs.Propositions(spread=(1e-5, 0.0), equilibria=(2, 1), locked=29)
    missed = load("braking").page(braking_runs | {name: astray}).missed
    assert [r.obtained for r in missed] == ["1e-05", "1, 1, 1, 2", "dry 30, wet 30, cobble 30, snow 29"]


def test_a_front_wheel_that_swings_without_delay_is_missed(braking_runs):
    """The row claims that the delay is the reason."""
    swinging = [stop._replace(swing=0.6) for stop in braking_runs["delay front_only"]]
    missed = load("braking").page(braking_runs | {"delay front_only": swinging}).missed
    assert [r.what for r in missed] == ["(c) front brake only, brakes two steps later: front wheel"]
