"""Proposition 3.1 at other set points, and Remark 3.3."""

from __future__ import annotations

from evcosim.master.reproduce import braking_set_points as points
from evcosim.models import braking_analysis as analysis


def test_the_set_points_are_those_of_use_and_some_far_from_it():
    assert len({analysis.TARGET, *points.SET_POINTS}) == 5
    assert all(0.0 < slip < 1.0 for target in points.SET_POINTS for slip in target)


def test_every_end_is_one(braking_runs):
    found = {t: braking_runs[f"set points {t.front:g} and {t.rear:g}"] for t in points.SET_POINTS}
    assert all(each.spread <= 1e-6 and each.equilibria == (1,) * 8 for each in found.values())
    findings = points.findings(found)
    assert all(value.holds for value in findings["3.1 set points"])
    astray = found | {points.SET_POINTS[3]: points.Ends(1e-3, (1, 2))}
    assert [value.holds for value in points.findings(astray)["3.1 set points"]] == [False, False]


def test_low_gains_leave_low_slips():
    found = {target: points.Ends(0.0, (1,)) for target in points.SET_POINTS}
    usual, common = points.findings(found)["remark 3.3"]
    assert usual.obtained == "0.011 and 0.003"
    assert usual.holds
    assert common.holds
