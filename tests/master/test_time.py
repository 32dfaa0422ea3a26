"""The times of units and results: both engines, every version of FMI, in this process and another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import Simulation, simulate
from support.equations import equations_fmu
from support.watch import watch_fmu

SYSTEM = """
name = "watched"
[experiment]
start_time = {start}
stop_time = {stop}
step_size = {step}
[units.a]
fmu = "{fmu}"
isolation = "none"
[units.slow]
fmu = "{fmu}"
isolation = "{isolation}"
period = {period}
substeps = {substeps}
"""


def watched(folder: Path, fmi: int = 2, **changes: Any) -> Path:
    """A system of two units that watch the time, the second with a period."""
    values = {"start": 0.0, "stop": 0.3, "step": 0.01, "period": 0.02, "substeps": 3, "isolation": "none"}
    path = folder / "watched.toml"
    path.write_text(SYSTEM.format(fmu=watch_fmu(folder / f"watch{fmi}.fmu", fmi), **values | changes))
    return path


def same(a: Results, b: Results) -> None:
    assert np.array_equal(a.time, b.time)
    assert np.array_equal(a.data, b.data)


def values(results: Results, name: str) -> list[float]:
    found: list[float] = results[name].tolist()
    return found


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_a_unit_steps_from_each_time_of_the_results(tmp_path: Path, fmi: int, engine: str) -> None:
    results = simulate(watched(tmp_path, fmi, start=0.7, stop=2.0, period=0.01), engine=engine, trust=True)
    expected = [(70 + k) / 100 for k in range(131)]
    assert results.time.tolist() == expected
    # the outputs at t_k are those after the step from t_k-1
    assert values(results, "a.begin")[1:] == expected[:-1]
    assert values(results, "slow.begin")[1:] == [(210 + 3 * k + 2) / 300 for k in range(130)]
    assert values(results, "slow.before")[1:] == [(210 + 3 * k + 1) / 300 for k in range(130)]


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_engines_and_processes_agree_whatever_the_step(tmp_path: Path, fmi: int) -> None:
    for stop, step, period in ((0.3, 0.01, 0.02), (0.55, 0.05, 0.1), (1.0, 1 / 60, 3 / 60), (0.7, 0.1, 0.3)):
        about = {"stop": stop, "step": step, "period": period}
        here = simulate(watched(tmp_path, fmi, **about), engine="python", trust=True)
        same(here, simulate(watched(tmp_path, fmi, **about), engine="compiled", trust=True))
        if fmi == 2:
            same(
                here,
                simulate(watched(tmp_path, fmi, **about, isolation="process"), engine="compiled", trust=True),
            )
        assert set(values(here, "a.stop")[1:]) == set(values(here, "slow.stop")[1:]) == {stop}
        assert here.time[-1] == stop


@pytest.mark.parametrize("stop", [1.0, 0.29, 0.57, 1.13, 4.35, 8.2, 9.7])
@pytest.mark.parametrize("step", [0.01, 0.005])
def test_a_unit_that_refuses_to_pass_the_stop_time_runs_to_it(
    tmp_path: Path, stop: float, step: float
) -> None:
    # 2 and 3 steps of 10 and 5 ms need not divide the time: the last turn ends at the stop time
    for substeps, period in ((1, 2 * step), (3, 3 * step)):
        path = watched(tmp_path, stop=stop, step=step, period=period, substeps=substeps)
        assert simulate(path, trust=True).time[-1] == stop


def test_a_simulation_that_may_be_stepped_on_tells_no_stop_time(tmp_path: Path) -> None:
    for engine in ("python", "compiled"):
        with Simulation(watched(tmp_path, stop=0.03), engine=engine, trust=True) as simulation:
            simulation.step(10)
            assert simulation["a.stop"] == simulation["slow.stop"] == -1.0
            assert simulation.results.time.tolist() == [k / 100 for k in range(11)]
            assert simulation["slow.size"] == 0.02 / 3


def test_a_simulation_to_the_stop_time_does_not_pass_it(tmp_path: Path) -> None:
    with Simulation(watched(tmp_path, stop=0.03), to_stop=True, trust=True) as simulation:
        simulation.step(2)
        with pytest.raises(ConfigError, match=r"^steps = 2: 1 are left to the stop time 0\.03 s"):
            simulation.step(2)
        simulation.step()
        assert simulation.finished
        assert simulation["a.stop"] == 0.03


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_model_with_a_solver_is_integrated_to_the_same_times(tmp_path: Path, fmi: int) -> None:
    path = tmp_path / "timer.toml"
    fmu = equations_fmu(tmp_path / "timer.fmu", "timer", fmi)
    path.write_text(
        f'name = "timer"\n[experiment]\nstart_time = 0.7\nstop_time = 1.0\n'
        f'[units.a]\nfmu = "{fmu}"\nisolation = "none"\nsubsteps = 3\n'
    )
    results = simulate(path, trust=True)
    assert values(results, "a.y") == results.time.tolist() == [k / 100 for k in range(70, 101)]


def test_a_stop_time_between_two_points_is_refused_with_those(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"stop_time = 0\.305 s .*; the nearest are 0\.3 s and 0\.31 s$"):
        simulate(watched(tmp_path, stop=0.305), trust=True)
    assert simulate(watched(tmp_path, stop=0.1 + 0.2), trust=True).time[-1] == 0.3


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(
    ("start", "step", "at", "k"), [(0.0, 0.03, 0.33, 11), (0.7, 0.01, 1.04, 34), (0.0, 1 / 60, 0.05, 3)]
)
def test_jumps_and_events_of_one_time_are_at_the_point_of_that_time(
    tmp_path: Path, start: float, step: float, at: float, k: int, engine: str
) -> None:
    (tmp_path / "s.toml").write_text(
        f'[[stimulus]]\nto = "a.u"\ninterpolation = "hold"\ntable = [[0.0, 0.0], [{at}, 1.0]]\n'
        f'[[stimulus]]\nto = "slow.u"\nsine = {{ amplitude = 1, period = 4, phase = 1.5, delay = {at!r} }}\n'
        f'[[event]]\ntime = {at!r}\naction = "override"\nvariable = "a.count"\nvalue = 1\n'
    )
    path = watched(tmp_path, start=start, stop=start + 60 * step, step=step, period=step)
    results = simulate(path, tmp_path / "s.toml", engine=engine, trust=True)
    assert results.time[k] == pytest.approx(at, abs=1e-15)
    for name in ("a.u", "slow.u", "a.count"):
        assert np.flatnonzero(results[name])[0] == k, name
