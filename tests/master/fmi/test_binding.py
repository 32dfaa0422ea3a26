"""The transfers of an instance: one for each function, in place where the memory is what C wants."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.plan.unit_plan import FmuSteps, SlotGroup
from evcosim.master.fmi.binding import Binding
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.fmi.instance import Instance
from evcosim.master.fmi.loading import load_unit
from evcosim.master.fmi.transfer import Copy, Transfer
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu


@pytest.fixture(params=[1, 2, 3])
def unit(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Instance]:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", request.param))
    made = load_unit(fmu, "a", fmu.interface)
    assert isinstance(made, Instance)
    made.enter_initialization(0.0, None)
    made.exit_initialization()
    yield made
    made.free()


def variables(unit: Instance, *names: str) -> list[VariableInfo]:
    return [unit.interface.variables[name] for name in names]


def test_doubles_that_stand_in_order_are_given_and_taken_in_place(unit: Instance) -> None:
    memory = np.arange(10.0)
    binding = Binding(unit, memory)
    (transfer,) = binding.transfers("Set", enumerate(variables(unit, "u", "gain"), 4))
    assert transfer.items == () and not transfer.gets
    memory[4:6] = 0.25, -2.0
    binding.calls([transfer])()
    assert (unit.get("u"), unit.get("gain")) == (0.25, -2.0)
    memory[4] = 0.75
    binding.calls([transfer])()
    assert unit.get("u") == 0.75


@pytest.mark.parametrize("places", [(5, 4), (4, 7)])
def test_other_doubles_pass_through_a_buffer(unit: Instance, places: tuple[int, int]) -> None:
    memory = np.zeros(10)
    binding = Binding(unit, memory)
    transfers = [
        binding.transfers(direction, zip(places, variables(unit, "u", "gain"), strict=True))[0]
        for direction in ("Set", "Get")
    ]
    assert [item.slot for item in transfers[0].items] == list(places)
    memory[list(places)] = 0.25, -2.0
    binding.calls(transfers[:1])()
    memory[:] = 0.0
    binding.calls(transfers[1:])()
    assert memory[list(places)].tolist() == [0.25, -2.0] and np.count_nonzero(memory) == 2


def test_there_is_a_transfer_for_each_function(unit: Instance) -> None:
    binding = Binding(unit, np.zeros(10))
    names = ("count_in", "switch_in", "u", "gain")
    transfers = binding.transfers("Set", enumerate(variables(unit, *names)))
    assert [len(transfer.references) for transfer in transfers] == [1, 1, 2]
    assert [transfer.type.kind.name for transfer in transfers] == ["Integer", "Boolean", "Real"]
    assert len({transfer.function for transfer in transfers}) == 3


def test_outputs_that_feed_through_are_valid_and_latest_at_once(unit: Instance) -> None:
    memory = np.zeros(10)
    binding = Binding(unit, memory)
    group = SlotGroup("continuous", "Real", tuple(variables(unit, "y", "gain")), 0, 5, feedthrough=1)
    through = binding.feedthrough(group)
    assert isinstance(through[0], Transfer) and through[1] == Copy(5, 0, 1)
    unit.set("u", 1.0)
    unit.start_step(FmuSteps.equal(0.0, 0.5, 1))
    binding.calls(through)()
    assert memory[0] == memory[5] == unit.get("y") == 0.5
    assert memory[6] == 0.0
    unfed = SlotGroup("continuous", "Real", tuple(variables(unit, "y")), 0, 5)
    assert binding.feedthrough(unfed) == []


def test_a_number_that_does_not_fit_is_refused_with_the_name_of_the_variable(unit: Instance) -> None:
    memory = np.array([2.0**31])
    binding = Binding(unit, memory)
    call = binding.calls(binding.transfers("Set", enumerate(variables(unit, "count_in"))))
    with pytest.raises(UnitError, match=r"unit 'a': count_in cannot be set to 2147483648: it is of type "):
        call()
    memory[0] = 2.0**31 - 1
    call()
    assert unit.get("count_in") == 2**31 - 1
