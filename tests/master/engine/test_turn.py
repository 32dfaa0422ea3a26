"""A course that an input follows gives what an override before each step gives, bit for bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.engine import engine as base
from evcosim.master.engine.turn import Effect
from evcosim.master.simulation import Simulation
from support.c_fmu import mixed_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

COURSE = np.repeat(30.0 + 7.0 * np.sin(np.arange(80.0)), 5)
INPUTS = {"ecu.speed_measured": COURSE, "vehicle.road_grade": 1e-3 * COURSE}  # over a bus, and of nothing
ENGINES = ["python", "compiled"]
CHANGES = 66


@pytest.fixture(params=[None, 7])
def chunks(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Chunks as long as usual, and short ones."""
    if request.param is not None:
        monkeypatch.setattr(base, "_FIRST", request.param)
    yield


def bits(simulation: Simulation) -> Any:
    results = simulation.results
    return np.stack([results[v.name] for v in results.variables]).view(np.int64)


def stepwise(system: Any, course: dict[str, np.ndarray], after: int, **options: Any) -> Any:
    with Simulation(system, **options) as simulation:
        simulation.step(3)
        for k in range(len(next(iter(course.values())))):
            for name, values in course.items():
                simulation.override(name, float(values[k]))
            simulation.step()
        simulation.step(after)
        return bits(simulation)


def followed(system: Any, course: dict[str, np.ndarray], after: int, **options: Any) -> Any:
    with Simulation(system, **options) as simulation:
        simulation.step(3)
        for name, values in course.items():
            simulation.follow(name, values)
        simulation.step(len(next(iter(course.values()))) + after)
        return bits(simulation)


@pytest.mark.usefixtures("chunks")
@pytest.mark.parametrize("options", [{}, {"ideal": True}, {"algorithm": "jacobi"}])
@pytest.mark.parametrize("engine", ENGINES)
def test_a_course_is_an_override_in_each_step(engine: str, options: dict[str, Any]) -> None:
    expected = stepwise("scooter", INPUTS, 20, engine="python", **options)
    assert np.array_equal(followed("scooter", INPUTS, 20, engine=engine, **options), expected)


def test_a_course_reaches_a_process() -> None:
    expected = stepwise("scooter", INPUTS, 5, engine="python")
    assert np.array_equal(followed("scooter", INPUTS, 5, isolation="process"), expected)


@pytest.mark.usefixtures("chunks")
@pytest.mark.parametrize("variant", [0, CHANGES])
@pytest.mark.parametrize("engine", ENGINES)
def test_a_course_of_an_input_that_no_step_sets(tmp_path: Path, engine: str, variant: int) -> None:
    """Of another tool's FMU, also one that changes the input itself: no value but the next one is set."""
    path = mixed_fmu(tmp_path / "a.fmu", 2, variant)
    options = {"step_size": 0.125, "trust": True, "isolation": "none"}
    course = {"fmu.u": np.array([3.0, 4.0, 4.5, 2.0])}
    expected = stepwise(path, course, 4, engine="python", **options)
    assert np.array_equal(followed(path, course, 4, engine=engine, **options), expected)


def test_a_value_that_stays_is_set_once(tmp_path: Path) -> None:
    """An FMU that adds 1 to its input in each step goes on from there."""
    path = mixed_fmu(tmp_path / "a.fmu", 2, CHANGES)
    with (
        Simulation(path, step_size=0.125, trust=True) as once,
        Simulation(path, step_size=0.125, trust=True) as long,
    ):
        once.override("fmu.u", 3.0)
        long.follow("fmu.u", [3.0] * 8)
        once.step(8)
        long.step(8)
        assert np.array_equal(bits(once), bits(long))


@pytest.mark.parametrize("engine", ENGINES)
def test_what_is_done_to_an_input_ends_its_course(engine: Any) -> None:
    with Simulation("scooter", engine=engine) as simulation:
        simulation.follow("vehicle.road_grade", [0.01, 0.02, 0.03, 0.04])
        simulation.step(2)
        simulation.override("vehicle.road_grade", 0.5)
        simulation.step(2)
        simulation.follow("vehicle.road_grade", [0.06, 0.07])
        simulation.step(3)
        simulation.reset("vehicle.road_grade")
        simulation.step()
        grade = simulation.results["vehicle.road_grade"]
    assert grade[:8].tolist() == [0.01, 0.02, 0.5, 0.5, 0.06, 0.07, 0.07, 0.0]


def test_steps_to_the_next_change() -> None:
    effect = Effect("follow", course=np.array([1.0, 1.0, 2.0, 2.0, 3.0]), first=10)
    assert [effect.steps_to_change(k) for k in range(10, 16)] == [2, 1, 2, 1, None, None]
    assert [k for k in range(10, 20) if effect.changes(k)] == [12, 14]
    assert effect.over(9, 8).tolist() == [1.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0]


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("vehicle.road_grad", [0.0], r"no input 'vehicle.road_grad' \(did you mean"),
        ("vehicle.road_grade", [], "at least one number"),
        ("vehicle.road_grade", [[0.0, 1.0]], r"in one row: shape \(1, 2\)"),
        ("vehicle.road_grade", 1.0, r"in one row: shape \(\)"),
        ("vehicle.road_grade", [0.0, float("nan"), 1.0], "finite Real number, not nan"),
        ("vehicle.road_grade", [0.0, float("-inf")], "finite Real number, not -inf"),
        ("vehicle.road_grade", ["up"], r"needs a list of numbers, not \['up'\]"),
    ],
)
def test_a_course_that_no_input_can_have(name: str, values: Any, said: str) -> None:
    with Simulation("scooter") as simulation, pytest.raises(ConfigError, match=said):
        simulation.follow(name, values)


def test_a_course_of_another_type(tmp_path: Path) -> None:
    path = mixed_fmu(tmp_path / "a.fmu", 2)
    with Simulation(path, trust=True) as simulation, pytest.raises(ConfigError, match="is of type Integer"):
        simulation.follow("fmu.count_in", [1])
