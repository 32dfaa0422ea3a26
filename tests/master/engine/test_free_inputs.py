"""Inputs of other tools' FMUs that nothing drives: no step sets them, they keep the FMU's own values."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.results.results import Results
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import load_system
from evcosim.master.prepare import prepare
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import mixed_fmu
from support.equations import equations_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

REFUSES, CHANGES = 23, 66
STEP = 0.125
WAYS = [("python", "none"), ("compiled", "none"), ("compiled", "process")]


def alone(path: Path, **options: Any) -> Results:
    return simulate(path, **{"stop_time": 1.0, "step_size": STEP, "trust": True, **options})


def response(received: list[float]) -> list[float]:
    """The output of the unit of mixed.c after each step, from the input in that step."""
    found, y = [0.0], 0.0
    for u in received:
        y += STEP * (u - y)
        found.append(y)
    return found


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize(("engine", "isolation"), WAYS)
def test_an_fmu_that_refuses_an_input_runs_without_it(
    tmp_path: Path, fmi: int, engine: Any, isolation: Any
) -> None:
    path = mixed_fmu(tmp_path / "a.fmu", fmi, REFUSES)
    results = alone(path, engine=engine, isolation=isolation)
    assert len(results.time) == 9
    with pytest.raises(RunError, match=r"SetReal.* returned Error|SetFloat64.* returned Error"):
        alone(path, engine=engine, isolation=isolation, inputs={"u": 1.0})


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize(("engine", "isolation"), WAYS)
def test_an_input_that_the_fmu_changes_itself_stays_changed(
    tmp_path: Path, fmi: int, engine: Any, isolation: Any
) -> None:
    path = mixed_fmu(tmp_path / "a.fmu", fmi, CHANGES)
    ways = {"engine": engine, "isolation": isolation}
    own = [float(k) for k in range(8)]
    assert alone(path, **ways)["fmu.y"].tolist() == response(own)
    assert alone(path, **ways, parameters={"u": 7.0})["fmu.y"].tolist() == response([7.0 + u for u in own])
    assert alone(path, **ways, inputs={"u": 7.0})["fmu.y"].tolist() == response([7.0] * 8)


ACTIONS = [
    ("set", 3.0, [0.0, 0.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]),
    ("override", 3.0, [0.0, 0.0, 3.0, 3.0, 3.0, 0.0, 0.0, 0.0]),
    ("bias", 2.0, [0.0, 0.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]),
]


@pytest.mark.parametrize(("engine", "isolation"), WAYS)
@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize(("action", "value", "received"), ACTIONS)
def test_what_a_user_does_to_such_an_input_reaches_the_fmu(
    tmp_path: Path, fmi: int, action: str, value: float, received: list[float], engine: Any, isolation: Any
) -> None:
    """In a run by itself, and by events of a scenario, alike."""
    mixed_fmu(tmp_path / "a.fmu", fmi)
    system, scenario = tmp_path / "a.toml", tmp_path / "do.toml"
    system.write_text(
        f'name = "one"\n[experiment]\nstop_time = 1.0\nstep_size = {STEP}\n[units.a]\nfmu = "a.fmu"\n'
    )
    reset = "" if action == "set" else '[[event]]\ntime = 0.625\naction = "reset"\nvariable = "a.u"\n'
    scenario.write_text(
        f'[[event]]\ntime = 0.25\naction = "{action}"\nvariable = "a.u"\nvalue = {value}\n{reset}'
    )
    ways: dict[str, Any] = {"engine": engine, "isolation": isolation, "trust": True}
    of_file = simulate(system, scenario, **ways)
    with Simulation(system, **ways) as simulation:
        simulation.step(2)
        getattr(simulation, action)("a.u", value)
        simulation.step(3)
        if action != "set":
            simulation.reset("a.u")
        simulation.step(3)
        by_hand = simulation.results
    assert of_file["a.y"].tolist() == by_hand["a.y"].tolist() == response(received)
    assert of_file["a.u"].tolist() == by_hand["a.u"].tolist() == [*received, received[-1]]


def test_in_model_exchange_too(tmp_path: Path) -> None:
    path = equations_fmu(tmp_path / "a.fmu", "decay", 2, "ME")
    system = tmp_path / "a.toml"
    system.write_text('name = "one"\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "a.fmu"\n')
    read = load_system(str(system))
    plan = prepare(read, load_scenario(read), trust=True).plan
    inputs = {v.name for v in plan.units[0].interface.of_causality("input")}
    assert plan.units[0].free == inputs
    assert len(alone(path).time) == 9


def test_our_own_fmus_take_all_their_inputs_in_every_step() -> None:
    system = load_system("scooter")
    plan = prepare(system, load_scenario(system)).plan
    assert [unit.free for unit in plan.units] == [frozenset()] * len(plan.units)
    assert any(not p.driver for p in plan.inputs.values())
