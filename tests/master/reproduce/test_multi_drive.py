"""The page of the two-motor car: its rows, their verdicts, and its pictures."""

from __future__ import annotations

import pickle

import pytest

from evcosim.master.reproduce import papers
from evcosim.models import multi_drive_analysis as analysis
from evcosim.models.two_motor_vehicle import TwoMotorVehicle
from evcosim.models.wheel_speed_controller import TORQUE_LIMIT

PAPER = papers.load("multi_drive")


@pytest.fixture(scope="module")
def rows(multi_drive_page):
    return {row.what: row for row in multi_drive_page.rows}


def test_tasks_can_be_sent_to_processes_and_have_names_of_their_own():
    runs = PAPER.runs()
    assert len({run.name for run in runs}) == len(runs)
    assert pickle.loads(pickle.dumps(runs)) == runs


def test_no_row_is_missed(multi_drive_page):
    assert multi_drive_page.missed == ()


def test_every_contradiction_of_the_paper_has_a_row(multi_drive_page):
    """But the air's torque, which another density gives."""
    named = {row.what: row for row in multi_drive_page.rows if row.verdict == "not reproducible"}
    claims = {c.what: c for c in analysis.claims(TwoMotorVehicle.Parameters(), 60.0 / 3.6, TORQUE_LIMIT)}
    del claims["torque of the air"]
    assert set(named) == {*claims, "integral gain in (6)"}
    for what, claim in claims.items():
        assert (named[what].published, named[what].reason) == (claim.printed, claim.reason)


def test_what_was_chosen_is_calibrated(multi_drive_page):
    calibrated = [row for row in multi_drive_page.rows if row.verdict == "calibrated"]
    assert [row.published for row in calibrated] == ["93.2 N·m", '"better"', '"better"']
    assert all(row.reason for row in calibrated)


def test_both_torques_of_the_air_stand_there(rows):
    assert rows["torque of the air at 60 km/h and 1.2 kg/m³"].obtained == "96.05 N·m"
    assert rows["torque of the air at 60 km/h and 1.164 kg/m³"].obtained == "93.17 N·m"


def test_the_fair_baseline_stands_beside_the_comparison(rows):
    dip = "dip of the speed on the slope"
    assert rows[f"{dip}: MIMO-PID"].obtained == rows[f"{dip}: PIDs with gains x 1.5"].obtained == "0.907 km/h"
    assert rows[f"{dip}: PIDs"].obtained == "1.09 km/h"
    assert "1 + κ" in rows[f"{dip}: PIDs with gains x 1.5"].reason


def test_a_number_that_is_off_is_missed(multi_drive_runs):
    """The PIDs in the place of the MIMO-PID."""
    page = PAPER.page(multi_drive_runs | {"mimo": multi_drive_runs["pid"]})
    missed = {row.what for row in page.missed}
    assert "dip of the speed on the slope: MIMO-PID" in missed
    assert "dip of the speed on the slope: MIMO-PID below the PIDs' by" in missed


def test_coupling_acts_on_equal_errors_as_gain_does(multi_drive_runs):
    """Up to where the loop of 100 Hz fails; what the coupling changes is the parting of the wheels."""
    for kappa in (0.25, 0.5, 0.75):
        mimo, pid = multi_drive_runs[f"coupling {kappa}"]
        assert mimo.dip == pytest.approx(pid.dip, rel=0.01)
        assert mimo.error == pytest.approx(pid.error, rel=0.05)
        assert mimo.parting < (1.0 - 0.8 * kappa) / (1.0 + 0.8 * kappa) * pid.parting
    assert all(effect.error > 0.7 for effect in multi_drive_runs["coupling 1.0"])
