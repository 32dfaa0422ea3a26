"""What units see in their initialization: beside FMPy, in every version, interface, engine and process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import simulate
from support.databases import write
from support.initial import SHOWN, initial_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

KINDS = [(1, "CS"), (1, "ME"), (2, "CS"), (3, "CS"), (2, "ME"), (3, "ME")]
INTERFACES = {"CS": "CoSimulation", "ME": "ModelExchange"}
DRIVEN = '[[stimulus]]\nto = "a.u"\ntable = [[0.0, 3.0], [0.1, 4.0]]\n'
WAYS = [("none", "python"), ("none", "compiled"), ("process", "compiled")]


def run(fmu: Path, unit: str = "", scenario: str = DRIVEN, more: str = "", **options: Any) -> Results:
    """A system of this FMU alone, driven by a scenario, for ten steps."""
    path = fmu.with_name("alone.toml")
    path.write_text(
        f'name = "alone"\n[experiment]\nstop_time = 0.1\n[units.a]\nfmu = "{fmu.name}"\n{unit}\n{more}'
    )
    (fmu.parent / "driven.toml").write_text(scenario)
    return simulate(path, fmu.parent / "driven.toml", **options, trust=True)


def first(results: Results) -> dict[str, float]:
    """The first row of what the unit showed."""
    return {name: results[f"a.{name}"][0] for name in SHOWN}


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize(("isolation", "engine"), WAYS)
def test_the_first_value_of_a_stimulus_is_there_from_before_the_initialization(
    tmp_path: Path, fmi: int, kind: str, isolation: str, engine: str
) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    driven = DRIVEN + '[[stimulus]]\nto = "a.n"\nconstant = 5.0\n[[stimulus]]\nto = "a.b"\nconstant = 1.0\n'
    results = run(fmu, scenario=driven, isolation=isolation, engine=engine)
    seen = first(results)
    assert seen["entered"] == seen["left"] == 3.0
    assert seen["within"] == (-1.0 if fmi == 1 else 3.0)  # FMI 1.0 has nothing within
    assert (seen["n_entered"], seen["b_entered"]) == (5.0, 1.0)
    assert results["a.u"][0] == results["a.y"][0] == 3.0
    assert not results.manifest["warnings"]


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
def test_the_stimulus_is_that_of_the_start_time(tmp_path: Path, fmi: int, kind: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    path = tmp_path / "late.toml"
    path.write_text(
        'name = "late"\n[experiment]\nstart_time = 0.7\nstop_time = 0.8\n[units.a]\n'
        f'fmu = "{fmu.name}"\nisolation = "none"\n'
    )
    (tmp_path / "sine.toml").write_text(
        '[[stimulus]]\nto = "a.u"\nsine = { amplitude = 2.0, period = 2.8, mean = 1.0 }\n'
    )
    results = simulate(path, tmp_path / "sine.toml", trust=True)
    assert results["a.entered"][0] == pytest.approx(3.0, abs=1e-12)
    assert results["a.entered"][0] == results["a.left"][0] == results["a.u"][0]


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize("isolation", ["none", "process"])
def test_starts_and_parameters_are_there_too(tmp_path: Path, fmi: int, kind: str, isolation: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind, resets=fmi == 2)
    results = run(fmu, "start = { u = 2.0 }\nparameters = { p = 5.0 }", "", isolation=isolation)
    seen = first(results)
    assert (seen["entered"], seen["left"], seen["gain"], seen["y"]) == (2.0, 2.0, 5.0, 10.0)


@pytest.mark.parametrize("kind", ["CS", "ME"])
def test_a_parameter_that_the_setup_of_the_experiment_resets_is_kept(tmp_path: Path, kind: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 2, kind, resets=True)
    results = run(fmu, "parameters = { p = 5.0 }", isolation="none")
    assert first(results)["gain"] == 5.0
    np.testing.assert_array_equal(results["a.y"], 5.0 * results["a.u"])


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize(("isolation", "engine"), WAYS)
@pytest.mark.parametrize("status", [3])
def test_an_fmu_that_refuses_early_inputs_is_made_anew(
    tmp_path: Path, fmi: int, kind: str, isolation: str, engine: str, status: int
) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind, refuses=status)
    results = run(fmu, "parameters = { p = 5.0 }", isolation=isolation, engine=engine)
    seen = first(results)
    assert seen["entered"] == 7.0  # the FMU's own
    assert seen["left"] == (7.0 if fmi == 1 else 3.0)
    assert (seen["gain"], seen["y"], results["a.u"][0]) == (5.0, 15.0, 3.0)
    (warning,) = results.manifest["warnings"]
    assert f"of u returned {'Discard' if status == 2 else 'Error'} ({status}) before" in warning
    assert "instantiated anew" in warning and warning.startswith("unit 'a': ")


@pytest.mark.parametrize(("fmi", "kind"), KINDS[2:])  # FMI 1.0 has no later time for start values
def test_an_fmu_that_nothing_drives_is_asked_for_no_early_inputs(tmp_path: Path, fmi: int, kind: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind, refuses=3)
    results = run(fmu, scenario="", isolation="none")
    assert not results.manifest["warnings"]
    assert first(results)["left"] == 7.0


def test_a_start_beyond_the_type_is_refused_at_load(tmp_path: Path) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 2)
    with pytest.raises(ConfigError, match=r"start.n: 3000000000 is beyond the numbers of n, -2147483648 to"):
        run(fmu, "start = { n = 3_000_000_000 }", scenario="", isolation="none")


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize("refuses", [0, 3])
def test_it_is_as_fmpy_does_it_but_for_what_is_seen_before(
    tmp_path: Path, fmi: int, kind: str, refuses: int
) -> None:
    from fmpy import simulate_fmu

    fmu = initial_fmu(
        tmp_path / "initial.fmu", fmi, kind, resets=fmi == 2, refuses=0 if fmi == 1 else refuses
    )
    times = np.array([0.0, 0.1])
    table = np.array(
        list(zip(times, [3.0, 4.0], strict=True)), dtype=[("time", np.float64), ("u", np.float64)]
    )
    theirs = simulate_fmu(
        str(fmu), start_time=0.0, stop_time=0.1, output_interval=0.01, step_size=0.01, input=table,
        start_values={"p": 5.0}, output=[*SHOWN, "h"], fmi_type=INTERFACES[kind],
    )  # fmt: skip # what the run below has
    ours = run(fmu, "parameters = { p = 5.0 }", 'record = ["*", "a.h"]\n' + DRIVEN, isolation="none")
    assert len(theirs) == len(ours) == 11
    assert ours["a.entered"][0] == (7.0 if fmi != 1 and refuses else 3.0)
    assert theirs["entered"][0] == (3.0 if fmi == 1 else 7.0)
    for name in ("within", "left", "gain", "h", "n_entered", "b_entered"):
        np.testing.assert_allclose(ours[f"a.{name}"], theirs[name], atol=1e-12, err_msg=name)
    assert ours["a.y"][0] == theirs["y"][0] == 15.0  # later rows of ours have the inputs of the row


BUS = """
[units.b]
fmu = "initial.fmu"
isolation = "none"
[buses.can0]
dbc = "test.dbc"
[[connect]]
from = "a.y"
to = ["b.u"]
via = "can0.M.S"
{initial}
"""


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize(("initial", "value"), [("initial = 12.5", 12.5), ("", 7.0)])
def test_the_initial_value_of_a_bus_is_there_before_the_first_message(
    tmp_path: Path, fmi: int, kind: str, initial: str, value: float
) -> None:
    initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    write(tmp_path, 'S : 0|16@1+ (0.5,0) [0|1000] "" B', tail='BA_ "GenMsgCycleTime" BO_ 1 10;\n')
    more = BUS.format(initial=initial)
    results = run(tmp_path / "initial.fmu", 'isolation = "none"', more=more)
    assert results["b.entered"][0] == results["b.left"][0] == value


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
def test_an_output_reaches_a_connected_input_within_the_initialization(
    tmp_path: Path, fmi: int, kind: str
) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    more = '[units.b]\nfmu = "initial.fmu"\nisolation = "none"\nstart = { u = 6.0 }\n'
    more += '[[connect]]\nfrom = "a.y"\nto = ["b.u"]\n'
    results = run(fmu, 'isolation = "none"\nparameters = { p = 5.0 }', more=more)
    if fmi == 1:  # a slave gives no outputs before it is initialized, and its y declares no start value
        assert results["b.left"][0] == 0.0
    else:
        assert (results["b.entered"][0], results["b.left"][0]) == (6.0, 15.0)
    assert results["b.u"][0] == 15.0
