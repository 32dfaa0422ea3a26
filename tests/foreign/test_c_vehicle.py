"""A vehicle written in C, with other names, units and signs, in the place of ours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.simulation import simulate
from support.c_fmu import vehicle_fmu

SWAP = """
fmu = "Vehicle.fmu"
replaces = "scooter.vehicle"
absent = ["front_wheel_speed", "rear_wheel_speed", "drive_force"]
[map.inputs]
throttle = "pedal"
brake_force = { variable = "F_brake", invert = true }
road_grade = "slope"
[map.outputs]
speed = { variable = "v", unit = "m/s" }
acceleration = "a"
power = "P"
distance = "s"
[map.parameters]
mass = "m_total"
"""


def swap_file(folder: Path, fmi: int = 2, text: str = SWAP) -> Path:
    vehicle_fmu(folder / "Vehicle.fmu", fmi)
    (folder / "swap.toml").write_text(text)
    return folder / "swap.toml"


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("scenario", ["fig8", "ece15"])
def test_the_closed_loop_is_that_of_our_vehicle(tmp_path: Path, fmi: int, scenario: str) -> None:
    ours = simulate("scooter", scenario, stop_time=40.0)
    theirs = simulate("scooter", scenario, stop_time=40.0, swaps={"vehicle": swap_file(tmp_path, fmi)})
    assert theirs.units["vehicle.speed"] == "m/s"
    assert np.max(np.abs(3.6 * (theirs["vehicle.speed"] - ours["vehicle.speed"]))) < 0.2  # km/h
    assert np.max(ours["vehicle.speed"]) > 3.0
    assert theirs.manifest["units"]["vehicle"]["isolation"] == "process"


def test_an_inverted_input_is_recorded_in_the_sign_of_the_system(tmp_path: Path) -> None:
    theirs = simulate("scooter", "ece15", stop_time=60.0, swaps={"vehicle": swap_file(tmp_path)})
    assert np.max(theirs["vehicle.brake_force"]) > 0.0
    assert np.min(theirs["vehicle.brake_force"]) >= 0.0


def test_a_mapped_parameter_is_set_by_the_name_of_the_system(tmp_path: Path) -> None:
    parameters = {"vehicle.mass": 150.0}
    ours = simulate("scooter", stop_time=10.0, parameters=parameters)
    theirs = simulate(
        "scooter", stop_time=10.0, parameters=parameters, swaps={"vehicle": swap_file(tmp_path)}
    )
    assert np.max(np.abs(3.6 * (theirs["vehicle.speed"] - ours["vehicle.speed"]))) < 0.2
    assert theirs.manifest["units"]["vehicle"]["parameters"] == {"mass": 150.0}


def test_what_is_absent_is_left_out_and_told(tmp_path: Path) -> None:
    text = SWAP.replace('"drive_force"]', '"drive_force", "power", "distance"]')
    text = text.replace('power = "P"\n', "").replace('distance = "s"\n', "")
    results = simulate("scooter", stop_time=1.0, swaps={"vehicle": swap_file(tmp_path, 2, text)})
    told = "\n".join(results.manifest["warnings"])
    assert "left out, since it is absent: vehicle.power -> battery.power; a receiver keeps its start" in told
    assert "left out, since it is absent: metric 'distance'" in told
    assert "distance" not in [m.name for m in results.metrics()]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"pedal"', '"pedall"', r"map.inputs.throttle: .* has no variable 'pedall' \(did you mean 'pedal'"),
        ('throttle = "pedal"', 'throttle = "v"', "map.inputs.throttle: v is of causality output, not input"),
        ('unit = "m/s"', 'unit = "floops"', "map.outputs.speed: unit of measure 'floops' is not known"),
        ('unit = "m/s"', 'unit = "N"', r"vehicle.speed \[N\] cannot feed .* measure different quantities"),
        (
            '"scooter.vehicle"',
            '"scooter.rider"',
            "replaces = 'scooter.rider': it was not written for scooter",
        ),
        ('throttle = "pedal"', "", "unit 'vehicle' has no variable 'throttle'"),
        ('"Vehicle.fmu"', '"Other.fmu"', r"Other.fmu: there is no such FMU file"),
        ("[map.inputs]", "[map.input]", "map.input: unknown key .did you mean"),
        ('absent = ["', 'absent = ["speed", "', r"\.toml: absent: .*Vehicle.fmu has 'speed'"),
    ],
)
def test_what_is_wrong_is_named_before_the_first_step(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    assert old in SWAP
    with pytest.raises(ConfigError, match=message):
        simulate("scooter", swaps={"vehicle": swap_file(tmp_path, 2, SWAP.replace(old, new))})
