"""The bench of a trial runs one unit alone, in the units of measure of the system, and ends in time."""

from __future__ import annotations

import time

import numpy as np
import pytest

from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import MapTables, UnitEntry, load_system
from evcosim.master.studies.trial.bench import Bench, Deadline, OutOfTime, largest
from support.c_fmu import mixed_fmu, typed_fmu, vehicle_fmu

NAMES = ("throttle", "speed", "power", "nothing like it")
DRIVE = {"throttle": [(0.0, 0.0), (0.5, 50.0)]}


def deadline(seconds=60.0):
    return Deadline(time.monotonic() + seconds, 10.0)


def bench(entry=None, ours=None, duration=1.0):
    system = load_system("scooter")
    entry = entry or system.file.units["vehicle"]
    return Bench(system, load_scenario(system, "fig8"), "vehicle", entry, ours, NAMES, duration)


def test_the_present_unit_alone():
    ours = bench()
    assert ours.outputs == ["throttle", "speed", "power"]
    assert {"throttle", "brake_force", "road_grade"} <= set(ours.inputs)
    assert (ours.period, ours.isolation) == (0.01, None)
    found = ours.run(DRIVE, deadline())
    assert found["speed"].shape == (101,)
    assert found["throttle"][25] == pytest.approx(25.0)
    assert found["speed"][-1] > found["speed"][0]


def test_the_outputs_of_another_are_in_our_units_of_measure(tmp_path):
    ours = bench()
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    map_ = {
        "inputs": {"throttle": "pedal"},
        "outputs": {"speed": {"variable": "v", "unit": "m/s"}, "power": "P"},
    }
    entry = UnitEntry(fmu=str(fmu), map=MapTables.model_validate(map_), substeps=2)
    theirs = bench(entry, ours.interface)
    assert theirs.isolation == "process"
    assert theirs.to_ours("throttle").scale == pytest.approx(100.0)  # a pedal of 0 to 1
    assert theirs.from_ours("throttle")(100.0) == pytest.approx(1.0)
    assert theirs.run(DRIVE, deadline())["throttle"][25] == pytest.approx(25.0)


def test_a_duration_of_whole_periods():
    assert bench(duration=0.123).duration == pytest.approx(0.12)
    assert bench(duration=1e-6).duration == pytest.approx(0.01)


def test_nothing_runs_after_the_deadline():
    with pytest.raises(OutOfTime, match="the time limit of the trial has passed"):
        bench().run(DRIVE, deadline(-1.0))


def test_the_largest_magnitude():
    assert largest(np.array([1.0, -3.0, 2.0])) == 3.0
    assert largest(np.array([])) == 0.0


def test_an_integer_input_gets_whole_numbers(tmp_path):
    """The waves of a trial pass between two of them."""
    mixed_fmu(tmp_path / "mixed.fmu", 2)
    (tmp_path / "one.toml").write_text(
        'name = "one"\n[experiment]\nstop_time = 1.0\nstep_size = 0.1\n[units.a]\nfmu = "mixed.fmu"\n'
    )
    system = load_system(str(tmp_path / "one.toml"))
    entry, scenario = system.file.units["a"], load_scenario(system, None)
    one = Bench(system, scenario, "a", entry, None, ("count", "y"), 1.0)
    drive = {"count_in": [(0.0, 0.4), (0.5, 1.6)], "u": [(0.0, 0.4)]}
    found = one.run(drive, deadline())
    assert [found["count"][k] for k in (1, 5, 6, 10)] == [1.0, 1.0, 3.0, 3.0]
    assert found["y"][1] == pytest.approx(0.04)


def test_texts_are_neither_moved_nor_looked_at(tmp_path):
    typed_fmu(tmp_path / "typed.fmu", 2)
    (tmp_path / "one.toml").write_text(
        'name = "one"\n[experiment]\nstop_time = 1.0\nstep_size = 0.1\n[units.a]\nfmu = "typed.fmu"\n'
    )
    system = load_system(str(tmp_path / "one.toml"))
    entry, scenario = system.file.units["a"], load_scenario(system, None)
    one = Bench(system, scenario, "a", entry, None, ("flag", "text"), 1.0)
    assert (one.outputs, one.inputs) == (["flag"], ["flag_in", "state_in", "count_in"])
    found = one.run({"text_in": [(0.0, 0.0)], "flag_in": [(0.0, 0.0), (0.5, 1.0)]}, deadline())
    assert list(found) == ["flag"] and set(found["flag"]) == {0.0, 1.0}
