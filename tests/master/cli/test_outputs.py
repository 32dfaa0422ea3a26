"""The output folder: it holds one run, and no file of the user's own is replaced.

The tests may run as root, whom no mode of a folder stops: hence a folder below a file, and a disk that a
patched call pretends to be full.
"""

from __future__ import annotations

import errno
import functools
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim import writing
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results import rescue
from evcosim.cosim.results.folder_lock import FolderLock, lives
from evcosim.cosim.results.results import Results
from evcosim.cosim.row_store import RowStore
from evcosim.master.cli import outputs
from evcosim.master.engine import engine
from support.answers import refused
from support.small_disk import small_disk


def test_files_of_an_earlier_run_do_not_stay(evcosim, tmp_path):
    assert evcosim("run", "scooter", "--stop-time", "0.5", "--can-log", "can.log", "-o", "out").code == 0
    assert evcosim("run", "scooter", "--stop-time", "0.5", "--no-plot", "-o", "out").code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results.csv", "run.json", "report.html"}


def test_output_below_a_file(evcosim, tmp_path):
    (tmp_path / "file").write_text("")
    refused(
        evcosim("run", "scooter", "-o", "file/results"),
        "output folder file/results: cannot be written: file is a file, not a folder;",
    )
    refused(evcosim("build", "Battery", "-o", "file/fmus"), "file/fmus", "cannot be written")


@pytest.mark.parametrize("name", ["figure.png", "results.csv", "run.json"])
def test_a_file_of_the_users_own_is_not_replaced(evcosim, tmp_path, name):
    (tmp_path / "out").mkdir()
    own = tmp_path / "out" / name
    own.write_text("[1, 2]")
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "-o", "out")
    refused(answer, f"output folder out: {name} would be replaced", "--output")
    assert own.read_text() == "[1, 2]"


def test_other_files_in_the_output_folder_stay(evcosim, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    for _ in range(2):
        assert evcosim("run", "scooter", "--stop-time", "0.1", "--no-plot", "-o", "out").code == 0
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_full_disk_before_the_run(evcosim, monkeypatch):
    def full(path):
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    monkeypatch.setattr(writing, "create", full)
    refused(evcosim("run", "scooter", "-o", "out"), "output folder out", "No space left on device")


def test_full_disk_after_the_run(evcosim, monkeypatch):
    def full(folder, results):
        raise OSError(errno.ENOSPC, "No space left on device", "out/figure.png")

    monkeypatch.setattr(outputs, "write_figure", full)
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "-o", "out")
    assert (answer.code, answer.err) == (
        1,
        "evcosim: out/figure.png: No space left on device: make room on the disk\n",
    )


def test_results_that_cannot_be_written_are_kept_elsewhere(evcosim, monkeypatch, tmp_path):
    write = Results.write

    def full(self, folder):
        if str(folder) == "out":
            raise ConfigError("out/results.csv: cannot be written: No space left on device")
        return write(self, folder)

    monkeypatch.setattr(Results, "write", full)
    monkeypatch.setattr(rescue, "complete", lambda *_: 0)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    (tmp_path / "elsewhere").mkdir()
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "-o", "out")
    assert answer.code == 1
    (kept,) = (tmp_path / "elsewhere").iterdir()
    first, second = answer.err.splitlines()
    assert first == "evcosim: out/results.csv: cannot be written: No space left on device"
    assert second == f"the results up to t = 0.1 s are kept in {kept}"
    assert len(Results.read(kept)) == 11
    assert Results.read(kept).manifest["status"] == "failed"
    # and where there is no folder for temporary files at all
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "gone"))
    answer = evcosim("run", "scooter", "--stop-time", "0.1", "-o", "out", "--isolation", "none", "--replace")
    assert answer.code in (1, 2)
    assert "unexpected" not in answer.err


def test_a_run_that_a_full_disk_stops_says_why_and_what_is_where(evcosim, monkeypatch, tmp_path):
    """Rows that are many need a file, and results.csv more room than they."""
    monkeypatch.setattr(engine, "RowStore", functools.partial(RowStore, memory=100_000))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    (tmp_path / "elsewhere").mkdir()
    with small_disk(tmp_path / "disk", 40) as disk:
        answer = evcosim("run", "scooter", "--no-plot", "-o", "disk/out")
        assert answer.code == 1
        why, csv, elsewhere, rows = answer.err.splitlines()
        full = "No space left on device: make room on the disk"
        stopped = re.match(
            r"evcosim: the run was stopped at t = (.*) of 40 s: what the run records cannot", why
        )
        assert stopped
        assert why.endswith(f" be kept in disk/out: {full}; `record` less needs less")
        assert csv == f"disk/out/results.csv: cannot be written: {full}"
        (kept,) = (tmp_path / "elsewhere").iterdir()
        assert elsewhere == f"the results up to t = {stopped[1]} s are kept in {kept}"
        found = re.match(
            r"(\d+) of (\d+) rows, up to t = (.*) s, are in disk/out/results.rows; `(.*)` ", rows
        )
        assert found
        assert found[4] == "evcosim results recover disk/out"
        results = Results.read(disk / "out")
        assert (len(results), results.manifest["status"]) == (int(found[1]), "failed")
        assert f"evcosim: {results.manifest['error']}" == why
        assert f"{results.span[1]:.6g}" == found[3]
        shutil.copytree(disk / "out", tmp_path / "moved")
    whole = Results.read(kept)
    assert len(whole) == int(found[2]) > len(results)
    assert whole.manifest["error"] == results.manifest["error"]
    answer = evcosim("results", "recover", "moved")
    first, second = answer.out.splitlines()
    assert first == f"moved: results.csv has {found[1]} rows, up to t = {found[3]} s; status: failed"
    assert second == f"moved: the results of the run, which found no room here, were kept in {kept}"
    assert np.array_equal(Results.read(tmp_path / "moved").data, whole.data[: len(results)])


def test_rows_that_fit_where_results_do_not_are_recovered_by_the_next_run(evcosim, tmp_path, monkeypatch):
    with small_disk(tmp_path / "disk", 32) as disk:
        monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
        short = ("run", "scooter", "--no-plot", "--no-report", "--stop-time", "4", "-o", "disk/out")
        answer = evcosim(*short)
        assert answer.code == 1
        first, second = answer.err.splitlines()
        assert first.startswith("evcosim: disk/out/results.csv: cannot be written: No space left on device")
        assert second.startswith(
            "all 401 rows are in disk/out/results.rows, which `evcosim plot` and `compare`"
        )
        answer = evcosim("compare", "disk/out", "disk/out")
        assert answer.code == 0
        refused(evcosim(*short), "disk/out/results.csv: cannot be written: No space left", "--output names")
        assert (disk / "out" / "results.rows").exists()
        shutil.copytree(disk / "out", tmp_path / "out")
    answer = evcosim(*short[:-1], "out")
    assert answer.code == 0
    assert "out: the run before left no results.csv; 401 of its rows were recovered" in answer.out


def test_a_default_folder_is_named_by_what_has_a_name():
    assert outputs.default_folder("scooter", "fig8", "budget") == Path("results/scooter-fig8-budget")
    assert outputs.default_folder("scooter", "") == Path("results/scooter")


def test_another_run_in_the_folder_stays(evcosim, tmp_path):
    """The suffix says what was set, a number comes where that is taken; the same run replaces its own."""
    short = ("run", "scooter", "--no-plot", "--stop-time", "1.1")
    assert evcosim(*short, "-o", "out").code == 0
    first = (tmp_path / "out" / "results.csv").read_bytes()
    answer = evcosim(*short, "-o", "out", "--set", "vehicle.mass=180")
    named = "out-vehicle.mass=180-stop_time=1.1"
    said = " ".join(answer.out.split())  # it is wrapped
    assert f"out has results of other files, FMUs or settings; this run's are in {named}" in said
    assert f"in {named}: results.csv, run.json" in answer.out
    assert evcosim(*short, "-o", "out", "--set", "vehicle.mass=180").code == 0  # where it was
    about = tmp_path / named / "run.json"
    about.write_text(about.read_text().replace('"sha256": "', '"sha256": "0', 1))  # of another FMU
    assert f"in {named}-2: results.csv" in evcosim(*short, "-o", "out", "--set", "vehicle.mass=180").out
    assert (tmp_path / "out" / "results.csv").read_bytes() == first
    folders = {path.name for path in tmp_path.iterdir()}
    assert folders == {"out", named, f"{named}-2"}
    answer = evcosim(*short, "-o", "out", "--ideal", "--replace", "--json")
    assert (answer.json["folder"], answer.json["warnings"]) == ("out", [])
    assert Results.read(tmp_path / "out").manifest["ideal"] is True


def test_settings_in_a_file_count(evcosim, tmp_path):
    scenario = tmp_path / "mine.toml"
    for value in (10.0, 20.0):
        scenario.write_text(
            'leave_out = ["rider", "planner", "battery"]\n[parameters.ecu]\nenabled = false\n'
            f'[[stimulus]]\nto = "ecu.throttle_request"\nconstant = {value}\n'
        )
        answer = evcosim("run", "scooter", "-s", scenario, "--no-plot", "--stop-time", "0.1", "-o", "out")
        assert answer.code == 0
    assert "this run's are in out-mine-stop_time=0.1" in " ".join(answer.out.split())


@pytest.mark.parametrize(
    ("options", "suffix"),
    [
        ({}, ""),
        (
            {"parameters": {"vehicle.mass": 180.0, "ecu.enabled": False}},
            "vehicle.mass=180.0-ecu.enabled=False",
        ),
        ({"fmus": {"vehicle": "my/Car 2.fmu"}, "ideal": True}, "vehicle=Car_2-ideal"),
        ({"algorithm": "jacobi", "engine": "python", "isolation": "none"}, "jacobi-python-isolation=none"),
        ({"parameters": {f"vehicle.p{i}": 1.0 for i in range(20)}}, ""),
        ({"parameters": {"a.b": "../../x/\x1b"}}, "a.b=.._.._x_"),
    ],
)
def test_a_suffix_says_what_was_set(options, suffix):
    assert outputs.suffix_of(options) == suffix


def test_the_names_of_folders_beside_the_working_folder_and_of_the_root(monkeypatch, tmp_path):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    second = [next(outputs.candidates(Path(name), "a")) for name in (".", "..", "/")]
    assert second == [Path("."), Path(".."), Path("/")]
    assert list(outputs.candidates(Path("."), "a"))[1:3] == [tmp_path / "here-a", tmp_path / "here-a-2"]
    assert list(outputs.candidates(Path("/"), "a")) == [Path("/")]


def test_a_folder_of_another_command_is_refused(evcosim, tmp_path):
    with FolderLock(tmp_path / "out"):
        refused(
            evcosim("reproduce", "scooter", "-o", "out"), "another run is writing into it", "--output names"
        )
    outputs.output_folder(tmp_path / "out")
    assert lives(tmp_path / "out")
    outputs.release()
    assert not lives(tmp_path / "out")
