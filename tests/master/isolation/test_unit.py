"""Isolated units give the same results, and whatever one does to its process, the run ends with a reason."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.cosim.system.system import Algorithm
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.isolation.process import ProcessLimits
from evcosim.master.isolation.unit import IsolatedUnit
from evcosim.master.simulation import Simulation, simulate
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu
from support.pairs import pair


@pytest.mark.parametrize("system", ["scooter", "lane_keeping", "braking", "multi_drive"])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_isolated_units_give_the_same_results(
    system: str, algorithm: Algorithm, request: pytest.FixtureRequest
) -> None:
    if algorithm == "jacobi":  # whose processes need not be fresh too
        request.getfixturevalue("warm_units")
    here = simulate(system, stop_time=0.5, algorithm=algorithm)
    apart = simulate(system, stop_time=0.5, algorithm=algorithm, isolation="process")
    assert np.array_equal(here.data, apart.data)
    assert {unit["isolation"] for unit in apart.manifest["units"].values()} == {"process"}


def test_a_unit_that_ends_before_the_first_step(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"unit 'a': its process was killed by SIGSEGV .*, asked for load"):
        simulate(pair(tmp_path, 60))


def test_a_unit_that_cannot_terminate_loses_nothing(tmp_path: Path) -> None:
    with Simulation(pair(tmp_path, 61)) as simulation:
        simulation.run()
        results = simulation.results
        with pytest.raises(RunError, match=r"did not answer for 1 s .*asked for terminate"):
            simulation.close()
    assert len(results) == 101


def test_units_step_at_the_same_time_under_jacobi(tmp_path: Path) -> None:
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 2, 63)
    units = "".join(f'[units.{name}]\nfmu = "{fmu}"\n' for name in "ab")
    path = tmp_path / "two.toml"
    path.write_text(f'name = "two"\n[experiment]\nstop_time = 0.2\nalgorithm = "jacobi"\n{units}')
    seconds = []
    while not seconds or (min(seconds) >= 1.5 * 20 * 0.05 and len(seconds) < 10):  # a busy machine adds to it
        with Simulation(path) as simulation:
            simulation.run()
            seconds.append(simulation.loop_seconds)
    assert 20 * 0.05 < min(seconds) < 1.5 * 20 * 0.05


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_single_values_are_those_of_a_unit_in_this_process(tmp_path: Path, fmi: int) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", fmi))
    here, apart = load_unit(fmu, "a", fmu.interface), IsolatedUnit(fmu, "a", fmu.interface, ProcessLimits())
    found = []
    for unit in (here, apart):
        try:
            unit.set("title", "Grüße")
            unit.set("u", 0.1)
            unit.set("count_in", -7)
            unit.set("switch_in", True)
            unit.enter_initialization(0.0, None)
            unit.exit_initialization()
            unit.start_step(FmuSteps.equal(0.0, 0.01, 1))
            unit.finish_step()
            found.append({name: unit.get(name) for name in ("y", "count", "switch", "shown", "gain")})
            unit.terminate()
        finally:
            unit.free()
            unit.free()  # which may be done twice
    assert found[0] == found[1]
    assert {name: type(value) for name, value in found[0].items()} == {
        name: type(value) for name, value in found[1].items()
    }


def test_an_error_of_the_unit_is_raised_here_with_its_kind(tmp_path: Path) -> None:
    refusing = read_fmu(mixed_fmu(tmp_path / "refusing.fmu", 2, 1))
    unit = IsolatedUnit(refusing, "a", refusing.interface, ProcessLimits())
    try:
        with pytest.raises(FmuError, match=r"refusing.fmu: cannot be instantiated"):
            unit.get("y")
    finally:
        unit.free()
    failing = read_fmu(mixed_fmu(tmp_path / "failing.fmu", 2, 23))
    unit = IsolatedUnit(failing, "a", failing.interface, ProcessLimits())
    try:
        with pytest.raises(UnitError, match=r"unit 'a': fmi2SetReal of u returned Error \(3\)"):
            unit.set("u", 1.0)
        assert unit.get("count") == 0  # it lives on
    finally:
        unit.free()


@pytest.mark.parametrize("ask", ["save_state", "get"])
@pytest.mark.parametrize("answer", [None, ["x"], {}])
def test_an_answer_of_another_kind_is_an_error_with_the_unit(
    ask: str, answer: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    unit = IsolatedUnit(fmu, "a", fmu.interface, ProcessLimits())
    try:
        monkeypatch.setattr(unit, "_call", lambda *_: answer)
        with pytest.raises(UnitError, match=r"^unit 'a': its process sent no "):
            getattr(unit, ask)(*["y"] * (ask == "get"))
    finally:
        monkeypatch.undo()
        unit.free()
