"""The page of the braking two-wheeler: verdicts, pictures, and rows that are missed when they should be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import braking_runs as runs
from evcosim.master.reproduce.papers import load
from evcosim.master.studies.parallel import run_all
from evcosim.models.road_friction import Road

CALIBRATED = {
    "(a) full slip control, speed known: stopping distance",
    "(c) front brake only: stopping distance",
    "(c) front brake only: longer than (a)",
    "(d) front brake, rear wheel compensated: stopping distance",
    "(d) front brake, rear wheel compensated: longer than (a)",
}
VARIANTS = ("over the bus", "ideal signals")


@pytest.fixture(scope="module")
def found():
    tasks = load("braking").runs()
    return {task.name: outcome.result() for task, outcome in zip(tasks, run_all(tasks), strict=True)}


@pytest.fixture(scope="module")
def page(found):
    return load("braking").page(found)


def named(page, part):
    (row,) = (row for row in page.rows if part in row.what)
    return row


def test_no_row_is_missed(page):
    assert not page.missed, page.missed


def test_verdicts(page):
    by_verdict = {
        v: {r.what for r in page.rows if r.verdict == v} for v in ("calibrated", "not reproducible")
    }
    assert by_verdict["calibrated"] == {f"{what}, {variant}" for what in CALIBRATED for variant in VARIANTS}
    assert by_verdict["not reproducible"] == set()
    reproduced = [r.what for r in page.rows if r.verdict == "reproduced"]
    assert sum(what.startswith("(b)") for what in reproduced) == 2
    assert sum(what.startswith("Proposition") for what in reproduced) == len(reproduced) - 2 == 5
    assert all(r.verdict == "reached" for r in page.rows if r.published == "-")


def test_every_calibrated_row_says_what_was_chosen(page):
    assert all("chosen" in r.reason for r in page.rows if r.verdict == "calibrated")


def test_published_numbers_stand_as_printed(page):
    printed = {r.published for r in page.rows}
    assert {"33.34 m", "51.32 m", "+54 %", "46.4 m", "+39.2 %", "wheels lock"} <= printed


def test_pictures(page):
    maneuvers = ["known_speed", "estimated_speed", "front_only", "front_compensated"]
    stems = [picture.stem for picture in page.pictures]
    assert stems == ["friction", "psi", "propositions", *maneuvers, "lock", "vehicle", "delay"]


def test_a_stop_that_is_too_long_is_missed(found):
    late = found | {"known_speed": found["2 late"]}
    missed = {r.what for r in load("braking").page(late).missed}
    assert "(a) full slip control, speed known: stopping distance, over the bus" in missed
    assert all("over the bus" in what for what in missed)


def test_wheels_that_do_not_lock_are_missed(found):
    (row,) = load("braking").page(found | {"estimated_speed": found["known_speed"]}).missed
    assert row.what.startswith("(b)")


def test_a_start_that_goes_elsewhere_is_missed(found):
    name = f"propositions on {Road.SNOW.name.lower()}"
    astray = runs.Propositions(spread=(1e-5, 0.0), equilibria=(2, 1), locked=29)
    missed = load("braking").page(found | {name: astray}).missed
    assert [r.obtained for r in missed] == ["1e-05", "1, 1, 1, 2", "dry 30, wet 30, cobble 30, snow 29"]


def test_a_front_wheel_that_swings_without_delay_is_missed(found):
    """The row claims that the delay is the reason."""
    swinging = [stop._replace(swing=0.6) for stop in found["delay front_only"]]
    missed = load("braking").page(found | {"delay front_only": swinging}).missed
    assert [r.what for r in missed] == ["(c) front brake only, brakes two steps later: front wheel"]


def results(speed, front_slip, rear_slip, distance=30.0):
    """A run of 0.1 s a step; its stopping distance is known at the last one."""
    columns = {
        "vehicle.speed": speed,
        "vehicle.front_slip": front_slip,
        "vehicle.rear_slip": rear_slip,
        "vehicle.stopping_distance": [0.0] * (len(speed) - 1) + [distance],
    }
    variables = [ResultVariable(name) for name in columns]
    return Results(0.1 * np.arange(len(speed)), np.column_stack(list(columns.values())), variables)


def test_stop_of_a_run():
    stop = runs.stop_of(results([20.0, 10.0, 2.0, 0.0], [0.1, 0.4, 1.0, 0.0], [0.0] * 4))
    assert stop == (30.0, 0.4, 2.0)


def test_a_run_that_ends_too_early_has_no_distance():
    stop = runs.stop_of(results([20.0, 10.0], [0.1, 0.2], [0.0] * 2, distance=0.0))
    assert math.isnan(stop.distance)
    assert math.isnan(stop.lock_speed)


@pytest.mark.parametrize(
    ("front", "rear", "expected"),
    [
        ([0.0, 1.0, 1.0, 0.0], [0.0, 0.5, 1.0, 0.0], (0.2, 5.0, True)),
        ([0.0, 1.0, 0.2, 0.0], [0.0, 1.0, 1.0, 0.0], (0.1, 10.0, False)),
    ],
    ids=["to standstill", "released"],
)
def test_lock_of_a_run(front, rear, expected):
    assert runs.lock_of(results([20.0, 10.0, 5.0, 0.0], front, rear)) == pytest.approx(expected)


def test_no_lock():
    lock = runs.lock_of(results([20.0, 0.0], [0.2, 0.0], [0.2, 0.0]))
    assert math.isnan(lock.time)
    assert not lock.stays
