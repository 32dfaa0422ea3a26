"""The bus budget: what is run, and the verdicts on given values."""

from __future__ import annotations

import dataclasses
import json
import math

import pytest

from evcosim.cosim.analysis.bus_budget import (
    Budget,
    Point,
    Series,
    as_csv,
    as_data,
    as_markdown,
    chance_series,
    series,
)
from evcosim.cosim.can.bus_settings import BusVariation
from support.judged_budget import judged


def test_each_variation_by_itself_from_the_nominal_point():
    delay, resolution, cycle = series(0.01)
    assert [p.bus.delay_steps for p in delay.points] == [0, 1, 2, 3]
    assert [p.label for p in delay.points[1:]] == ["+1 step (10 ms)", "+2 steps (20 ms)", "+3 steps (30 ms)"]
    assert [p.bus.resolution for p in resolution.points] == ["ideal", 1.0, 2.0, 4.0, 8.0]
    assert [p.bus.cycle for p in cycle.points] == [1, 2, 4, 8]
    for each in (delay, resolution, cycle):
        assert each.points[each.nominal].bus == BusVariation()
        for point in each.points:
            changed = [f.name for f in dataclasses.fields(point.bus)
                       if getattr(point.bus, f.name) != getattr(BusVariation(), f.name)]  # fmt: skip
            assert len(changed) == (point.bus != BusVariation())


@pytest.mark.parametrize(
    ("values", "kind", "broken", "summary"),
    [
        ([1.0, 1.1, 1.2, 1.3, 1.5], "max", "", "holds up to DBC x 8"),
        ([1.0, 1.1, 1.2, 1.6, 1.4], "max", "3", "breaks at DBC x 4"),
        ([1.0, 1.1, math.nan, 1.6, 1.4], "max", "23", "breaks at DBC x 2"),
        ([1.0, 1.6, 1.2, 1.6, 1.4], "max", "13", "broken as it is"),
        ([1.6, 1.6, 1.2, 1.6, 1.4], "max", "013", "broken as it is"),
        ([math.nan, 1.1, 1.2, 1.3, 1.4], "max", "0", "holds up to DBC x 8; broken at ideal too"),
        ([1.6, 1.1, 1.2, 1.3, 2.0], "max", "04", "breaks at DBC x 8; broken at ideal too"),
        ([2.0, 1.9, 1.5, 1.4, math.nan], "min", "34", "breaks at DBC x 4"),
    ],
)
def test_where_it_breaks(values, kind, broken, summary):
    found = judged(values, kind)
    (only,) = found.series
    assert "".join(str(i) for i, p in enumerate(only.points) if found.broken(p)) == broken
    assert found.summary(only) == summary


def test_a_failed_run_is_said_to_have_failed():
    values = [math.nan, 1.1, 1.2, math.nan, 1e9]
    found = judged(values, failed=(0, 3))
    (only,) = found.series
    assert found.summary(only) == "fails at DBC x 4; failed at ideal too"
    assert [row[3] for row in found.rows()] == [
        "failed: it fell",
        "holds",
        "holds",
        "failed: it fell",
        "broken",
    ]
    assert [p["failed"] for p in as_data(found)["series"][0]["points"]] == [True, False, False, True, False]
    nominal = judged([1.0, math.nan, 1.2, 1.3, 1.4], failed=(1,))
    assert nominal.summary(nominal.series[0]) == "failed as it is"


def test_texts():
    found = judged([1.0, 1.1, 1.2, math.nan, 1e9])
    assert found.rule == "error: at most 1.5 m"
    assert found.rows()[1] == ("", "DBC *", "1.1 m", "holds")
    assert found.rows()[3] == ("", "DBC x 4", "-", "broken: it fell")
    page = as_markdown(found, "figure.png")
    assert r"|  | DBC \* | 1.1 m | holds |" in page
    assert "- signal resolution: breaks at DBC x 4" in page
    data = json.loads(json.dumps(as_data(found), allow_nan=False))
    points = data["series"][0]["points"]
    assert [p["value"] for p in points] == [1.0, 1.1, 1.2, None, 1e9]
    assert [p["nominal"] for p in points] == [False, True, False, False, False]
    assert data["series"][0]["first_broken"] == "DBC x 4"
    assert points[3]["reason"] == "it fell\nover"


def test_points_of_chance():
    timing, losses = chance_series("instant", 0.02, 4)
    assert [p.label for p in timing.points] == [
        "instant", "frame", "jitter 5 ms", "jitter 10 ms", "jitter 18 ms"
    ]  # fmt: skip # a row
    assert [p.bus.timing for p in timing.points] == [None, "frame", "frame", "frame", "frame"]
    assert [p.bus.loss for p in losses.points] == [0.0, 0.01, 0.05, 0.1, 0.2]
    assert timing.nominal == losses.nominal == 0
    assert [p.seeds for p in losses.points] == [1, 4, 4, 4, 4]
    assert [run.seed for run in losses.points[1].runs()] == [0, 1, 2, 3]
    timed, _ = chance_series("frame", 0.02, 4)
    assert [p.label for p in timed.points][:2] == ["frame", "jitter 5 ms"]


@pytest.mark.parametrize(
    ("values", "kind", "worst", "quantile"),
    [
        ([1.0, 5.0, 2.0, 3.0, 4.0], "max", 5.0, 4.0),
        ([1.0, 5.0, 2.0, 3.0, 4.0], "min", 1.0, 2.0),
        ([1.0, math.nan, 2.0, 3.0, 4.0], "max", math.nan, 4.0),
        ([1.0, math.nan, math.nan], "max", math.nan, math.nan),
        ([2.0], "max", 2.0, math.nan),
    ],
)
def test_the_worst_of_the_seeds_judges_and_80_percent_are_not_worse_than_the_quantile(
    values, kind, worst, quantile
):
    point = Point("5 %", BusVariation(loss=0.05), seeds=len(values))
    runs = [dataclasses.replace(point, value=v, reason="no" if math.isnan(v) else "") for v in values]
    found = point.of_seeds(runs, kind)
    assert (found.value, found.quantile) == pytest.approx((worst, quantile), nan_ok=True)
    assert found.reason == ("no" if math.isnan(worst) else "")
    budget = Budget("s", "t", "error", "m", 3.5, kind, (Series("lost frames", (point, found)),))
    assert budget.broken(found) == (len(values) > 1)
    if len(values) == 5 and not math.isnan(worst):
        assert budget.text(found) == f"{worst:g} m (80%: {quantile:g} m)"
    shown = [line.split(",")[2:] for line in as_csv(budget).splitlines()[2:]]
    assert shown == [[str(n), "" if math.isnan(v) else repr(v)] for n, v in enumerate(values)]


@pytest.mark.parametrize("kind", ["max", "min"])
def test_a_limit_that_is_reached_is_kept(kind):
    found = judged([1.5] * 5, kind)
    assert not any(found.broken(point) for point in found.series[0].points)
    assert found.first_broken(found.series[0]) is None
