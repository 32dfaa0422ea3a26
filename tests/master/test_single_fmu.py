"""An FMU by itself: times, values and inputs of a run, and all its outputs in the results."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim import ConfigError, simulate
from evcosim.cosim.system.system import load_system
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.single_fmu import names_fmu, one_fmu
from support.c_fmu import mixed_fmu
from support.descriptions import GOOD, described
from support.equations import equations_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

WITH_TIMES = GOOD.replace("<ModelVariables>", "<DefaultExperiment {}/><ModelVariables>")


def _experiment(folder: Path, times: str, **options: object) -> tuple[float, float, float]:
    path = described(folder, WITH_TIMES.format(times) if times else GOOD)
    found = one_fmu(str(path), None, options)[0].file.experiment  # type: ignore[arg-type] # options of a test
    return found.start_time, found.stop_time, found.step_size


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        ("", (0.0, 1.0, 0.002)),
        ('startTime="2" stopTime="3" stepSize="0.25"', (2.0, 3.0, 0.25)),
        ('stopTime="3"', (0.0, 3.0, 0.005)),
        ('startTime="5"', (5.0, 6.0, 0.002)),
        ('startTime="5" stopTime="4"', (5.0, 6.0, 0.002)),
        ('stopTime="1" stepSize="0.3"', (0.0, 1.0, 0.25)),
        ('stopTime="1" stepSize="7"', (0.0, 1.0, 0.002)),
        ('stopTime="1" stepSize="0"', (0.0, 1.0, 0.002)),
        ('stopTime="1e3" stepSize="1e-4"', (0.0, 1000.0, 1000.0 / 625_000)),
    ],
)
def test_the_default_experiment_gives_the_times(tmp_path, times, expected):
    assert _experiment(tmp_path, times) == pytest.approx(expected, rel=1e-12)


def test_the_callers_times_go_first(tmp_path):
    times = 'startTime="2" stopTime="3" stepSize="0.25"'
    assert _experiment(tmp_path, times, stop_time=4.0) == (2.0, 4.0, 0.25)
    assert _experiment(tmp_path, times, stop_time=4.0, step_size=0.1) == (2.0, 4.0, 0.1)
    assert _experiment(tmp_path, times, step_size=0.3) == (2.0, 3.0, 0.3)  # the run refuses it
    with pytest.raises(ConfigError, match=r"stop_time = 1.0 s is not a multiple .* 0.3 s"):
        simulate(mixed_fmu(tmp_path / "mixed.fmu", 2), step_size=0.3)


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_inputs_and_parameters_reach_the_fmu(tmp_path, fmi):
    path = mixed_fmu(tmp_path / "mixed.fmu", fmi)
    table = tmp_path / "table.csv"
    table.write_text("time,u,count_in\n0,1,5\n1,3,9\n", encoding="utf-8")
    results = simulate(
        path,
        parameters={"gain": 2.0},
        inputs={"u": str(table), "count_in": f"{table}:count_in", "switch_in": True},
        step_size=0.25,
    )
    assert results.time.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    # what it received: nothing is received any more at the stop time
    assert results["fmu.u"].tolist() == [1.0, 1.5, 2.0, 2.5, 2.5]
    assert results["fmu.count_in"].tolist() == [5, 5, 5, 5, 5]
    assert results["fmu.switch_in"].tolist() == [1.0] * 5
    shown = [v.name for v in results.variables]
    about = read_fmu(path).interface
    assert {f"fmu.{v.name}" for v in about.of_causality("input", "output")} == {*shown, *results.texts}
    again = simulate(path, parameters={"fmu.gain": 2.0}, inputs={"fmu.u": table}, step_size=0.25)
    assert np.array_equal(again["fmu.y"], results["fmu.y"])
    assert results.manifest["units"]["fmu"]["isolation"] == "process"
    with pytest.raises(ConfigError, match=r"parameter fmu.u: the input is driven by a stimulus"):
        simulate(path, parameters={"u": 7.0}, inputs={"u": table})
    start = simulate(path, parameters={"u": 7.0}, step_size=0.25)
    assert start["fmu.u"].tolist() == [7.0] * 5


@pytest.mark.parametrize("fmi", [2, 3])
def test_both_interfaces_of_an_fmu(tmp_path, fmi):
    path = equations_fmu(tmp_path / "both.fmu", "DECAY", fmi=fmi)
    exchange = simulate(path, interface="model_exchange", tolerance=1e-8, stop_time=1.0, step_size=0.1)
    assert exchange.manifest["units"]["fmu"]["interface"] == "model_exchange"
    assert exchange.manifest["units"]["fmu"]["tolerance"] == 1e-8


REFUSED = [
    (
        {"parameters": {"gian": 1.0}},
        r"parameter gian: .*mixed.fmu has no variable 'gian' .did you mean 'gain'",
    ),
    ({"parameters": {"gain": "x"}}, r"parameter fmu.gain"),
    ({"inputs": {"y": 1.0}}, "input y: .*: y is of causality output, not input"),
    ({"inputs": {"v": 1.0}}, "input v: .* has no variable 'v'"),
    ({"inputs": {"u": "x"}}, "input fmu.u"),
    ({"inputs": {"u": "none.csv"}}, r"none.csv: "),
    ({"inputs": {"u": "two.csv"}}, r"two.csv has no column 'u': write two.csv:COLUMN; columns: time, a, b"),
    ({"inputs": {"u": "two.csv:c"}}, r"there is no column 'c'"),
    ({"inputs": 3}, "inputs = 3: must be a mapping"),
    (
        {"parameters": {"gain": 3.0, "fmu.gain": 4.0}},
        r"parameter fmu.gain: 4.0 is for gain, which is given already: gain = 3.0",
    ),
    (
        {"inputs": {"fmu.u": "two.csv:a", "u": 2.0}},
        r"input u: 2.0 is for u, which is given already: fmu.u = 'two.csv:a'",
    ),
    ({"step_size": 0.0}, "step_size = 0.0: must be a number of seconds above 0"),
    ({"step_size": float("nan")}, "step_size = nan"),
    ({"stop_time": float("inf")}, r"^stop_time inf s is not finite"),
    ({"stop_time": float("nan")}, r"^stop_time nan s is not finite"),
    ({"tolerance": 2.0}, "tolerance = 2.0: must be a number between 0 and 1"),
    ({"interface": "me"}, "interface = 'me': must be"),
    ({"interface": "model_exchange"}, "it has no such interface"),
    ({"ideal": True}, "ideal is for a system; .*mixed.fmu is an FMU by itself"),
    ({"fmus": {"a": "b.fmu"}}, "fmus is for a system"),
    ({"delay": 0.1}, "delay is for a system"),
    ({"start": {"uu": 1.0}}, r"^start uu: .*mixed.fmu has no variable 'uu' \(did you mean 'u'\?\)"),
    ({"record": ["z"]}, r"^record: 'fmu.z' fits no variable"),
    ({"scenario": "fig8"}, "is an FMU, which has no scenarios: scenario fig8"),
]


@pytest.mark.parametrize(("options", "message"), REFUSED)
def test_what_does_not_fit_is_refused_by_name(tmp_path, monkeypatch, options, message):
    path = mixed_fmu(tmp_path / "mixed.fmu", 2)
    monkeypatch.chdir(tmp_path)
    Path("two.csv").write_text("time,a,b\n0,1,2\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        simulate(path, **options)


@pytest.mark.parametrize("option", [{"inputs": {"u": 1.0}}, {"tolerance": 1e-3}])
def test_a_system_takes_none_of_it(option):
    with pytest.raises(ConfigError, match=rf"{next(iter(option))} is for an FMU by itself"):
        simulate("scooter", **option)


def test_locals_are_recorded_where_there_is_no_output(tmp_path):
    text = GOOD.replace('causality="output"', 'causality="local"').replace(
        '<Outputs><Unknown index="2" dependencies="1"/></Outputs>', ""
    )
    made = one_fmu(str(described(tmp_path, text)), None, {})[0]
    assert made.file.record == ["*", "fmu.y"]


def test_the_names_of_fmus_and_of_systems(tmp_path):
    assert names_fmu("Scooter") and names_fmu(tmp_path / "a.fmu") and names_fmu("there/is/none.FMU")
    assert not names_fmu("scooter") and not names_fmu("a.toml") and not names_fmu(load_system("scooter"))
    with pytest.raises(ConfigError, match=r"none.fmu: there is no such FMU file"):
        simulate("there/is/none.fmu")


def test_the_command(evcosim, tmp_path):
    mixed_fmu(tmp_path / "mixed.fmu", 2)
    (tmp_path / "u.csv").write_text("time,u\n0,1\n1,3\n", encoding="utf-8")
    options = ("--input", "u=u.csv", "--set", "gain=2", "--step-size", "0.5", "--stop-time", "1")
    answer = evcosim("run", "mixed.fmu", *options)
    assert (answer.code, answer.err) == (0, ""), answer
    assert "2 steps of 0.5 s" in answer.out
    folder = tmp_path / "results" / "mixed"
    assert {"results.csv", "run.json", "figure.png", "figure.svg"} <= {p.name for p in folder.iterdir()}
    expected = simulate(
        tmp_path / "mixed.fmu",
        inputs={"u": str(tmp_path / "u.csv")},
        parameters={"gain": 2},
        step_size=0.5,
        stop_time=1.0,
    )
    last = (folder / "results.csv").read_text(encoding="utf-8").splitlines()[-1]
    assert last.startswith("1.0,2.0,")
    assert expected["fmu.u"].tolist() == [1.0, 2.0, 2.0]
    for typed, said in [
        (["--set", "gian=1"], "--set gian=1: mixed.fmu has no variable 'gian'"),
        (["--set", "gain=x"], "--set gain=x: "),
        (["--set", "gain"], "--set gain: it is written parameter=value"),
        (["--input", "u"], "--input u: it is written NAME=X"),
        (["--input", "v=1"], "--input v=1: mixed.fmu has no variable 'v'"),
        (["--input", "u=1", "--input", "u=2"], "--input u=2: 'u' is given already: --input u=1"),
        (
            ["--input", "u=1", "--input", "fmu.u=2"],
            "--input fmu.u=2: 2 is for u, which is given already: u = 1",
        ),
        (["--set", "gain=3", "--set", "gain=4"], "--set gain=4: 'gain' is given already: --set gain=3"),
        (
            ["--set", "fmu.gain=3", "--set", "gain=4"],
            "--set gain=4: 4 is for gain, which is given already: fmu.gain = 3",
        ),
        (["--input", "u=text"], "--input u=text: "),
        (["--scenario", "fig8"], "has no scenarios"),
    ]:
        refused = evcosim("run", "mixed.fmu", *typed)
        assert refused.code == 2
        assert said in " ".join(refused.err.split()), refused.err


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("Tank", "Tank"),
        ("Modelica.Blocks.Sine", "Modelica_Blocks_Sine"),
        ("2 tanks-b", "_2_tanks_b"),
        ("ü$", "ü_"),
    ],
)
def test_the_name_of_the_file_names_the_results(tmp_path, file, name):
    path = mixed_fmu(tmp_path / f"{file}.fmu", 2)
    assert simulate(path, stop_time=0.02, step_size=0.01).manifest["system"] == name


def test_a_column_that_says_another_unit_is_told_with_what_can_be_done(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("p.csv").write_text("time,power [kW]\n0,1\n9,2\n", encoding="utf-8")
    results = simulate("Battery", inputs={"power": "p.csv"}, stop_time=0.1)
    (said,) = [text for text in results.manifest["warnings"] if "column" in text]
    assert said == (
        "p.csv: column 'power [kW]': its values are taken in [W], the unit of fmu.power; `unit = \"kW\"` in "
        "a stimulus of a system converts them"
    )


def test_a_step_of_the_caller_is_no_step_of_files():
    with pytest.raises(ConfigError, match=r"^step_size = 0\.3 s: stop_time = 1\.0 s is not a multiple "):
        simulate("Battery", step_size=0.3, stop_time=1.0)
