"""Runs that a unit ends: Co-Simulation and Model Exchange, both engines, in this process and another."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import Simulation, simulate
from support.databases import WAY
from support.equations import equations_fmu
from support.watch import watch_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

SYSTEM = """
name = "ends"
[experiment]
stop_time = 1.0
algorithm = "{algorithm}"
[units.first]
fmu = "watch.fmu"
isolation = "{others}"
[units.asking]
fmu = "asking.fmu"
isolation = "{isolation}"
{more}
[units.last]
fmu = "watch.fmu"
isolation = "{others}"
[[connect]]
from = "first.y"
to = ["asking.u"]
[[connect]]
from = "asking.y"
to = ["last.u"]
[[metrics]]
name = "seen"
signal = "last.begin"
reduce = "max"
"""
HERE = [("python", "none"), ("compiled", "none")]
EVERYWHERE = [*HERE, ("python", "process"), ("compiled", "process")]


def system(folder: Path, fmi: int = 2, flags: tuple[str, ...] = ("-DENDS=0.05",), **changes: Any) -> Path:
    watch_fmu(folder / "watch.fmu", 2)
    watch_fmu(folder / "asking.fmu", fmi, flags=flags)
    values = {"algorithm": "gauss_seidel", "isolation": "none", "more": ""} | changes
    values["others"] = values["isolation"] if fmi == 2 else "none"  # in FMI 3 the one that asks is apart
    (folder / "ends.toml").write_text(SYSTEM.format(**values))
    return folder / "ends.toml"


def same(results: list[Results]) -> Results:
    """The first of them; all have the same rows."""
    for other in results[1:]:
        assert np.array_equal(results[0].time, other.time)
        assert np.array_equal(results[0].data, other.data)
        assert results[0].manifest["ended"] == other.manifest["ended"]
    return results[0]


def everywhere(made: Callable[..., Path], pairs: list[tuple[str, str]] = EVERYWHERE) -> Results:
    """The results of a system, in all engines and isolations."""
    return same(
        [simulate(made(isolation=isolation), engine=engine, trust=True) for engine, isolation in pairs]
    )


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_that_asks_at_a_communication_point_ends_the_run_there(
    tmp_path: Path, fmi: int, algorithm: str
) -> None:
    found = everywhere(lambda **changes: system(tmp_path, fmi, algorithm=algorithm, **changes))
    assert found.time.tolist() == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    for unit in ("first", "asking", "last"):
        assert found[f"{unit}.begin"].tolist() == [0.0, 0.0, 0.01, 0.02, 0.03, 0.04]
    assert found.manifest["ended"] == "unit 'asking' asked to end the simulation at t = 0.05 s"
    assert found.manifest["steps"] == 5
    assert found.metrics()[0].value == 0.04


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_that_asks_within_a_step_ends_the_run_at_the_point_before(
    tmp_path: Path, fmi: int, algorithm: str
) -> None:
    flags = ("-DENDS=0.045", "-DWITHIN=1")
    found = everywhere(lambda **changes: system(tmp_path, fmi, flags, algorithm=algorithm, **changes))
    assert found.time.tolist() == [0.0, 0.01, 0.02, 0.03, 0.04]
    assert found["asking.begin"].tolist() == [0.0, 0.0, 0.01, 0.02, 0.03]
    assert found.manifest["ended"] == "unit 'asking' asked to end the simulation at t = 0.045 s"


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_others_step_to_the_end_of_a_longer_period(tmp_path: Path, fmi: int) -> None:
    more = "period = 0.03\nsubsteps = 2"
    found = everywhere(lambda **changes: system(tmp_path, fmi, more=more, **changes), HERE)
    assert found.time[-1] == 0.06
    assert found["asking.begin"].tolist() == [0.0, 0.0, 0.0, 0.015, 0.015, 0.015, 0.045]
    assert found["last.begin"][-1] == 0.05


def test_an_end_in_a_substep_that_is_not_the_last_is_within_the_step(tmp_path: Path) -> None:
    flags, more = ("-DENDS=0.033", "-DWITHIN=1"), "substeps = 2"
    for fmi in (2, 3):
        found = everywhere(
            lambda fmi=fmi, **changes: system(tmp_path, fmi, flags, more=more, **changes), HERE
        )
        assert found.time[-1] == 0.03
        assert found.manifest["ended"].endswith("at t = 0.033 s")


def test_a_unit_that_does_not_tell_how_far_it_got(tmp_path: Path) -> None:
    """Discard says that it did not do the step, and OK that it did."""
    for fmi, last in ((2, 0.04), (3, 0.05)):
        flags = ("-DENDS=0.05", "-DSILENT")
        found = everywhere(
            lambda fmi=fmi, flags=flags, **changes: system(tmp_path, fmi, flags, **changes), HERE
        )
        assert found.time[-1] == last
        assert found.manifest["ended"].endswith(f"at t = {last} s")


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_a_discarded_step_without_a_request_stays_an_error(tmp_path: Path, fmi: int) -> None:
    for engine, isolation in EVERYWHERE if fmi == 2 else HERE:
        path = system(tmp_path, fmi, ("-DENDS=0.05", "-DREFUSES"), isolation=isolation)
        with pytest.raises(
            RunError, match=r"at t = 0.04 s .*unit 'asking': fmi\d?DoStep returned Discard"
        ) as raised:
            simulate(path, engine=engine, trust=True)
        assert raised.value.results is not None
        assert len(raised.value.results) == 4


EQUATIONS = """
name = "equations"
[experiment]
stop_time = 1.0
[units.a]
fmu = "a.fmu"
isolation = "{isolation}"
[units.b]
fmu = "watch.fmu"
isolation = "{isolation}"
[[connect]]
from = "a.y"
to = ["b.u"]
"""


@pytest.mark.parametrize(
    ("fmi", "model", "behavior", "end"),
    [
        (1, "timer", 2, 0.13),
        (2, "timer", 2, 0.13),
        (3, "timer", 2, 0.13),
        (1, "oscillator", 7, 0.5),
        (2, "oscillator", 7, 0.5),
        (3, "oscillator", 7, 0.5),
    ],
)
def test_a_model_that_asks_in_an_event_or_after_a_step_of_the_solver(
    tmp_path: Path, fmi: int, model: str, behavior: int, end: float
) -> None:
    equations_fmu(tmp_path / "a.fmu", model, fmi, behavior=behavior)
    watch_fmu(tmp_path / "watch.fmu")

    def made(isolation: str) -> Path:
        (tmp_path / "s.toml").write_text(EQUATIONS.format(isolation=isolation))
        return tmp_path / "s.toml"

    found = everywhere(made)
    assert found.time[-1] == end
    assert found["b.begin"][-1] == pytest.approx(end - 0.01)
    assert found.manifest["ended"] == f"unit 'a' asked to end the simulation at t = {end} s"
    assert math.isfinite(found["a.y"][-1])


def test_a_simulation_that_a_unit_ended_cannot_be_stepped_on(tmp_path: Path) -> None:
    with Simulation(system(tmp_path), trust=True) as simulation:
        assert (simulation.ended, simulation.finished) == ("", False)
        simulation.step(100)
        assert simulation.time == 0.05
        assert (simulation.finished, simulation.steps_left) == (True, 0)
        simulation.run()  # nothing is left
        simulation.step(0)
        with pytest.raises(RunError, match=r"^the run is over: unit 'asking' asked to end the simulation at"):
            simulation.step()
    assert simulation.results.time[-1] == 0.05


def test_the_command_says_who_ended_the_run_and_is_content(evcosim: Any, tmp_path: Path) -> None:
    path = system(tmp_path)
    ran = evcosim("run", path, "-o", tmp_path / "out", "--no-plot", "--trust")
    assert ran.code == 0, ran
    said = "unit 'asking' asked to end the simulation at t = 0.05 s"
    assert said in " ".join(ran.out.split())
    manifest = json.loads((tmp_path / "out" / "run.json").read_text())
    assert (manifest["status"], manifest["ended"]) == ("ended", said)
    assert manifest["metrics"]["seen"]["value"] == 0.04
    assert len(Results.read(tmp_path / "out")) == 6
    data = evcosim("run", path, "-o", tmp_path / "out", "--no-plot", "--trust", "--json").json
    assert (data["status"], data["ended"], data["simulated_seconds"]) == ("ended", said, 0.05)
    compared = evcosim("compare", tmp_path / "out", tmp_path / "out")
    assert compared.code == 0, compared


def test_kept_results_say_who_ended_the_run(tmp_path: Path) -> None:
    simulate(system(tmp_path), folder=tmp_path / "out", trust=True)
    assert json.loads((tmp_path / "out" / "run.json").read_text())["status"] == "ended"


BUS = """
[buses.can0]
dbc = "line.dbc"
[[connect]]
from = "asking.y"
to = ["last.u"]
via = "can0.Way.Meters"
"""
DIRECT = """[[connect]]
from = "asking.y"
to = ["last.u"]
"""


def test_messages_of_the_last_step_are_those_of_any_step(tmp_path: Path) -> None:
    """A sampled output is sent right after its sender's turn, in which it asks for the end."""
    (tmp_path / "line.dbc").write_text(WAY)
    found, frames = [], []
    for engine, isolation in EVERYWHERE:
        path = system(tmp_path, isolation=isolation, more="sampled = true")
        path.write_text(path.read_text().replace(DIRECT, BUS))
        scenario = tmp_path / "s.toml"
        scenario.write_text('[[stimulus]]\nto = "first.u"\ntable = [[0.0, 0.0], [1.0, 500.0]]\n')
        options: Any = {"engine": engine, "trust": True}
        with Simulation(path, scenario, log_frames=True, to_stop=True, **options) as simulation:
            simulation.run()
        found.append(simulation.results)
        frames.append(simulation.write_can_log(tmp_path / "can.log"))
        assert (tmp_path / "can.log").read_text().count("010#") == 5
    assert frames == [5] * 4
    watch_fmu(tmp_path / "asking.fmu", 2)
    whole = simulate(path, scenario, trust=True)
    assert np.array_equal(same(found).data[:5], whole.data[:5])
    # but for stimuli, the last row is what a run of 0.05 s ends with
    short = simulate(path, scenario, stop_time=0.05, trust=True)
    names = [name for name in short.names if not name.endswith(".stop")]
    assert {n: found[0][n][-1] for n in names} == {n: short[n][-1] for n in names}
