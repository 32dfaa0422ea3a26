"""`evcosim run`: its folder, its options, and equal bytes for equal runs."""

from __future__ import annotations

import json
import resource
import subprocess
import sys

import pytest

from evcosim.cosim.results.results import Results
from support.answers import refused
from support.c_fmu import mixed_fmu, typed_fmu
from support.needs import need_linux


def test_run_says_and_writes_what_happened(evcosim, tmp_path):
    answer = evcosim("run", "scooter", "--stop-time", "3", "--can-log", "can.log", "--can-log", "can.pcapng")
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
    expected = {"results.csv", "run.json", "figure.png", "figure.svg", "report.html"}
    expected |= {"can.log", "can.pcapng"}
    assert {path.name for path in folder.iterdir()} == expected
    assert "\nin results/scooter-fig8: results.csv, run.json" in answer.out
    manifest = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert manifest["status"] == "done"
    assert manifest["metrics"]["distance"]["value"] > 0.0
    assert len((folder / "can.log").read_text().splitlines()) > 300


def test_run_as_json(evcosim):
    data = evcosim(
        "run", "scooter", "--stop-time", "1", "--no-plot", "--no-report", "--json", "-o", "out"
    ).json
    assert data["status"] == "done"
    assert data["simulated_seconds"] == pytest.approx(1.0)
    assert data["files"] == ["results.csv", "run.json"]
    assert set(data["metrics"]) >= {"distance"}
    assert data["final"]["battery.state_of_charge"] <= 1.0


def test_run_quietly(evcosim):
    answer = evcosim("run", "scooter", "--stop-time", "1.1", "--no-plot", "--quiet")
    assert (answer.code, answer.out, answer.err) == (0, "", "")


def test_a_figure_for_which_there_is_no_memory_is_left_out(evcosim, monkeypatch, tmp_path):
    monkeypatch.setattr("evcosim.cosim.shortage.memory_left", lambda: 220e6)
    monkeypatch.setattr("evcosim.master.cli.run._FIGURE", 230e6)
    monkeypatch.delitem(sys.modules, "matplotlib.figure", raising=False)
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "--quiet", "--output", str(tmp_path / "out"))
    assert answer.code == 0
    assert "warning: no figure and no page: drawing needs 230 MB of memory, and 220 MB are left" in answer.err
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == ["results.csv", "run.json"]


@pytest.mark.parametrize("most", [300_000, 450_000, 600_000])
def test_a_command_with_little_memory_runs_or_says_so(most, tmp_path):
    need_linux()
    limit = most * 1024
    run = subprocess.run(
        [sys.executable, "-m", "evcosim", "run", "scooter", "--stop-time", "2", "-q", "-o", tmp_path / "out"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip # the arguments together
    assert "unexpected" not in run.stderr and "Traceback" not in run.stderr
    said = f"the limit of memory is {most} KiB (`ulimit -v`"
    if run.returncode:
        assert run.returncode == 1
        assert run.stderr.startswith("evcosim: a run needs 150 MB of memory, and ") and said in run.stderr
    else:
        assert len(Results.read(tmp_path / "out")) == 201
        assert said in run.stderr or not run.stderr


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


def test_results_name_own_files(evcosim, system, tmp_path):
    path = system({"cart": "Fragile"}, stop_time=0.1)
    evcosim("run", path, "--no-plot", "-q", "-o", "out")
    assert Results.read(tmp_path / "out").manifest["files"] == {"system": str(path)}


def test_the_units_in_processes_of_their_own_are_named(evcosim):
    apart = evcosim("run", "scooter", "--stop-time", "0.1", "--no-plot", "--isolation", "process")
    assert "isolated" in apart.out and "in a process of its own)" in apart.out
    assert (
        "isolated  none\n" in evcosim("run", "scooter", "--stop-time", "0.1", "--no-plot", "-o", "here").out
    )
    units = evcosim("info", "scooter", "--json").json["units"]
    assert {unit["isolation"] for unit in units} == {"none"}


def test_the_summary_says_what_was_read_from_elsewhere(evcosim, tmp_path):
    (tmp_path / "elsewhere.csv").write_text("time,grip\n0,50\n1,60\n")
    (tmp_path / "given").mkdir()
    stimulus = '[[stimulus]]\nto = "ecu.throttle_request"\ncsv = "../elsewhere.csv"\n'
    (tmp_path / "given" / "own.toml").write_text(f'leave_out = ["rider"]\n{stimulus}')
    command = ["run", "scooter", "-s", "given/own.toml", "--stop-time", "0.1", "--no-plot", "-o", "out"]
    said = "given/own.toml: stimulus 1.csv reads given/../elsewhere.csv, which is not in the folder of"
    assert said in " ".join(evcosim(*command).out.split())
    (told,) = evcosim(*command, "--json").json["outside"]
    assert told.startswith(said)
    assert evcosim(*command[:2], *command[4:], "--json").json["outside"] == []


TEXTS = """
name = "texts"
record = [{record}]
[experiment]
stop_time = 0.05
[units.a]
fmu = "mixed.fmu"
[units.b]
fmu = "typed.fmu"
[[connect]]
from = "a.shown"
to = ["b.text_in"]
"""


def test_texts_are_set_shown_compared_and_not_drawn(evcosim, tmp_path):
    mixed_fmu(tmp_path / "mixed.fmu", 2)
    typed_fmu(tmp_path / "typed.fmu", 3)
    for name, record in (("texts", '"*"'), ("only", '"*.text"')):
        (tmp_path / f"{name}.toml").write_text(TEXTS.format(record=record))
    first = evcosim("run", "texts.toml", "--set", 'a.title=one, "two"', "-o", "first")
    assert first.code == 0
    assert """a.shown   'one, "two"'""" in first.out and """b.text    'one, "two"'""" in first.out
    files = "results.csv, results.texts.csv, run.json, figure.png, figure.svg, report.html"
    assert f"in first: {files}\n" in first.out
    second = evcosim("run", "texts.toml", "--set", 'a.title="5"', "-o", "second", "--json").json
    assert (second["final"]["b.text"], second["files"]) == ("5", files.split(", "))
    other = evcosim("compare", "first", "second")
    said = """'one, "two"' and '5'; they differ at 5 of 6 times"""
    assert other.code == 1 and said in " ".join(other.out.split())
    assert evcosim("compare", "first", "second", "--signals", "a.y").code == 0
    assert evcosim("compare", "first", "first", "--signals", "*.text").code == 0
    refused(evcosim("run", "texts.toml", "--set", "a.title=5"), "--set a.title=5: title is a String, not 5")
    only = evcosim("run", "only.toml", "-o", "only")
    assert only.code == 0 and "no figure: the run records no numbers" in only.out
    assert evcosim("plot", "first").code == 0
    refused(evcosim("plot", "only"), "the results have no variable to draw: texts are not drawn")


def test_an_event_that_never_acts_is_told_and_changes_nothing(evcosim, tmp_path):
    event = '[[event]]\ntime = {}\naction = "override"\nvariable = "vehicle.throttle"\nvalue = 90.0\n'
    rows = {}
    for name, time in (("last", 0.19), ("late", 0.2)):
        (tmp_path / f"{name}.toml").write_text(event.format(time), encoding="utf-8")
        options = ("--scenario", f"{name}.toml", "--stop-time", "0.2", "--no-plot", "-o", name)
        answer = evcosim("run", "scooter", *options)
        manifest = json.loads((tmp_path / name / "run.json").read_text(encoding="utf-8"))
        said = [text for text in manifest["warnings"] if "event 1" in text]
        assert all(text in " ".join(answer.out.split()) for text in said)
        assert (len(said), answer.code) == (name == "late", 0)
        rows[name] = Results.read(tmp_path / name)["vehicle.throttle"]
    assert said[0].startswith(
        "late.toml: event 1, override of vehicle.throttle at t = 0.2 s, never acts: the "
    )
    assert (90.0 in rows["last"], 90.0 in rows["late"]) == (True, False)
