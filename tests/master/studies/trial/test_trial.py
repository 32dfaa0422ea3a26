"""A trial says of a vehicle in C what is known of it: its signs, units, steps, state and ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import MapTables, UnitEntry, load_system
from evcosim.master.studies.trial.trial import Trial, try_unit
from support.c_fmu import mixed_fmu, vehicle_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

MAP = {
    "inputs": {"throttle": "pedal", "brake_force": {"variable": "F_brake", "invert": True}},
    "outputs": {"speed": {"variable": "v", "unit": "m/s"}, "power": "P", "distance": "s"},
}
NAMES = ("throttle", "brake_force", "speed", "power", "distance")


def tried(place: str, names: tuple[str, ...], entry: UnitEntry, **limits: float) -> Trial:
    system = load_system(place.partition(".")[0])
    scenario = load_scenario(system, None)
    return try_unit(system, scenario, place.partition(".")[2], entry, names, **{"duration": 1.0, **limits})


def vehicle(folder: Path, fmi: int, *flags: str, **changed: str) -> Trial:
    fmu = vehicle_fmu(folder / "Vehicle.fmu", fmi, *flags, **changed)
    entry = UnitEntry(fmu=str(fmu), map=MapTables.model_validate(MAP))
    return tried("scooter.vehicle", NAMES, entry)


def verdicts(trial: Trial) -> dict[str, str]:
    return {finding.what: finding.verdict for finding in trial.findings}


def text(trial: Trial, what: str) -> str:
    return next(finding.text for finding in trial.findings if finding.what == what)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_vehicle_that_reacts_as_ours_passes(tmp_path: Path, fmi: int) -> None:
    """It is told a stop time in every run, and never stepped beyond it: both would be an error of its own."""
    names = {2: "canGetAndSetFMUstate", 3: "canGetAndSetFMUState"}
    declared = {'modelIdentifier="vehicle"': f'modelIdentifier="vehicle" {names[fmi]}="true"'}
    trial = vehicle(tmp_path, fmi, "-DSTATE=1", "-DNEEDS_STOP", **declared)
    assert trial.passed, trial.findings
    assert set(verdicts(trial).values()) == {"good"}
    assert {"throttle -> speed", "brake_force -> speed", "brake_force -> power"} <= set(verdicts(trial))
    assert text(trial, "state") == "is saved, and restored to the last bit"
    assert trial.proposal.substeps == 1
    assert not trial.proposal.invert


def test_a_throttle_that_lowers_the_speed_and_a_state_that_does_not_come_back(tmp_path: Path) -> None:
    declared = {'modelIdentifier="vehicle"': 'modelIdentifier="vehicle" canGetAndSetFMUstate="true"'}
    trial = vehicle(tmp_path, 2, "-DBACKWARD", "-DSTATE=2", **declared)
    assert "lowers it by up to" in text(trial, "throttle -> speed")
    assert "the other sign; that of the system raises it" in text(trial, "throttle -> speed")
    assert set(trial.proposal.invert) == {("inputs", "throttle")}
    assert text(trial, "state") == (
        "declares that it saves its state, but what it restores goes on otherwise"
    )
    assert verdicts(trial)["state"] == "note"
    assert not trial.passed


def test_a_speed_in_another_unit_of_measure_and_an_input_that_is_cut_off(tmp_path: Path) -> None:
    """A pedal that goes to 0.8 alone, where the bus gives up to 100 %."""
    changed = {'unit="1" start="0"': 'unit="1" start="0" min="0" max="0.8"'}
    trial = vehicle(tmp_path, 2, "-DIN_KMH", **changed)
    found = verdicts(trial)
    assert "3.6 times as much as it should: is its unit of measure another one (km/h beside m/s)?" in text(
        trial, "throttle -> speed"
    )
    assert found["throttle -> speed"] == found["brake_force -> speed"] == "problem"
    assert found["throttle -> power"] == "good"
    assert found["range of throttle"] == "problem"
    assert text(trial, "range of throttle") == "the system can give 0 to 1 [1], the FMU takes from 0 to 0.8"
    assert not trial.proposal.invert


def test_a_vehicle_that_needs_smaller_steps_goes_on_with_them(tmp_path: Path) -> None:
    trial = vehicle(tmp_path, 3, "-DSTIFF", "-DSTATE=1")
    assert text(trial, "steps").startswith("of 10, 5, 2 ms differ from those of 1 ms by more than 1000 %")
    assert trial.proposal.substeps in (5, 10)
    assert verdicts(trial)["throttle -> speed"] == "good"
    assert verdicts(trial)["values of power"] == "problem"  # what it gave with steps of 10 ms
    assert text(trial, "state").startswith("does not declare that it saves its state; it does")


# ---- FMUs that misbehave


def mixed(folder: Path, behavior: int, fmi: int = 2, **limits: float) -> Trial:
    """sources/mixed.c, which misbehaves from 0.5 s on, in the place of the scooter's battery."""
    tables = {
        "inputs": {"power": {"variable": "u", "unit": "W"}},
        "outputs": {"voltage": {"variable": "y", "unit": "V"}},
    }
    fmu = mixed_fmu(folder / "mixed.fmu", fmi, behavior)
    entry = UnitEntry(fmu=str(fmu), map=MapTables.model_validate(tables))
    return tried("scooter.battery", ("power", "voltage"), entry, **{"answer": 0.5, **limits})


@pytest.mark.parametrize(
    ("behavior", "said"),
    [
        (1, "cannot be instantiated"),
        (2, "voltage = nan V: an output must be finite"),
        (13, "fmi2DoStep returned Error (3)"),
        (50, "its process was killed by SIGSEGV"),
        (52, "ended by itself with exit code 0: the FMU called exit()"),
        (54, "did not answer for 0.5 s (step_timeout) and was ended"),
        (61, "asked for terminate"),
    ],
)
def test_what_an_fmu_does_is_told_and_stops_no_more_than_its_trial(
    tmp_path: Path, behavior: int, said: str
) -> None:
    trial = mixed(tmp_path, behavior)
    assert not trial.passed
    assert said in text(trial, "constant inputs")
    assert verdicts(trial)["trial"] == "problem"
    assert "status" not in verdicts(trial)
    assert any(said in remark for remark in trial.proposal.remarks)


def test_an_fmu_that_ends_the_trial(tmp_path: Path) -> None:
    trial = mixed(tmp_path, 3, fmi=3)
    assert text(trial, "constant inputs") == (
        "unit 'battery' asked to end the simulation at t = 0.51 s, before the end of the trial"
    )
    assert not trial.passed


def test_a_trial_ends_in_time(tmp_path: Path) -> None:
    trial = mixed(tmp_path, 0, limit=0.05)
    assert trial.findings[-1].what == "time"
    assert trial.findings[-1].text == "ended after 0.05 s; what is not told was not tried"


@pytest.mark.parametrize("stop", [0.29, 0.57, 1.13])
def test_a_trial_of_any_duration_ends_at_the_stop_time_that_it_told(tmp_path: Path, stop: float) -> None:
    """It is of whole periods, whatever those of the present unit are."""
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2, "-DNEEDS_STOP")
    entry = UnitEntry(fmu=str(fmu), map=MapTables.model_validate(MAP), period=0.03, substeps=7)
    trial = tried("scooter.vehicle", NAMES, entry, duration=stop)
    assert trial.duration == pytest.approx(0.03 * round(stop / 0.03))
    assert "returned Error" not in str(trial.findings), trial.findings
    assert {"steps", "speed", "state", "status"} <= set(verdicts(trial))


def test_the_warnings_of_a_trial_are_shown_with_their_text(tmp_path: Path) -> None:
    trial = mixed(tmp_path, 11, duration=0.6)
    runs, _, warned = text(trial, "status").partition(" of 0.6 s, ")
    count, _, said = warned.partition(" warnings: ")
    assert said == f"as it was told, 100 % (and {int(count) // 2 - 1} alike)"  # each beside a status
    assert int(count) > 2 * 5 * int(runs.removesuffix(" runs"))


def test_an_output_that_reacts_otherwise_is_told(tmp_path: Path) -> None:
    """A lag of the input is no battery: its "voltage" rises with the power."""
    trial = mixed(tmp_path, 0, duration=0.4)
    assert "raises it by up to" in text(trial, "power -> voltage")
    assert "that of the system lowers it" in text(trial, "power -> voltage")
