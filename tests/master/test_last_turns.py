"""The last turns of units whose period the stop time cuts short: what they show there, and only there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import Simulation, simulate
from support.databases import WAY
from support.equations import equations_fmu
from support.watch import watch_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

PERIODS = {1: 1, 2: 3, 3: 1, 4: 2, 7: 1}  # steps of a period, and substeps within
UNIT = """
[units.{name}]
fmu = "{fmu}"
isolation = "{isolation}"
period = {period}
substeps = {substeps}
"""


def system(
    folder: Path, steps: int, step: float = 0.01, start: float = 0.0, more: str = "", **changes: str
) -> Path:
    """A system of units p1, p2 ... with a clock each (y = the time reached) and periods of so many steps."""
    fmu = equations_fmu(folder / "timer.fmu", "timer", 2, "CS")
    about = {"isolation": "none", "algorithm": "gauss_seidel"} | changes
    units = "".join(
        UNIT.format(name=f"p{every}", fmu=fmu, period=every * step, substeps=parts, **about)
        for every, parts in PERIODS.items()
    )
    stop = Clock.counted(start, step, steps).stop
    path = folder / f"timers{steps}.toml"
    path.write_text(
        f'name = "timers"\n[experiment]\nstart_time = {start}\nstop_time = {stop!r}\nstep_size = {step!r}\n'
        f'algorithm = "{about["algorithm"]}"\n{units}{more}'
    )
    return path


def shown(clock: Clock, every: int) -> list[float]:
    """The time that a unit has reached in each row: that of its last turn which ended."""
    return [clock.at(k if k == clock.steps else k // every * every) for k in range(clock.steps + 1)]


def same(a: Results, b: Results) -> None:
    assert a.time.tobytes() == b.time.tobytes()
    assert a.data.tobytes() == b.data.tobytes()
    assert [list(a[name]) for name in a.texts] == [list(b[name]) for name in b.texts]


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("steps", [1, 2, 5, 6, 12, 13])
@pytest.mark.parametrize(("step", "start"), [(0.01, 0.0), (0.025, 0.7), (1 / 60, 0.7)])
def test_the_last_row_shows_what_a_shortened_turn_computed(
    tmp_path: Path, step: float, start: float, steps: int, engine: str
) -> None:
    results = simulate(system(tmp_path, steps, step, start), engine=engine, trust=True)
    clock = Clock.counted(start, step, steps)
    for every in PERIODS:
        assert results[f"p{every}.y"] == pytest.approx(shown(clock, every), abs=1e-12), every


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_engines_processes_and_steps_one_by_one_agree(tmp_path: Path, algorithm: str) -> None:
    here = simulate(system(tmp_path, 11, algorithm=algorithm), engine="python", trust=True)
    assert here["p7.y"][-1] == 0.11
    for isolation in ("none", "process"):
        for engine in ("compiled", "python"):
            path = system(tmp_path, 11, algorithm=algorithm, isolation=isolation)
            same(here, simulate(path, engine=engine, trust=True))
            with Simulation(path, engine=engine, trust=True, to_stop=True) as simulation:
                for _ in range(11):
                    assert simulation["p7.y"] < 0.11
                    simulation.step()
                assert simulation["p7.y"] == 0.11
                same(here, simulation.results)


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_the_rows_before_are_those_of_a_longer_run(tmp_path: Path, algorithm: str, engine: str) -> None:
    (tmp_path / "way.dbc").write_text(WAY)
    wire = '[[connect]]\nfrom = "p4.y"\nto = ["p1.level"]\n[[connect]]\nfrom = "p7.y"\nto = ["p2.level"]\n'
    bus = (
        f'[buses.b]\ndbc = "way.dbc"\n{wire}[[connect]]\nfrom = "p3.y"\nvia = "b.Way.Meters"\nto = ["p3.u"]\n'
    )
    longer = simulate(system(tmp_path, 84, more=bus, algorithm=algorithm), engine=engine, trust=True)
    for steps in (5, 10, 13):
        cut = simulate(system(tmp_path, steps, more=bus, algorithm=algorithm), engine=engine, trust=True)
        assert cut.data[:-1].tobytes() == longer.data[:steps].tobytes()
        # at the stop time no step begins: nothing is sent, and nobody receives what was computed for it
        for name in ("p1.level", "p2.level", "p3.u"):
            assert cut[name][-1] == cut[name][-2]
        assert cut["p7.y"][-1] == cut["p4.y"][-1] == steps / 100


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_texts_and_whole_numbers_of_a_shortened_turn_too(tmp_path: Path, engine: str, isolation: str) -> None:
    (tmp_path / "s.toml").write_text(
        "".join(
            f'[[stimulus]]\nto = "p{every}.label"\ntable = [[0.0, "first"], [0.06, "last"]]\n'
            f'[[stimulus]]\nto = "p{every}.demand"\ntable = [[0.0, 4], [0.06, 8]]\n'
            for every in (2, 4, 7)
        )
    )
    path = system(tmp_path, 9, isolation=isolation)
    results = simulate(path, tmp_path / "s.toml", engine=engine, trust=True, folder=tmp_path / "kept")
    # the turns before the last end at 0.08, 0.08 and 0.07 s, with what was there when they began
    expected = {2: (8, ["last", "last"]), 4: (8, ["first", "last"]), 7: (7, ["first", "last"])}
    for every, (row, texts) in expected.items():
        assert [results[f"p{every}.shown"][k] for k in (row, -1)] == texts
        assert [results[f"p{every}.seen"][k] for k in (row, -1)] == [9 if t == "last" else 5 for t in texts]
    same(results, Results.read(tmp_path / "kept"))


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_sampled_outputs_hold_from_the_begin_of_a_shortened_turn(
    tmp_path: Path, engine: str, isolation: str
) -> None:
    path = system(tmp_path, 9, isolation=isolation)
    path.write_text(path.read_text().replace("substeps = ", 'sampled = ["y"]\nsubsteps = '))
    results, clock = simulate(path, engine=engine, trust=True), Clock.counted(0.0, 0.01, 9)
    for every in PERIODS:
        ends = [clock.at(min(k // every * every + every, 9)) for k in (*range(9), 8)]
        assert results[f"p{every}.y"] == pytest.approx(ends, abs=1e-12), every
        assert results[f"p{every}.count"][-1] == 1


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_simulation_without_a_stop_time_cuts_no_turn_short(tmp_path: Path, engine: str) -> None:
    longer = simulate(system(tmp_path, 84), engine=engine, trust=True)
    with Simulation(system(tmp_path, 5), engine=engine, trust=True) as simulation:
        simulation.run()
        # the unit is on its way to 0.06 s, and shows where it was when the turn began
        assert simulation["p2.y"] == 0.04
        simulation.step()
        assert simulation["p2.y"] == pytest.approx(0.06, abs=1e-12)
        simulation.step(78)
        assert simulation.results.data[:-1].tobytes() == longer.data[:-1].tobytes()


ENDING = """
name = "ends"
[experiment]
stop_time = {stop}
[units.slow]
fmu = "slow.fmu"
isolation = "{isolation}"
period = 0.02
[units.asking]
fmu = "asking.fmu"
isolation = "{isolation}"
{more}
"""


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_unit_that_ends_the_run_cuts_no_turn_of_the_others(
    tmp_path: Path, engine: str, isolation: str
) -> None:
    def ended(stop: float, more: str = "", **flags: float) -> Results:
        watch_fmu(tmp_path / "slow.fmu")
        watch_fmu(tmp_path / "asking.fmu", flags=[f"-D{k}={v}" for k, v in flags.items()])
        (tmp_path / "ends.toml").write_text(ENDING.format(stop=stop, more=more, isolation=isolation))
        return simulate(tmp_path / "ends.toml", engine=engine, trust=True)

    def last(results: Results, unit: str) -> Any:
        return [float(results[f"{unit}.{name}"][-1]) for name in ("begin", "size")]

    # in the middle of a turn, which the unit does to its own end: it was told another stop time
    found = ended(1.0, ENDS=0.05)
    assert found.time[-1] == 0.05
    assert last(found, "slow") == [0.02, 0.02]
    # at the end of a shortened turn, of both
    found = ended(0.05, "period = 0.03", ENDS=0.05)
    assert found.time[-1] == 0.05
    assert "asked to end" in found.manifest["ended"]
    assert last(found, "slow") == [0.04, pytest.approx(0.01)]
    assert last(found, "asking") == [0.03, pytest.approx(0.02)]
    # within a shortened turn: the run ends where it began
    found = ended(0.05, "period = 0.03", ENDS=0.045, WITHIN=1)
    assert found.time[-1] == 0.03
    assert last(found, "asking") == [0.0, 0.03]


def test_rows_before_the_stop_time_are_as_without_a_shortened_turn(tmp_path: Path) -> None:
    results = simulate(system(tmp_path, 5), trust=True)
    assert np.diff(results["p7.y"]).tolist() == [0.0, 0.0, 0.0, 0.0, 0.05]
