"""A unit of FMI 2.0: its initialization mode, its steps, and its Enumerations, which are Integers in C."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmi2 import Fmi2Unit
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu


@pytest.fixture
def unit(tmp_path: Path) -> Iterator[Fmi2Unit]:
    made = Fmi2Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2)), "a")
    yield made
    made.free()


def test_steps_within_a_turn_are_steps_one_after_the_other(unit: Fmi2Unit, tmp_path: Path) -> None:
    other = Fmi2Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2)), "b")
    for each in (unit, other):
        each.enter_initialization(0.0, None)
        each.set("u", 1.0)
        each.exit_initialization()
    unit.start_step(FmuSteps.equal(0.0, 0.01, 5))
    for k in range(5):
        other.start_step(FmuSteps.equal(k * 0.01, 0.01, 1))
    assert unit.get("y") == other.get("y") == pytest.approx(1.0 - 0.99**5)
    other.free()


def test_the_step_function_is_known_after_the_initialization(unit: Fmi2Unit) -> None:
    assert unit.step_call is None
    unit.enter_initialization(0.0, None)
    unit.exit_initialization()
    assert unit.step_call is not None and unit.step_call.answers == ()


def test_a_step_that_is_discarded_is_an_error_that_names_the_function(tmp_path: Path) -> None:
    made = Fmi2Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2, 12)), "a")
    try:
        made.enter_initialization(0.0, None)
        made.exit_initialization()
        made.start_step(FmuSteps.equal(0.0, 0.01, 50))
        with pytest.raises(UnitError, match=r"unit 'a': fmi2DoStep returned Discard \(2\)"):
            made.start_step(FmuSteps.equal(0.5, 0.01, 1))
    finally:
        made.free()


def test_an_enumeration_is_an_integer(tmp_path: Path) -> None:
    fmu = read_fmu(fmu_file("TwoWheelerBraking"))
    enumerations = [v for v in fmu.interface.variables.values() if v.type == "Enumeration"]
    made = Fmi2Unit(fmu, "a")
    try:
        for variable in enumerations:
            assert made.type_of(variable).accessed == "Integer"
            assert made.get(variable.name) == variable.start or variable.start is None
    finally:
        made.free()
