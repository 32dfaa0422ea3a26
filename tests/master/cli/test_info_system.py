"""`evcosim info SYSTEM` shows every system that `run` takes, and those that this machine cannot run."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from evcosim.cosim.system.system import load_system
from support.c_fmu import vehicle_fmu

MAPPED = """fmu = "Vehicle.fmu"
absent = ["power", "distance"]
[units.vehicle.map.inputs]
throttle = "pedal"
brake_force = { variable = "F_brake", invert = true }
road_grade = "slope"
[units.vehicle.map.outputs]
speed = { variable = "v", unit = "m/s" }
[units.vehicle.map.parameters]
mass = "m_total"
"""


@pytest.fixture
def mapped(tmp_path: Path) -> Path:
    """The scooter's system with a vehicle whose variables have other names, two of which it lacks."""
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    path = tmp_path / "mine.toml"
    path.write_text(load_system("scooter").path.read_text().replace('fmu = "Scooter"', MAPPED))
    return path


def without_binary(path: Path, folder: str) -> None:
    """Move the libraries of an FMU to where those of another machine stand."""
    with zipfile.ZipFile(path) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            parts = name.split("/")
            archive.writestr(f"binaries/{folder}/{parts[2]}" if parts[0] == "binaries" else name, content)


def connections(evcosim, system: Path) -> dict[str, dict[str, str]]:
    """Return the entry of each connection, by its receiver."""
    return {c["to"]: c for c in evcosim("info", system, "--json").json["connections"] if c["to"]}


def test_mapped_and_absent_variables(evcosim, mapped: Path) -> None:
    answer = evcosim("info", mapped)
    assert (answer.code, answer.err) == (0, "")
    for text in ("vehicle.speed [m/s]", "Vehicle.fmu", "ecu.speed_measured [km/h]", "Units, in the order"):
        assert text in answer.out
    shown = connections(evcosim, mapped)
    assert shown["ecu.speed_measured"]["from_unit"] == "m/s"
    assert shown["vehicle.throttle"]["from"] == "ecu.throttle"
    assert not {"battery.power", "battery.distance"} & shown.keys()  # nobody gives them any more


def test_what_is_left_out_is_told_as_by_a_run(evcosim, mapped: Path) -> None:
    about = evcosim("info", mapped, "--json").json
    left_out = "left out, since it is absent: "
    assert about["warnings"] == [
        f"{left_out}vehicle.power -> battery.power; a receiver keeps its start value",
        f"{left_out}metric 'distance'",
        f"{left_out}metric 'energy per distance'",
        *(
            f"left out, since the FMU has no vehicle.{wheel}_wheel_speed: vehicle.{wheel}_wheel_speed -> "
            f"ecu.{wheel}_wheel_speed; a receiver keeps its start value"
            for wheel in ("front", "rear")
        ),
        "left out, since the FMU has no vehicle.available_power: battery.available_power -> "
        "vehicle.available_power",
        "left out of the figure, since it is not recorded: vehicle.acceleration",
    ]
    run = evcosim("run", mapped, "--stop-time", "0.1", "--no-plot", "--output", "out", "--json")
    assert run.code == 0, run.err
    assert {text for text in run.json["warnings"] if text.startswith("left out")} >= set(about["warnings"])


def test_the_diagram_of_mapped_and_absent_variables(evcosim, mapped: Path, tmp_path: Path) -> None:
    answer = evcosim("info", mapped, "--diagram", tmp_path / "mine.svg")
    assert (answer.code, answer.err) == (0, "")
    picture = (tmp_path / "mine.svg").read_text()
    assert "<svg" in picture


def test_an_fmu_without_a_binary_for_this_machine(evcosim, mapped: Path, tmp_path: Path) -> None:
    without_binary(tmp_path / "Vehicle.fmu", "plan9")
    answer = evcosim("info", mapped)
    assert (answer.code, answer.err) == (0, "")
    assert "vehicle.speed [m/s]" in answer.out
    refused = evcosim("run", mapped, "--no-plot")
    assert refused.code == 2
    assert "has no binary for this machine" in refused.err
    assert evcosim("info", mapped, "--diagram", tmp_path / "mine.png").code == 0
    assert (tmp_path / "mine.png").stat().st_size > 10_000


def test_a_parameter_of_a_mapped_unit(evcosim, mapped: Path) -> None:
    text = mapped.read_text().replace('absent = ["power"', 'parameters = { mass = 150.0 }\nabsent = ["power"')
    mapped.write_text(text)
    units = {unit["name"]: unit for unit in evcosim("info", mapped, "--json").json["units"]}
    assert units["vehicle"]["parameters"] == {"mass": 150.0}


def test_what_is_wrong_in_it_is_told_as_by_a_run(evcosim, mapped: Path) -> None:
    mapped.write_text(mapped.read_text().replace('"F_brake"', '"F_brakes"'))
    shown, run = evcosim("info", mapped), evcosim("run", mapped, "--scenario", "ece15")
    assert shown.code == run.code == 2
    assert "F_brakes" in shown.err
    assert shown.err == run.err


def test_info_of_a_system(evcosim, tmp_path):
    answer = evcosim("info", "scooter")
    assert answer.code == 0
    for text in ("vehicle.speed [m/s]", "can0.EMD_Status.EMD_VehicleSpeed", "(x 3.6)", "0.4 %", "fig8 *"):
        assert text in answer.out
    data = evcosim("info", "scooter", "--json").json
    assert [unit["name"] for unit in data["units"]] == ["rider", "planner", "ecu", "vehicle", "battery"]
    speed = next(c for c in data["connections"] if c["to"] == "ecu.speed_measured")
    assert (speed["from_unit"], speed["bus_unit"], speed["to_bus"], speed["to_receiver"]) == (
        "m/s",
        "km/h",
        "x 3.6",
        "",
    )


def test_a_factor_is_shown_as_it_is_written(evcosim, tmp_path: Path) -> None:
    system = tmp_path / "mine.toml"
    system.write_text(
        'name = "mine"\n[units.a]\nfmu = "Rider"\n[units.b]\nfmu = "Battery"\n'
        '[units.b.map.inputs]\nload = { variable = "power", unit = "A", factor = 48.0 }\n'
        '[[connect]]\nfrom = "a.brake_force"\nto = ["b.load"]\nfactor = 0.5\noffset = -1\n'
    )
    shown = connections(evcosim, system)["b.load"]
    assert (shown["to_receiver"], shown["written"]) == ("x 0.5 - 1", "factor = 0.5, offset = -1")
    text = " ".join(evcosim("info", system).out.split())
    assert "b.load [A] (x 0.5 - 1) (factor = 0.5, offset = -1)" in text
    assert "b.load: factor = 48" in text


def test_a_scenario_s_logs_are_shown_with_the_frames_that_they_would_replay(evcosim, tmp_path: Path):
    frame = "can0 148#" + "00" * 8
    (tmp_path / "a.log").write_text(f"(5.0) {frame}\n(5.01) {frame}\n(500.0) {frame}\n")
    scenario = tmp_path / "s.toml"
    panel = "{ signals = ['ecu.throttle'], unit = '%' }"
    left_out = f'leave_out = ["vehicle", "battery", "rider"]\nfigure = {{ panels = [{panel}] }}\n'
    scenario.write_text(f'{left_out}[[stimulus]]\ncan_log = "a.log"\nbus = "can0"\n')
    answer = evcosim("info", "scooter", str(scenario))
    assert answer.code == 0, answer.err
    assert "a.log can0 can0 0 495 0.01 EMD_Status 2" in " ".join(answer.out.split())
    (replay,) = json.loads(evcosim("info", "scooter", str(scenario), "--json").out)["replays"]
    assert replay["messages"]["EMD_Status"] == 2 and replay["after"] == 1
    assert json.loads(evcosim("info", "scooter", "--json").out)["replays"] == []
