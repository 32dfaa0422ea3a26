"""The page of the two-motor car: its rows, their verdicts, and its pictures."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from evcosim.master.reproduce import papers
from evcosim.master.reproduce.multi_drive_pictures import phase_currents
from evcosim.master.reproduce.render import write_page
from evcosim.models import multi_drive_analysis as analysis
from evcosim.models.two_motor_vehicle import TwoMotorVehicle
from evcosim.models.wheel_speed_controller import TORQUE_LIMIT

PAPER = papers.load("multi_drive")


@pytest.fixture(scope="module")
def found():
    return {task.name: task() for task in PAPER.runs()}


@pytest.fixture(scope="module")
def page(found):
    return PAPER.page(found)


@pytest.fixture(scope="module")
def rows(page):
    return {row.what: row for row in page.rows}


def test_tasks_can_be_sent_to_processes_and_have_names_of_their_own():
    runs = PAPER.runs()
    assert len({run.name for run in runs}) == len(runs)
    assert pickle.loads(pickle.dumps(runs)) == runs


def test_no_row_is_missed(page):
    assert page.missed == ()


def test_every_contradiction_of_the_paper_has_a_row(page):
    """But the air's torque, which another density gives."""
    named = {row.what: row for row in page.rows if row.verdict == "not reproducible"}
    claims = {c.what: c for c in analysis.claims(TwoMotorVehicle.Parameters(), 60.0 / 3.6, TORQUE_LIMIT)}
    del claims["torque of the air"]
    assert set(named) == {*claims, "integral gain in (6)"}
    for what, claim in claims.items():
        assert (named[what].published, named[what].reason) == (claim.printed, claim.reason)


def test_what_was_chosen_is_calibrated(page):
    calibrated = [row for row in page.rows if row.verdict == "calibrated"]
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


def test_a_number_that_is_off_is_missed(found):
    """The PIDs in the place of the MIMO-PID."""
    page = PAPER.page(found | {"mimo": found["pid"]})
    missed = {row.what for row in page.missed}
    assert "dip of the speed on the slope: MIMO-PID" in missed
    assert "dip of the speed on the slope: MIMO-PID below the PIDs' by" in missed


def test_coupling_acts_on_equal_errors_as_gain_does(found):
    """Up to where the loop of 100 Hz fails; what the coupling changes is the parting of the wheels."""
    for kappa in (0.25, 0.5, 0.75):
        mimo, pid = found[f"coupling {kappa}"]
        assert mimo.dip == pytest.approx(pid.dip, rel=0.01)
        assert mimo.error == pytest.approx(pid.error, rel=0.05)
        assert mimo.parting < (1.0 - 0.8 * kappa) / (1.0 + 0.8 * kappa) * pid.parting
    assert all(effect.error > 0.7 for effect in found["coupling 1.0"])


def test_phase_currents_are_three_sines_of_the_effective_value(found):
    drawn = phase_currents(found["mimo"], 2.5, 2.9)
    phases = np.array([drawn[name] for name in "abc"])
    assert np.abs(phases.sum(axis=0)).max() < 1e-9
    effective = float(np.interp(2.7, found["mimo"].time, found["mimo"]["left_drive.current"]))
    assert np.sqrt(np.mean(phases**2)) == pytest.approx(effective, rel=1e-4)
    rising = np.count_nonzero((phases[0, :-1] < 0.0) & (phases[0, 1:] >= 0.0))
    assert rising / 0.4 == pytest.approx(148.6, abs=2.5)  # two pole pairs, gear 10, 46.66 rad/s, and the slip


def test_the_pictures_are_those_of_the_paper_and_four_more(page, tmp_path):
    stems = [picture.stem for picture in page.pictures]
    assert stems[:6] == ["speeds", "torques", "resistance", "currents", "phases", "launch"]
    assert stems[6:] == ["baseline", "jump", "coupling", "machine"]
    assert all("Figs. 4 to 19" in picture.caption for picture in page.pictures[:5])
    written = {path.name for path in write_page(page, tmp_path)}
    assert {"multi_drive.md", "multi_drive.html"} <= written
    for stem in stems:
        assert {f"multi_drive-{stem}.png", f"multi_drive-{stem}.svg"} <= written
