"""The interface of a unit: everything that runs as one has all its calls."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

from evcosim import Simulation
from evcosim.cosim.errors import RunError
from evcosim.master.unit import Unit, UnitError, floats
from support.c_fmu import mixed_fmu
from support.mocks import clock

CALLS = [name for name, value in vars(Unit).items() if inspect.isfunction(value) and name[0] != "_"]


def takes_all_calls(unit: Any) -> None:
    """Every call of the protocol, with as many arguments; a loaded FMU has some of them once it is bound."""
    assert unit.warnings == 0
    assert unit.interface.variables
    for name in CALLS:
        declared, own = inspect.signature(getattr(Unit, name)), inspect.signature(getattr(unit, name))
        assert len(own.parameters) == len(declared.parameters) - 1, name


@pytest.mark.parametrize("isolation", ["none", "process"])
def test_a_unit_of_a_simulation_takes_all_calls(isolation):
    with Simulation("scooter", isolation=isolation) as simulation:
        for name, unit in simulation.units.items():
            assert unit.name == name
            takes_all_calls(unit)


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_a_unit_of_each_fmi_version_takes_all_calls(tmp_path, fmi):
    path = tmp_path / "one.toml"
    path.write_text(f"name = 'one'\n[units.a]\nfmu = '{mixed_fmu(tmp_path / 'mixed.fmu', fmi)}'\n")
    with Simulation(path, stop_time=0.1, isolation="none") as simulation:
        takes_all_calls(simulation.units["a"])


def test_a_unit_written_in_python_takes_all_calls():
    takes_all_calls(clock())


def test_memory_as_floats_is_the_same_memory():
    memory = np.array([1.5, -0.0, np.inf])
    view = floats(memory)
    assert [type(x) for x in view] == [float] * 3
    view[1] = 2.0
    memory[0] = 7.0
    assert memory[1] == 2.0
    assert view[0] == 7.0
    view[1:] = memory[:2].data.cast("B").cast("d")
    assert memory.tolist() == [7.0, 7.0, 2.0]


def test_the_error_of_a_unit_is_one_of_a_run():
    assert issubclass(UnitError, RunError)
