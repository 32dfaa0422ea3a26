"""The page of the two-motor car: its rows, their verdicts, and its pictures."""

from __future__ import annotations

import pickle

import pytest

from evcosim.master.reproduce import papers, printed

PAPER = papers.load("multi_drive")


@pytest.fixture(scope="module")
def rows(multi_drive_page):
    """The rows by their keys in the table; own ones by their names."""
    keys = [row.by or str(row) for row in printed.rows("multi_drive")]
    found = dict(zip(keys, multi_drive_page.rows, strict=True))
    return found | {row.what: row for row in multi_drive_page.own}


def test_tasks_can_be_sent_to_processes_and_have_names_of_their_own():
    runs = PAPER.runs()
    assert len({run.name for run in runs}) == len(runs)
    assert pickle.loads(pickle.dumps(runs)) == runs


def test_no_row_is_missed(multi_drive_page):
    assert multi_drive_page.missed == ()


def test_table_3_stands_there_in_full(multi_drive_page):
    table = [row for row in multi_drive_page.rows if row.place.startswith("Table 3")]
    assert [row.printed for row in table] == [
        "354.4 m", "0.13 km/h", "0 km/h", "0.55 s", "0.50 s", "9.33 %", "0 %", "yes", "no effect",
        "93.2 N·m", "75.13 N·m", "0 %", "19 %", "3.48 m²", "2.8188 m²",
    ]  # fmt: skip # the table


def test_formulas_and_limits_are_by_construction(rows):
    for by in ("differential", "straight", "curve", "launch torque", "slope", "right curve"):
        assert rows[by].verdict == "by construction"


def test_a_contradiction_is_shown_with_what_comes_out(rows):
    assert rows["rise MIMO-PID"].obtained == "4.35 s; 0.50 s need 2.7 g of 0.32 g"
    assert rows["distance MIMO-PID"].obtained == "167.1 m in 10 s; the printed one takes 27.6 s"
    assert rows["slope torque"].obtained == "3811 N; 1371.9 N·m with R"


def test_both_torques_of_the_air_stand_there(rows):
    assert rows["torque of the air at 60 km/h and 1.2 kg/m³"].obtained == "96.05 N·m"
    assert rows["air PIDs"].obtained == "at 1.164 kg/m³: 93.17 N·m"


def test_the_fair_baseline_stands_beside_the_comparison(rows):
    dips = rows["dip of the speed on the slope"].obtained
    assert dips == "MIMO-PID: 0.907 km/h; PIDs: 1.09 km/h; PIDs with gains x 1.5: 0.907 km/h"
    assert "gains x 1.5" in rows["dip"].reason
    assert "gains x 1.5" in rows["error"].reason


def test_a_number_that_is_off_is_missed(multi_drive_runs):
    """The PIDs in the place of the MIMO-PID."""
    page = PAPER.page(multi_drive_runs | {"mimo": multi_drive_runs["pid"]})
    missed = {row.what for row in page.missed}
    assert "dip of the speed on the slope" in missed
    assert "MIMO-PID has a smaller error than the PIDs: rms of the left wheel's" in missed


def test_coupling_acts_on_equal_errors_as_gain_does(multi_drive_runs):
    """Up to where the loop of 100 Hz fails; what the coupling changes is the parting of the wheels."""
    for kappa in (0.25, 0.5, 0.75):
        mimo, pid = multi_drive_runs[f"coupling {kappa}"]
        assert mimo.dip == pytest.approx(pid.dip, rel=0.01)
        assert mimo.error == pytest.approx(pid.error, rel=0.05)
        assert mimo.parting < (1.0 - 0.8 * kappa) / (1.0 + 0.8 * kappa) * pid.parting
    assert all(effect.error > 0.7 for effect in multi_drive_runs["coupling 1.0"])
