"""The levels of a trial stay within the range that the system can give."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.system import load_system
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.studies.trial.levels import levels
from support.c_fmu import mixed_fmu
from support.descriptions import redescribed


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


@pytest.mark.parametrize(
    ("start", "low", "high", "expected"), [(0, 0, 1, 1), (0, 0, 5, 3), (1, 0, 1, 0), (0, -3, 0, -2)]
)
def test_an_integer_input_moves_by_a_whole_number(
    tmp_path: Path, start: int, low: int, high: int, expected: int
) -> None:
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 2)
    redescribed(fmu, ('<Integer start="0"/>', f'<Integer start="{start}" min="{low}" max="{high}"/>'))
    (tmp_path / "one.toml").write_text(
        'name = "one"\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "mixed.fmu"\n'
    )
    inputs = read_fmu(fmu).interface.of_causality("input")
    found = levels(load_system(str(tmp_path / "one.toml")), "a", (v for v in inputs if v.name == "count_in"))
    assert found["count_in"].high == expected


def _inputs(name: str) -> tuple[VariableInfo, ...]:
    return read_fmu(fmu_file(name)).interface.of_causality("input")
