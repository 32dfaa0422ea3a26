"""The verbs of the command line: what they print and write."""

from __future__ import annotations

import json
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.results.results import Results
from evcosim.master.cli import console
from evcosim.master.cli.arguments import parse_settings, scalar

LIGHT = "import sys, evcosim.master.cli.app as app; app.command(); print(*sys.modules)"


# ---- the command as such


def test_help_answers_at_once(process):
    def seconds():
        begin = time.perf_counter()
        assert "run" in process("--help").communicate()[0]
        return time.perf_counter() - begin

    assert min(seconds() for _ in range(5)) < 0.3


def test_help_imports_nothing_heavy():
    loaded = subprocess.run([sys.executable, "-c", LIGHT], capture_output=True, text=True, check=True).stdout
    heavy = {
        "numpy",
        "scipy",
        "pydantic",
        "fmpy",
        "pythonfmu",
        "matplotlib",
        "cantools",
        "can",
        "pint",
    }
    assert not heavy & set(loaded.split())


@pytest.mark.parametrize("verb", ["run", "list", "info", "plot", "compare", "build", "identify"])
def test_every_verb_has_help(evcosim, verb):
    answer = evcosim(verb, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Usage: evcosim {verb}" in answer.out


def test_version_and_no_verb(evcosim):
    assert evcosim("--version").out.startswith("evcosim 0.")
    answer = evcosim()
    assert answer.code == 2
    assert "Usage: evcosim" in answer.out


def test_reader_that_goes_away_is_no_error(process):
    run = process("list")
    run.stdout.close()
    run.stdout = None
    assert run.communicate()[1] == ""
    assert run.returncode == 141


# ---- list, info, build


def test_list(evcosim):
    answer = evcosim("list")
    assert answer.code == 0
    for text in ("scooter", "fig8 *", "ece15", "udds", "BoundController", "Battery"):
        assert text in answer.out
    data = evcosim("list", "--json").json
    assert {"scooter"} <= {system["name"] for system in data["systems"]}
    assert data["systems"][0]["default"] in data["systems"][0]["scenarios"]
    assert all(data["fmus"].values())


def test_info_of_an_fmu(evcosim):
    answer = evcosim("info", "BoundController")
    assert answer.code == 0
    for text in ("FMI 2.0 Co-Simulation", "saves and restores its state", "speed_measured", "km/h"):
        assert text in answer.out
    data = evcosim("info", "BoundController", "--json").json
    by_name = {v["name"]: v for v in data["variables"]}
    assert by_name["throttle"]["max"] == "100.0"
    assert by_name["speed_measured"]["causality"] == "input"
    assert "2 velocity" in by_name["state"]["description"]


def test_info_selects_variables(evcosim):
    inputs = evcosim("info", "BoundController", "--causality", "input", "--json").json["variables"]
    assert {v["causality"] for v in inputs} == {"input"}
    found = evcosim("info", "BoundController", "--causality", "input", "--search", "SPEED", "--json").json
    assert [v["name"] for v in found["variables"]] == ["speed_measured", "speed_bound"]
    assert "1 of 21 variables" in evcosim("info", "BoundController", "--search", "speed_m").out
    assert "0 of 21 variables" in evcosim("info", "BoundController", "--search", "nothing like it").out


DESCRIPTIONS = {
    "1.0": """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="1.0" modelName="Old" modelIdentifier="old" guid="{1}"
 numberOfContinuousStates="0" numberOfEventIndicators="0">
<ModelVariables><ScalarVariable name="level" valueReference="1" causality="output">
<Real unit="m" start="1.5"/></ScalarVariable></ModelVariables>
<Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>
</fmiModelDescription>""",
    "3.0": """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="New" instantiationToken="{1}">
<CoSimulation modelIdentifier="new" canGetAndSetFMUState="true" hasEventMode="true"/>
<ModelVariables><Float64 name="level" valueReference="1" causality="output" unit="m" start="1.5 2.5">
<Dimension start="2"/></Float64><Clock name="beat" valueReference="2" causality="input"
 intervalVariability="triggered"/></ModelVariables>
<ModelStructure><Output valueReference="1"/></ModelStructure>
</fmiModelDescription>""",
}


@pytest.mark.parametrize("version", DESCRIPTIONS)
def test_info_of_other_fmi_versions(evcosim, tmp_path, version):
    path = tmp_path / "other.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTIONS[version])
    answer = evcosim("info", path)
    assert answer.code == 0, answer
    for text in (f"FMI {version} Co-Simulation", "level", "output"):
        assert text in answer.out
    refused = evcosim("run", "scooter", "--fmu", f"battery={path}")
    assert refused.code == 2
    assert f"{path}: has no binary for this machine: binaries/" in refused.err


def test_info_of_a_system(evcosim, tmp_path):
    answer = evcosim("info", "scooter")
    assert answer.code == 0
    for text in ("vehicle.speed [m/s]", "can0.EMD_Status.EMD_VehicleSpeed", "(x 3.6)", "0.4 %", "fig8 *"):
        assert text in answer.out
    data = evcosim("info", "scooter", "--json").json
    assert [unit["name"] for unit in data["units"]] == ["rider", "planner", "ecu", "vehicle", "battery"]
    speed = next(c for c in data["connections"] if c["to"] == "ecu.speed_measured")
    assert (speed["from_unit"], speed["bus_unit"], speed["to_bus"], speed["to_receiver"]) == (
        "m/s",
        "km/h",
        "x 3.6",
        "",
    )


def test_build(evcosim, tmp_path):
    answer = evcosim("build", "Battery", "--output", "made")
    assert answer.out.strip() == "made/Battery.fmu"
    assert zipfile.is_zipfile(tmp_path / "made" / "Battery.fmu")
    cached = evcosim("build", "Battery").out.strip()
    assert (tmp_path / "made" / "Battery.fmu").read_bytes() == Path(cached).read_bytes()


# ---- run


def test_run_says_and_writes_what_happened(evcosim, tmp_path):
    answer = evcosim("run", "scooter", "--stop-time", "3", "--can-log")
    assert (answer.code, answer.err) == (0, "")
    for text in (
        "scooter fig8",
        "times real time",
        "planner, ecu, vehicle, battery (gauss_seidel, 300 steps",
    ):
        assert text in answer.out
    assert "distance" in answer.out
    assert len(answer.out.splitlines()) < 24
    folder = tmp_path / "results" / "scooter-fig8"
    expected = {"results.csv", "run.json", "figure.png", "figure.svg", "can.log", "can.blf", "can.asc"}
    assert {path.name for path in folder.iterdir()} == expected
    assert answer.out.splitlines()[-1].startswith("in results/scooter-fig8: results.csv, run.json")
    manifest = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert manifest["status"] == "done"
    assert manifest["metrics"]["distance"]["value"] > 0.0
    assert len((folder / "can.log").read_text().splitlines()) > 300


def test_run_as_json(evcosim):
    data = evcosim("run", "scooter", "--stop-time", "1", "--no-plot", "--json", "-o", "out").json
    assert data["status"] == "done"
    assert data["simulated_seconds"] == pytest.approx(1.0)
    assert data["files"] == ["results.csv", "run.json"]
    assert set(data["metrics"]) >= {"distance"}
    assert data["final"]["battery.state_of_charge"] <= 1.0


def test_run_quietly(evcosim):
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "--no-plot", "--quiet")
    assert (answer.code, answer.out, answer.err) == (0, "", "")


def test_same_run_same_bytes_and_settings_count(evcosim, tmp_path):
    def rows(name, *options):
        assert (
            evcosim("run", "scooter", "--stop-time", "2", "--no-plot", "-q", "-o", name, *options).code == 0
        )
        return (tmp_path / name / "results.csv").read_bytes()

    first = rows("a")
    assert rows("b") == first
    for options in (["--set", "vehicle.mass=150"], ["--ideal"], ["--algorithm", "jacobi"]):
        assert rows("c", *options) != first
    light = rows("d", "--set", "vehicle.mass=150.0", "--set", "ecu.use_observer=false")
    assert light != rows("e", "--set", "vehicle.mass=150")


def test_files_of_an_earlier_run_do_not_stay(evcosim, tmp_path):
    assert evcosim("run", "scooter", "--stop-time", "0.5", "--can-log", "-o", "out").code == 0
    assert evcosim("run", "scooter", "--stop-time", "0.5", "--no-plot", "-o", "out").code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results.csv", "run.json"}


def test_final_values_where_there_are_no_metrics(evcosim, system):
    answer = evcosim("run", system({"cart": "Fragile"}, stop_time=1.0), "--no-plot")
    assert answer.code == 0
    assert "cart.way  100 m" in answer.out


def test_final_value_of_a_bare_number(evcosim, tmp_path):
    path = tmp_path / "pack.toml"
    path.write_text('name = "pack"\n[units.pack]\nfmu = "Battery"\n[experiment]\nstop_time = 0.1\n')
    answer = evcosim("run", path, "--no-plot")
    assert "pack.state_of_charge  1\n" in answer.out


def narrow_bus(tmp_path):
    """A bus over which 20 m are the most that can be sent, as text of a system file."""
    dbc = tmp_path / "narrow.dbc"
    dbc.write_text(
        'VERSION ""\nNS_ :\nBS_:\nBU_: A B\nBO_ 16 Way: 2 A\n'
        ' SG_ Meters : 0|16@1+ (0.1,0) [0|20] "m" B\n'
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\nBA_DEF_DEF_ "GenMsgCycleTime" 10;\n'
        'BA_ "GenMsgCycleTime" BO_ 16 10;\n'
    )
    bus = f"[buses.can0]\ndbc = '{dbc.name}'\n"
    return bus + '[[connect]]\nfrom = "cart.way"\nto = ["other.u"]\nvia = "can0.Way.Meters"\n'


def test_run_reports_saturation(evcosim, system, tmp_path):
    path = system({"cart": "Fragile", "other": "Through"}, narrow_bus(tmp_path), stop_time=1.0)
    answer = evcosim("run", path, "--no-plot")
    assert "can0.Way.Meters 79 times, first at 0.21 s" in answer.out
    about = evcosim("run", path, "--no-plot", "--json").json["saturations"]["can0.Way.Meters"]
    assert about == {"count": 79, "first_time": pytest.approx(0.21)}


# ---- plot, compare


@pytest.fixture
def two_runs(evcosim, tmp_path):
    """Two short runs that differ in the vehicle's mass."""
    for name, mass in (("a", 200), ("b", 150)):
        options = ["--stop-time", "3", "--no-plot", "-q", "-o", name]
        assert evcosim("run", "scooter", "--set", f"vehicle.mass={mass}", *options).code == 0
    return tmp_path


def test_plot(evcosim, two_runs):
    assert evcosim("plot", "a").out.strip() == "a/figure.png"
    assert (two_runs / "a" / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert evcosim("plot", "a/results.csv", "-o", "own.svg", "--signals", "vehicle.*").code == 0
    svg = (two_runs / "own.svg").read_text(encoding="utf-8")
    assert "<svg" in svg
    nothing = evcosim("plot", "a", "--signals", "vehicle.sped")
    assert (nothing.code, "did you mean 'vehicle.speed'" in nothing.err) == (2, True)
    assert evcosim("plot", "a", "-o", "figure.txt").code == 2


def test_plot_of_a_system_that_is_gone(evcosim, system, tmp_path):
    path = system({"cart": "Fragile"}, stop_time=1.0)
    assert evcosim("run", path, "--no-plot", "-q", "-o", "out").code == 0
    path.unlink()
    assert evcosim("plot", "out").code == 0


def test_compare(evcosim, two_runs):
    same = evcosim("compare", "a", "a")
    assert (same.code, same.out.startswith("equal")) == (0, True)
    other = evcosim("compare", "a", "b", "--plot", "both.png")
    assert other.code == 1
    assert "vehicle.speed" in other.out
    assert (two_runs / "both.png").stat().st_size > 10_000
    assert evcosim("compare", "a", "b", "--tolerance", "1e9").code == 0
    data = evcosim("compare", "a", "b", "--json").json
    assert data["equal"] is False
    assert evcosim("compare", "a", "b", "--tolerance", "-1").code == 2


# ---- the parts


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("false", False),
        ("180", 180),
        ("-3", -3),
        ("1_000", 1000),
        ("0.5", 0.5),
        (".5", 0.5),
        ("1e3", 1000.0),
        ("True", "True"),
        ("velocity", "velocity"),
        ('"180"', "180"),
        ("[1, 2]", "[1, 2]"),
        ("a = b", "a = b"),
        ("1\nother = 2", "1\nother = 2"),
    ],
)
def test_scalars(text, value):
    assert scalar(text) == value
    assert type(scalar(text)) is type(value)


def test_last_setting_counts():
    assert parse_settings(["a.b=1", "a.c=x=y", "a.b=2"]) == {"a.b": 2, "a.c": "x=y"}


@pytest.mark.parametrize("columns", ["20", "40", "80", "200"])
def test_tables_lose_nothing_however_narrow(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    text = "a long description of the thing that has to be wrapped somewhere"
    console.print_table(
        ("name", "unit", "about"), [("speed", "m/s", text), ("mass", "kg", "")], right=("unit",)
    )
    said = capsys.readouterr().out
    assert "speed   m/s" in said
    assert " ".join(said.split()).endswith("mass kg")
    assert all(word in said.split() for word in text.split())
    assert not any(line != line.rstrip() for line in said.splitlines())


def test_json_has_no_nan(capsys):
    console.print_json({"a": [float("nan"), np.float64(1.0)], "b": float("inf")})
    assert json.loads(capsys.readouterr().out) == {"a": [None, 1.0], "b": None}


def test_results_name_own_files(evcosim, system, tmp_path):
    path = system({"cart": "Fragile"}, stop_time=0.1)
    evcosim("run", path, "--no-plot", "-q", "-o", "out")
    assert Results.read(tmp_path / "out").manifest["files"] == {"system": str(path)}
