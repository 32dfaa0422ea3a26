"""A unit of FMI 1.0 has no initialization mode: before its first step its values are those that were set."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.master.fmi.fmi1 import Fmi1Unit
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu


@pytest.fixture
def unit(tmp_path: Path) -> Iterator[Fmi1Unit]:
    made = Fmi1Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 1)), "a")
    yield made
    made.free()


def test_before_the_initialization_a_value_is_the_one_that_was_set_else_the_start(unit: Fmi1Unit) -> None:
    assert [unit.get(name) for name in ("u", "gain", "title", "count_in")] == [0.0, 1.0, "some text", 0]
    assert [unit.get(name) for name in ("y", "count", "switch", "shown")] == [0.0, 0, False, ""]
    unit.set("gain", 2.5)
    unit.set("title", "another")
    assert [unit.get("gain"), unit.get("title")] == [2.5, "another"]
    unit.enter_initialization(0.0, 1.0)
    unit.exit_initialization()
    assert [unit.get("gain"), unit.get("title")] == [2.5, "another"]  # now the slave says so


def test_its_functions_have_the_name_of_the_model_before_them(unit: Fmi1Unit) -> None:
    assert unit._prefix() == "mixed_"
    assert unit.function("fmiDoStep") is not None


def test_it_takes_no_tolerance(tmp_path: Path) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 1))
    with pytest.raises(FmuError, match=r"unit 'a': a unit of FMI 1.0 Co-Simulation takes no tolerance"):
        Fmi1Unit(fmu, "a", tolerance=1e-3)


def test_it_saves_no_state(unit: Fmi1Unit) -> None:
    with pytest.raises(UnitError, match=r"unit 'a': FMI 1.0 has no functions that save a state"):
        unit.save_state()


def test_without_an_initialization_there_is_nothing_to_terminate(unit: Fmi1Unit) -> None:
    unit.terminate()
    assert unit.step_call is None
