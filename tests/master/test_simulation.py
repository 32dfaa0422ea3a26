"""The Python interface with real FMUs: loops of one's own, events, swaps, failures, what stays behind."""

from __future__ import annotations

import gc
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from evcosim import Simulation, simulate
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.results.results import Results
from evcosim.fmus import build
from evcosim.master.builtin import build_fmu
from evcosim.master.fmi.fmu import FmuError


def test_simulate_gives_arrays_with_units():
    results = simulate("scooter", stop_time=2.0, parameters={"vehicle.mass": 180.0})
    assert len(results) == 201
    assert results.time[-1] == 2.0
    assert results["vehicle.speed"].shape == results.time.shape
    assert results.units["vehicle.speed"] == "m/s"
    assert results["ecu.state"].dtype == np.int64
    assert results.manifest["units"]["vehicle"]["parameters"] == {"mass": 180.0}


def test_stepping_is_running():
    whole = simulate("scooter", stop_time=5.0)
    with Simulation("scooter", stop_time=5.0) as sim:
        for steps in (1, 99, 300, 100):
            sim.step(steps)
        assert sim.finished
        assert np.array_equal(sim.results.data, whole.data)


def test_a_value_is_that_of_now():
    with Simulation("scooter") as sim:
        sim.step(200)
        assert sim.time == 2.0
        assert sim["vehicle.speed"] == sim.results["vehicle.speed"][-1]
        assert sim["vehicle.mass"] == 200.0  # a parameter, asked of the FMU itself
        assert sim["ecu.throttle"] == sim.results["ecu.throttle"][-1]


def test_setting_a_free_input_acts_from_the_next_step_on():
    with Simulation("scooter") as sim:
        sim.step(1000)
        before = sim["vehicle.acceleration"]
        sim.set("vehicle.road_grade", 0.05)
        sim.step(1)
        grade = sim.results["vehicle.road_grade"]
        assert grade[999] == 0.0
        assert grade[1000] == 0.05
        # M g (sin th + C_r (cos th - 1)) / M
        expected = before - 9.81 * (np.sin(0.05) + 0.014 * (np.cos(0.05) - 1.0))
        assert sim.results["vehicle.acceleration"][1000] == pytest.approx(expected, abs=1e-9)


def test_a_sensor_that_is_overridden_biased_and_reset():
    with Simulation("scooter") as sim:
        sim.step(1200)
        sim.bias("ecu.speed_measured", -3.0)
        sim.step(100)
        sim.override("ecu.speed_measured", 20.0)
        sim.step(100)
        sim.reset("ecu.speed_measured")
        sim.step(100)
        results = sim.results
    seen, true = results["ecu.speed_measured"], np.round(results["vehicle.speed"] * 3.6)
    assert np.array_equal(seen[:1200], true[:1200])
    assert np.array_equal(seen[1200:1300], true[1200:1300] - 3.0)
    assert set(seen[1300:1400]) == {20.0}
    assert np.array_equal(seen[1400:1500], true[1400:1500])


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("vehicle.road_grad", 0.0, r"no input \(did you mean|no variable 'road_grad'"),
        ("vehicel.road_grade", 0.0, r"no unit 'vehicel' \(did you mean 'vehicle'\?\)"),
        (
            "vehicle.speed",
            1.0,
            "speed is of causality output; inputs that nothing drives and tunable parameters",
        ),
        (
            "vehicle.throttle",
            1.0,
            r"driven by ecu.throttle via can0.VCU_Request.\w+; use override",
        ),
        ("ecu.throttle_request", 1.0, "driven by a stimulus of .*fig8.toml; use override"),
        ("vehicle.road_grade", 9.0, "9.0 rad is above the maximum 1.5 rad"),
        ("vehicle.road_grade", float("nan"), "finite Real number, not nan"),
    ],
)
def test_what_cannot_be_set_says_why(name, value, said):
    with Simulation("scooter") as sim, pytest.raises(ConfigError, match=said):
        sim.set(name, value)


@pytest.fixture
def other_battery(tmp_path):
    path = build.build("Battery", tmp_path)
    moved = tmp_path / "supplier.fmu"
    path.rename(moved)
    return moved


def test_another_fmu_in_the_place_of_a_unit(other_battery):
    ours = simulate("scooter", stop_time=3.0)
    theirs = simulate("scooter", stop_time=3.0, fmus={"battery": other_battery})
    assert np.array_equal(ours.data, theirs.data)
    assert theirs.manifest["units"]["battery"]["file"] == "supplier.fmu"


def test_an_fmu_with_other_variables_is_refused_before_any_step():
    battery = build.built("Battery")
    with pytest.raises(ConfigError, match=r"connect .*: unit 'vehicle' has no variable 'speed'"):
        Simulation("scooter", fmus={"vehicle": battery})


def test_a_unit_that_is_not_there_cannot_be_swapped():
    with pytest.raises(ConfigError, match=r"no unit 'batery' \(did you mean 'battery'\?\)"):
        Simulation("scooter", fmus={"batery": "x.fmu"})


def test_not_an_fmu(tmp_path):
    text = tmp_path / "battery.fmu"
    text.write_text("no zip")
    with pytest.raises(FmuError, match=r"battery.fmu: is not an FMU"):
        Simulation("scooter", fmus={"battery": text})


def test_parameters_that_contradict_each_other_are_the_fmus_own_error():
    """Within every declared range, but the FMU itself refuses: its message arrives, and nothing is left."""
    with pytest.raises((ConfigError, RunError)) as caught:
        Simulation("scooter", parameters={"vehicle.mass": 0.0})
    assert "mass" in str(caught.value)
    assert "0.0 kg is below the minimum 1.0 kg" in str(caught.value)


def test_nothing_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    simulate("scooter", stop_time=0.1)
    with pytest.raises(ConfigError):
        Simulation("scooter", parameters={"vehicle.mass": -1.0})
    gc.collect()
    assert [p for p in Path(tmp_path).iterdir() if p.name.startswith("evcosim-")] == []


@pytest.mark.parametrize("name", ["with space", "größer", "a#b", "50%", "a%41b"])
def test_a_temporary_folder_of_any_name(tmp_path, monkeypatch, name):
    (tmp_path / name).mkdir()
    copy = build_fmu("Scooter", tmp_path).path  # the one in the cache is unpacked already
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / name))
    assert len(simulate("scooter", fmus={"vehicle": copy}, stop_time=0.1)) == 11


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere names of files are not bytes")
@pytest.mark.parametrize(("name", "said"), [("a%20b", "read as a space"), (b"\xe4", "not UTF-8")])
def test_a_temporary_folder_that_an_fmu_cannot_be_told(tmp_path, monkeypatch, name, said):
    folder = tmp_path / os.fsdecode(name)
    folder.mkdir()
    copy = build_fmu("Scooter", tmp_path).path
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    with pytest.raises(ConfigError, match=f"the temporary folder .*{said}; set TMPDIR"):
        simulate("scooter", fmus={"vehicle": copy}, stop_time=0.1)
    assert not list(folder.iterdir())


def test_two_simulations_at_once_do_not_meet():
    alone = simulate("scooter", stop_time=3.0)
    with Simulation("scooter") as a, Simulation("scooter", parameters={"vehicle.mass": 150.0}) as b:
        for _ in range(3):
            a.step(100)
            b.step(100)
        assert np.array_equal(a.results.data, alone.data)
        assert a["vehicle.speed"] < b["vehicle.speed"]


def test_results_survive_the_end_of_the_simulation(tmp_path):
    with Simulation("scooter", stop_time=1.0) as sim:
        sim.run()
        results = sim.results
    results.write(tmp_path / "out")
    again = Results.read(tmp_path / "out")
    assert np.array_equal(again.data, results.data)
    assert again.units == results.units


def test_progress_reaches_the_stop_time():
    seen = []
    simulate("scooter", stop_time=60.0, progress=lambda now, stop: seen.append((now, stop)))
    assert seen[-1] == (60.0, 60.0)
    assert [now for now, _ in seen] == sorted(now for now, _ in seen)
    assert len(seen) > 1


@pytest.mark.parametrize("engine", ["compiled", "python"])
def test_a_closed_simulation_calls_no_unit(engine: str) -> None:
    with Simulation("scooter", stop_time=1.0, engine=engine) as sim:
        sim.step(10)
        speed = sim["vehicle.speed"]
    for call in (
        sim.step,
        sim.run,
        lambda: sim["vehicle.mass"],
        lambda: sim.set("vehicle.road_grade", 0.0),
        lambda: sim.override("ecu.speed_measured", 0.0),
    ):
        with pytest.raises(RunError, match="the simulation is closed"):
            call()
    assert (sim["vehicle.speed"], len(sim.results)) == (speed, 11)


def test_a_run_does_not_step_back() -> None:
    with Simulation("scooter", stop_time=1.0) as sim, pytest.raises(ConfigError, match="steps = -1"):
        sim.step(-1)


def test_steps_without_end_are_refused_as_such_a_stop_time_is() -> None:
    said = (
        r" steps of 0\.01 s with 28 recorded variables are more than the 2\.15e\+09 values that a run keeps"
    )
    with Simulation("scooter", stop_time=1.0) as sim:
        sim.step(150)  # which units were not told
        for steps in (10**9, 2**63, 10**400):
            with pytest.raises(ConfigError, match=f"^steps = .* after 150: .*{said}"):
                sim.step(steps)
        assert len(sim.results) == 151
    with pytest.raises(ConfigError, match=f"^stop_time: 1e\\+11{said}"):
        Simulation("scooter", stop_time=1e9)
    with Simulation("scooter", stop_time=1.0, to_stop=True) as sim:
        with pytest.raises(ConfigError, match=r"100 are left to the stop time 1\.0 s"):
            sim.step(10**9)
        sim.step(100)
        with pytest.raises(ConfigError, match="steps = 1: 0 are left"):
            sim.step()
