"""The page of lane keeping: no number is missed."""

from __future__ import annotations

import pickle

from evcosim.master.reproduce import printed
from evcosim.master.reproduce.lane_keeping import PAPER


def test_lane_keeping_misses_nothing(written):
    page, _ = written
    assert page.missed == ()
    assert [row.verdict for row in page.rows] == [row.verdict for row in printed.rows("lane_keeping")]
    assert [picture.stem for picture in page.pictures] == ["fig7", "fig8", "fig9", "states", "delay"]


def test_printed_matrices_and_poles_come_out(written):
    keys = [row.by for row in printed.rows("lane_keeping")]
    verdicts = dict(zip(keys, (row.verdict for row in written[0].rows), strict=True))
    of_print = ("A", "B", "K", "Q_r", "rank", "fast poles", "slow poles", "cost")
    assert {verdicts[by] for by in of_print} == {"reproduced"}
    assert verdicts["S"] == "calibrated"
    contradictions = ("K-hat", "Bc", "outputs", "other mass", "a13", "a33", "demand")
    assert {verdicts[by] for by in contradictions} == {"not reproducible"}


def test_figures_have_the_numbers_and_the_content_of_the_paper(written):
    captions = {picture.stem: picture.caption for picture in written[0].pictures}
    assert captions["fig7"] == "Fig. 7: desired lane and response of the vehicle"
    assert captions["fig8"] == "Fig. 8: front steering angle"
    assert captions["fig9"] == "Fig. 9: rear steering angle"
    lane = next(p.figure for p in written[0].pictures if p.stem == "fig7")
    assert len(lane.axes[0].lines) == 2  # the reference and the displacement together


def test_delay_is_a_number_of_its_own(written):
    rows = {row.what: row for row in written[0].own}
    assert rows["two more steps: the run"].verdict == "own"
    assert rows["two more steps: the run"].reach == "diverges"


def test_tasks_can_be_sent_to_processes():
    runs = PAPER.runs()
    assert [run.name for run in runs] == ["bus", "ideal", "one", "two"]
    assert pickle.loads(pickle.dumps(runs)) == runs
