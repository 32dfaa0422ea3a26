"""The page of lane keeping: no number is missed."""

from __future__ import annotations

import pickle

from evcosim.master.reproduce import printed
from evcosim.master.reproduce.lane_keeping import PAPER


def test_lane_keeping_misses_nothing(written):
    page, _ = written
    assert page.missed == ()
    assert [row.verdict for row in page.rows] == [row.verdict for row in printed.rows("lane_keeping")]


def test_printed_matrices_and_poles_come_out(written):
    keys = [row.by for row in printed.rows("lane_keeping")]
    verdicts = dict(zip(keys, (row.verdict for row in written[0].rows), strict=True))
    of_print = ("A", "B", "K", "Q_r", "rank", "fast poles", "slow poles", "cost")
    assert {verdicts[by] for by in of_print} == {"reproduced"}
    assert verdicts["S"] == "calibrated"
    contradictions = ("K-hat", "Bc", "outputs", "observability", "other mass", "a13", "a33", "demand")
    assert {verdicts[by] for by in contradictions} == {"not reproducible"}


def test_disturbances_and_two_steered_wheels_have_rows_and_numbers_of_their_own(written):
    rows = {row.what: row for row in (*written[0].rows, *written[0].own)}
    held = next(row for what, row in rows.items() if "crosswind and after the blow-out" in what)
    assert held.obtained == (
        "crosswind: 0.010 m from the lane, 7.7 m without steering; "
        "blowout: 0.010 m from the lane, 11.4 m without steering"
    )
    damping = next(row for what, row in rows.items() if "damped better" in what)
    assert "0.720, slow poles -3.23 ± 3.11i" in damping.obtained
    assert "0.676, slow poles -1.55 ± 1.69i" in damping.obtained
    demand = next(row for what, row in rows.items() if "demand of control" in what)
    assert demand.obtained == (
        "16.9 kN on an axle that carries 6.8 kN: μ = 2.5; lateral acceleration 7.8 m/s²"
    )


def test_delay_is_a_number_of_its_own(written):
    rows = {row.what: row for row in written[0].own}
    assert rows["two more steps: the run"].verdict == "own"
    assert rows["two more steps: the run"].reach == "diverges"


def test_tasks_can_be_sent_to_processes():
    runs = PAPER.runs()
    assert {"bus", "ideal", "one", "two", "step two", "crosswind four"} < {run.name for run in runs}
    assert pickle.loads(pickle.dumps(runs)) == runs
