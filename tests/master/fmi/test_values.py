"""A unit receives only numbers of its inputs' types: the same errors from both engines, isolated or not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import typed_fmu

ENGINES = [("python", "none"), ("compiled", "none"), ("compiled", "process")]
VERSIONS = (2, 3)


def run(folder: Path, fmi: int, scenario: str, engine: str = "compiled", isolation: str = "none") -> Results:
    """Run the typed unit for 50 ms by a scenario's text."""
    typed_fmu(folder / "typed.fmu", fmi)
    system = folder / "typed.toml"
    system.write_text('name = "typed"\n[experiment]\nstop_time = 0.05\n[units.a]\nfmu = "typed.fmu"\n')
    path = folder / "s.toml"
    path.write_text(scenario)
    options: dict[str, Any] = {"engine": engine, "isolation": isolation}
    return simulate(system, path, **options)


def stimulus(to: str, rest: str) -> str:
    return f'[[stimulus]]\nto = "a.{to}"\n{rest}\n'


@pytest.mark.parametrize(("engine", "isolation"), ENGINES)
@pytest.mark.parametrize("fmi", VERSIONS)
def test_values_hold_between_the_points_of_a_table(
    fmi: int, engine: str, isolation: str, tmp_path: Path
) -> None:
    (tmp_path / "in.csv").write_text("time,flag,state\n0,false,off\n0.02,TRUE,2\n0.03,0,broken\n")
    results = run(
        tmp_path,
        fmi,
        stimulus("flag_in", 'csv = "in.csv"')
        + stimulus("state_in", 'csv = "in.csv"\ncolumn = "state"')
        + stimulus("count_in", "table = [[0.0, 1], [0.04, 5]]"),
        engine,
        isolation,
    )
    assert results["a.flag_in"].tolist() == [False, False, True, False, False, False]
    assert results["a.state_in"].tolist() == [1, 1, 2, 4, 4, 4]
    assert results["a.count_in"].tolist() == [1, 1, 1, 1, 5, 5]
    assert results["a.flag"].tolist()[1:] == [True, True, False, True, True]


WRONG_AT_LOAD = [
    ("flag_in", "constant = 2.0", "constant: flag_in is a Boolean, true or false, not 2.0"),
    ("flag_in", "table = [[0, 0], [1, 2]]", "table: row 2: flag_in is a Boolean, true or false, not 2"),
    ("flag_in", 'constant = "true"', "constant: flag_in is a Boolean, true or false, not 'true'"),
    ("flag_in", "sine = { amplitude = 1, period = 1 }", "sine: flag_in is of type Boolean, which takes"),
    ("count_in", "ramp = { slope = 1 }", "ramp: count_in is of type Integer, which takes a constant"),
    ("count_in", "constant = 0.5", "constant: count_in is an Integer, not 0.5"),
    ("count_in", "constant = true", "constant: count_in is a finite Integer number, not true"),
    ("state_in", "constant = 3", "constant: 3 is no item of state_in: 1 off, 2 on, 4 broken"),
    ("state_in", 'constant = "onn"', r"constant: state_in has no item 'onn' \(did you mean 'on'\?\)"),
    ("state_in", "constant = 1\ninterpolation = 'linear'", 'interpolation: .* "linear" is between'),
    ("flag_in", 'csv = "in.csv"', "in.csv: line 3, column 'u': flag_in is a Boolean, true or false, not 2"),
    ("count_in", 'csv = "in.csv"\ncolumn = "v"', "line 2, column 'v': count_in is an Integer, not 1.5"),
    ("state_in", 'csv = "in.csv"\ncolumn = "w"', "in.csv: line 3, column 'w': state_in has no item 'run'"),
]  # fmt: skip # one case a line


@pytest.mark.parametrize(("to", "rest", "said"), WRONG_AT_LOAD)
def test_a_value_of_another_type_is_refused_at_load(to: str, rest: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("time,u,v,w\n0,1,1.5,on\n0.02,2,1,run\n")
    with pytest.raises(ConfigError, match=said):
        run(tmp_path, 2, stimulus(to, rest))


def test_numbers_beyond_the_type_are_refused_at_load(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="constant: 128 is beyond the numbers of count_in, -128 to 127"):
        run(tmp_path, 3, stimulus("count_in", "constant = 128"))
    with pytest.raises(ConfigError, match=r"start.a.count_in: -129 is beyond the numbers of count_in"):
        run(tmp_path, 3, "[start.a]\ncount_in = -129\n")


BIASED = [
    ("count_in", 120, "count_in cannot be set to 140: it is of type Int8, a whole number from -128 to 127"),
    ("state_in", 1, "state_in cannot be set to 3: it is of type Enumeration, one of 1, 2, 4"),
    ("state_in", 100, "state_in cannot be set to 102: it is of type Enumeration, one of 1, 2, 4"),
]


@pytest.mark.parametrize(("engine", "isolation"), ENGINES)
@pytest.mark.parametrize(("to", "value", "said"), BIASED)
def test_a_number_that_the_type_has_not_stops_the_step(
    to: str, value: float, said: str, engine: str, isolation: str, tmp_path: Path
) -> None:
    start = 20 if to == "count_in" else 2
    scenario = f'[start.a]\n{to} = {start}\n[[event]]\ntime = 0.02\naction = "bias"\nvariable = "a.{to}"\n'
    with pytest.raises(RunError) as caught:
        run(tmp_path, 3, scenario + f"value = {value}\n", engine, isolation)
    assert f"at t = 0.02 s (step 2): unit 'a': {said}" in str(caught.value)
    assert caught.value.results is not None and len(caught.value.results) == 2


@pytest.mark.parametrize(("engine", "isolation"), ENGINES[:2])
def test_a_fraction_of_a_whole_number_stops_the_step(engine: str, isolation: str, tmp_path: Path) -> None:
    """A unit of measure makes one of a whole number on the way."""
    typed_fmu(tmp_path / "typed.fmu", 2)
    system = tmp_path / "typed.toml"
    system.write_text('name = "t"\n[experiment]\nstop_time = 0.05\n[units.a]\nfmu = "typed.fmu"\n')
    scenario = tmp_path / "set.toml"  # an input that an event acts on is set in every step
    scenario.write_text('[[event]]\ntime = 0.04\naction = "set"\nvariable = "a.count_in"\nvalue = 1\n')
    options: dict[str, Any] = {"engine": engine, "isolation": isolation}
    with Simulation(system, str(scenario), **options) as simulation:
        slot = simulation.plan.inputs["a.count_in"].mailbox
        simulation._engine.memory[slot] = 0.5  # what a route may write
        with pytest.raises(
            RunError, match=r"a': count_in cannot be set to 0.5: .* a whole number from -2147"
        ):
            simulation.step()


def test_an_enumeration_is_overridden_by_the_name_of_an_item(tmp_path: Path) -> None:
    event = '[[event]]\ntime = 0.02\naction = "override"\nvariable = "a.state_in"\nvalue = "broken"\n'
    assert run(tmp_path, 2, event)["a.state_in"].tolist() == [1, 1, 4, 4, 4, 4]


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_stimulus_that_overflows_stops_the_run(engine: str, tmp_path: Path) -> None:
    from support.c_fmu import mixed_fmu

    mixed_fmu(tmp_path / "mixed.fmu", 2)
    system, scenario = tmp_path / "mixed.toml", tmp_path / "s.toml"
    system.write_text('name = "m"\n[experiment]\nstop_time = 50.0\n[units.a]\nfmu = "mixed.fmu"\n')
    scenario.write_text(stimulus("u", "ramp = { slope = 1e307 }"))
    options: dict[str, Any] = {"engine": engine, "isolation": "none"}
    with pytest.raises(RunError, match=r"^at t = 17.98 s \(step 1798\): the stimulus of a.u is inf: it must"):
        simulate(system, scenario, **options)
