"""The levels of a trial stay within the range that the system can give."""

from __future__ import annotations

import pytest

from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.system import load_system
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.studies.trial.levels import levels


def test_levels_are_within_what_the_system_can_give() -> None:
    system = load_system("scooter")
    found = levels(system, "vehicle", _inputs("Scooter"))
    assert found["throttle"].limits == (0.0, 100.0)  # of the bus and of the ECU
    assert found["throttle"].high == 50.0
    assert found["brake_force"].limits[0] == 0.0
    assert found["brake_force"].high == 200.0
    assert found["road_grade"].limits == (-1.5, 1.5)
    steering = levels(load_system("lane_keeping"), "vehicle", _inputs("LateralVehicle"))
    assert steering["front_steering_angle"].limits == pytest.approx((-0.8727, 0.8727), abs=1e-4)  # 50 deg
    assert steering["front_steering_angle"].high == 0.05


def _inputs(name: str) -> tuple[VariableInfo, ...]:
    return read_fmu(fmu_file(name)).interface.of_causality("input")
