"""The turns of an isolated unit in machine code: the same results and errors, without Python."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.system.system import EngineName
from evcosim.master.isolation.unit import IsolatedUnit
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import mixed_fmu
from support.pairs import pair

pytestmark = [
    pytest.mark.usefixtures("warm_units"),
    pytest.mark.skipif(not POSSIBLE, reason="a handover needs futexes and the order of stores of x86"),
]


@pytest.mark.parametrize("system", ["scooter", "braking"])
def test_the_compiled_engine_asks_python_for_hardly_any_turn(
    system: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, finish = [], IsolatedUnit.finish_step
    monkeypatch.setattr(IsolatedUnit, "finish_step", lambda unit: (asked.append(unit.name), finish(unit)))
    with Simulation(system, stop_time=2.0, isolation="process", engine="compiled") as simulation:
        simulation.run()
        turns = sum(simulation.plan.steps // unit.every for unit in simulation.plan.units)
    assert len(asked) < turns / 2  # those that take longer than the kernel waits, on a machine that is busy


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_all_types_arrive_as_in_this_process(tmp_path: Path, fmi: int, algorithm: str) -> None:
    path = pair(tmp_path, 0, fmi, algorithm)
    path.write_text(path.read_text().replace("[units.a]", "[units.a]\nperiod = 0.02\nsubsteps = 3"))
    here = simulate(path, isolation="none", engine="python")
    for engine in ("python", "compiled"):
        apart = simulate(path, isolation="process", engine=engine)
        assert here.data.tobytes() == apart.data.tobytes()
        assert here.texts == apart.texts
        assert [list(here[name]) for name in here.texts] == [list(apart[name]) for name in here.texts]


@pytest.mark.parametrize("fmi", [2, 3])
def test_outputs_of_several_types_that_feed_through_are_as_in_this_process(tmp_path: Path, fmi: int) -> None:
    """In every row and in the last one, which no step follows."""
    fmu = mixed_fmu(tmp_path / "mixed.fmu", fmi, feeding_through=True)
    table = tmp_path / "u.csv"
    table.write_text("time,u,count_in,switch_in\n0,1,5,1\n0.05,2,7,0\n0.07,3,8,1\n")
    inputs = {name: str(table) for name in ("u", "count_in", "switch_in")}
    here, *others = (
        simulate(fmu, inputs=inputs, stop_time=0.1, step_size=0.01, isolation=isolation, engine=engine)
        for isolation in ("none", "process")
        for engine in ("python", "compiled")
    )
    assert here["fmu.count"].tolist() == [0, 6, 6, 6, 6, 6, 8, 8, 9, 9, 9]  # after its step
    assert list(here["fmu.shown"]) == ["", *["some text"] * 10]
    for other in others:
        assert here.data.tobytes() == other.data.tobytes()


@pytest.mark.parametrize(("fmi", "behavior"), [(2, 2), (2, 11), (2, 12), (2, 13), (3, 3), (3, 4), (1, 13)])
def test_errors_and_warnings_are_those_of_python(tmp_path: Path, fmi: int, behavior: int) -> None:
    path = pair(tmp_path, behavior, fmi)

    def outcome(engine: EngineName) -> tuple[str, bytes, object]:
        with Simulation(path, engine=engine) as simulation:
            try:
                simulation.run()
                said = ""
            except RunError as error:
                said = str(error)
            return said, simulation.results.data.tobytes(), simulation.warnings

    assert outcome("compiled") == outcome("python")
