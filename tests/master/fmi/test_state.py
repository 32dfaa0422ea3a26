"""A unit goes back to a state that it saved, and from there does the same again, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.instance import Instance
from evcosim.master.fmi.loading import load_unit
from evcosim.master.fmi.state import States
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu


@pytest.fixture
def scooter() -> Iterator[Instance]:
    fmu = read_fmu(fmu_file("Scooter"))
    unit = load_unit(fmu, "a", fmu.interface)
    assert isinstance(unit, Instance)
    unit.enter_initialization(0.0, None)
    unit.set("throttle", 100.0)
    unit.exit_initialization()
    yield unit
    unit.free()


def speeds(unit: Instance, first: int, steps: int) -> list[object]:
    found = []
    for k in range(first, first + steps):
        unit.start_step(FmuSteps.equal(k * 0.01, 0.01, 1))
        found.append(unit.get("speed"))
    return found


def test_from_a_saved_state_the_same_follows(scooter: Instance) -> None:
    speeds(scooter, 0, 20)
    early = scooter.save_state()
    first = speeds(scooter, 20, 20)
    late = scooter.save_state()
    scooter.restore_state(early)
    assert speeds(scooter, 20, 20) == first
    after = speeds(scooter, 40, 5)
    scooter.restore_state(late)
    assert speeds(scooter, 40, 5) == after
    assert early != late
    for number in (early, late):
        scooter.free_state(number)


def test_a_state_that_was_freed_is_gone(scooter: Instance) -> None:
    number = scooter.save_state()
    scooter.free_state(number)
    with pytest.raises(KeyError):
        scooter.restore_state(number)


def test_a_library_without_the_functions_is_named(tmp_path: Path) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    unit = load_unit(fmu, "a", fmu.interface)
    try:
        with pytest.raises(FmuError, match=r"mixed.so lacks the function fmi2GetFMUstate"):
            unit.save_state()  # type: ignore[attr-defined] # of the class that FMUs have
    finally:
        unit.free()


def test_a_unit_that_gives_nothing_for_its_state_has_failed() -> None:
    calls: list[str] = []
    silent: Any = SimpleNamespace(name="a", fmi="fmi3", call=lambda name, _: calls.append(name))
    with pytest.raises(UnitError, match="unit 'a': saved its state, but gives nothing for it"):
        States(silent).save()
    assert calls == ["fmi3GetFMUState"]  # which FMI 2.0 writes with a small s
