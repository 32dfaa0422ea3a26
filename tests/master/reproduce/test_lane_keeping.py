"""The page of lane keeping: no number is missed."""

from __future__ import annotations

import pickle

from evcosim.master.reproduce.lane_keeping import PAPER


def test_lane_keeping_misses_nothing(written):
    page, _ = written
    assert page.missed == ()
    assert [row.what for row in page.rows if row.verdict == "not reproducible"] == ["K-hat"]
    assert {picture.stem for picture in page.pictures} == {"fig7", "fig8", "fig9", "delay"}


def test_printed_matrices_and_poles_come_out(written):
    rows = {row.what: row.verdict for row in written[0].rows}
    matrices = [f"{name}: largest difference to the printed entries" for name in "ABKS"]
    assert {rows[what] for what in (*matrices, "closed-loop poles: largest difference")} == {"reproduced"}


def test_delay_is_a_number_of_its_own(written):
    rows = {row.what: row for row in written[0].rows}
    assert rows["two more steps: the run"].verdict == "reached"
    assert rows["two more steps: the run"].reach == "diverges"


def test_tasks_can_be_sent_to_processes():
    runs = PAPER.runs()
    assert [run.name for run in runs] == ["bus", "ideal", "one", "two"]
    assert pickle.loads(pickle.dumps(runs)) == runs
