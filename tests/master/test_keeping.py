"""A run that has a folder: what is in it while it goes on, and at its end."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim import ConfigError, Results, RunError, Simulation, simulate
from evcosim.cosim.results.run_folder import recover
from evcosim.fmus.build import build_model
from evcosim.master.keeping import ended
from support.c_fmu import typed_fmu
from support.cli_models import Fragile
from support.small_disk import small_disk


def status(folder: Path) -> str:
    found: str = json.loads((folder / "run.json").read_text())["status"]
    return found


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_run_fills_its_folder_and_says_how_it_ended(tmp_path: Path, engine: str) -> None:
    made = simulate("scooter", stop_time=1.0, engine=engine, folder=tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results.csv", "run.json"}
    assert status(tmp_path / "out") == "done"
    assert np.array_equal(Results.read(tmp_path / "out").data, made.data)
    simulate("scooter", stop_time=1.0, engine=engine, folder=tmp_path / "out")  # the same again
    with pytest.raises(ConfigError, match="it has the results of a run of other files, FMUs or settings"):
        simulate("scooter", stop_time=2.0, engine=engine, folder=tmp_path / "out")
    assert status(tmp_path / "out") == "done"


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_rows_are_there_while_it_goes_on(tmp_path: Path, engine: str) -> None:
    with Simulation("scooter", engine=engine) as sim:
        sim.keep_in(tmp_path)
        with pytest.raises(ConfigError, match="the run has a folder already"):
            sim.keep_in(tmp_path / "other")
        sim.step(50)
        sim._engine.store.save()
        saved = Results.read(tmp_path)
        assert saved.manifest["status"] == "running"
        assert np.array_equal(saved.data, sim.results.data[:50])
        assert saved.time.tolist() == sim.results.time[:50].tolist()
    assert (status(tmp_path), len(Results.read(tmp_path))) == ("stopped", 51)


def test_rows_that_left_the_memory_before_it_has_a_folder_are_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Simulation("scooter") as sim:
        monkeypatch.setattr(sim._engine.store, "_memory", 0)
        sim.step(40)
        sim.keep_in(tmp_path)
        sim.step(10)
        assert np.array_equal(Results.read(tmp_path).data, sim.results.data[:50])


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_no_row_is_on_the_disk_without_its_texts(tmp_path: Path, engine: str, isolation: str) -> None:
    fmu = typed_fmu(tmp_path / "typed.fmu", 2)
    options = {"engine": engine, "isolation": isolation, "step_size": 0.1, "stop_time": 2.0}
    with Simulation(fmu, inputs={"text_in": "first"}, **options) as sim:
        sim.keep_in(tmp_path / "out")
        sim.step(3)
        sim.override("fmu.text_in", "then")
        sim.step(3)
        sim._engine.store.save()
        saved, now = Results.read(tmp_path / "out"), sim.results
        assert saved.texts == now.texts == ("fmu.text_in", "fmu.text")
        for name in saved.texts:
            assert saved[name].tolist() == now[name][:6].tolist()
        assert saved["fmu.text_in"].tolist() == ["first"] * 3 + ["then"] * 3
        shutil.copytree(tmp_path / "out", tmp_path / "killed")
    left = {path.name for path in (tmp_path / "out").iterdir()}
    assert left == {"results.csv", "results.texts.csv", "run.json"}
    recovered = recover(tmp_path / "killed")
    assert {path.name for path in (tmp_path / "killed").iterdir()} == left
    assert recovered["fmu.text"].tolist() == Results.read(tmp_path / "killed")["fmu.text"].tolist()
    assert recovered["fmu.text"].tolist() == now["fmu.text"][:6].tolist()


def test_the_rows_of_a_run_of_texts_alone_are_counted(tmp_path: Path) -> None:
    typed_fmu(tmp_path / "typed.fmu", 2)
    system = tmp_path / "one.toml"
    system.write_text(
        'name = "one"\nrecord = ["a.text"]\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "typed.fmu"\n'
    )
    with Simulation(system) as sim:
        sim.keep_in(tmp_path / "out")
        sim.step(3)
        sim._engine.store.save()
        sim.set("a.text_in", "then")
        sim.step(4)
        sim._engine.store.save()
        saved, now = Results.read(tmp_path / "out"), sim.results
        assert (saved.names, saved.texts, len(saved)) == ((), ("a.text",), 7)
        assert saved["a.text"].tolist() == now["a.text"][:7].tolist()
        assert saved.time.tolist() == now.time[:7].tolist()


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_the_rows_of_a_chunk_are_seen_while_it_is_under_way(engine: str) -> None:
    with Simulation("scooter", engine=engine) as sim:
        assert sim._engine.rows_under_way().shape[0] == 0
        sim.step(20)
        assert np.array_equal(sim._engine.rows_under_way(), sim.results.data[:20])


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_chunk_that_begins_has_no_rows(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with Simulation("scooter", engine=engine) as sim:
        within, seen = sim._engine._run, []

        def run(*arguments: Any) -> None:
            seen.append((sim._engine.before, len(sim._engine.rows_under_way())))
            within(*arguments)

        monkeypatch.setattr(sim._engine, "_run", run)
        sim.step(20)
        sim.step(5)
    assert seen == [(0, 0), (20, 0)]


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_failed_run_saves_its_rows_once(tmp_path: Path, engine: str) -> None:
    fmu = build_model(Fragile, tmp_path)
    with Simulation(fmu, engine=engine, parameters={"last": 300}) as sim:
        sim.keep_in(tmp_path / "out")
        sim.step(200)
        with pytest.raises(RunError, match="the chain came off after 300 steps"):
            sim.step(200)
        assert sim._kept._keeper.save_all() == 300
        saved = Results.read(tmp_path / "out")
        assert saved["fmu.way"].tolist() == list(map(float, range(300)))


@pytest.mark.parametrize(
    ("error", "said"), [(RuntimeError("the chain came off"), "failed"), (KeyboardInterrupt(), "interrupted")]
)
def test_a_failure_fills_the_folder_too(tmp_path: Path, error: BaseException, said: str) -> None:
    with pytest.raises(type(error)), Simulation("scooter") as sim:
        sim.keep_in(tmp_path)
        sim.step(10)
        raise error
    about = json.loads((tmp_path / "run.json").read_text())
    assert (about["status"], about.get("error")) == (said, str(error) or None)
    assert len(Results.read(tmp_path)) == 11


def test_a_folder_that_another_run_has_is_refused(tmp_path: Path) -> None:
    with Simulation("scooter") as first, Simulation("scooter") as second:
        first.keep_in(tmp_path)
        with pytest.raises(ConfigError, match=r"the run 'scooter fig8', process .* is writing into it"):
            second.keep_in(tmp_path)
        second.step(1)


def test_the_end_is_said_in_the_manifest() -> None:
    results = Results([], np.empty((0, 0)), [])
    assert ended(results, True, None).manifest["status"] == "done"
    assert ended(results, False, None).manifest["status"] == "stopped"
    assert ended(results, True, ValueError()).manifest["error"] == "ValueError"


def test_a_full_disk_keeps_results_and_error_of_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The error of the disk replaces none of the run's own."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    with small_disk(tmp_path / "disk", 8) as disk:
        with pytest.raises(RunError, match="the results up to t = 1 s are kept in") as caught:
            simulate("scooter", stop_time=1.0, folder=disk / "a", isolation="none")
        assert caught.value.results is not None
        assert len(caught.value.results) == 101
        assert status(disk / "a") == "failed"
        (first,) = (path for path in (tmp_path / "elsewhere").iterdir() if (path / "results.csv").exists())
        assert np.array_equal(Results.read(first).data, caught.value.results.data)
        shutil.rmtree(disk / "a")
        with pytest.raises(KeyError) as mine, Simulation("scooter", isolation="none") as sim:
            sim.keep_in(disk / "b")
            sim.step(100)
            raise KeyError("mine")
        assert "results.csv: cannot be written: No space left on device" in mine.value.__notes__[0]
        about = json.loads((disk / "b" / "run.json").read_text())
        assert (about["status"], about["error"]) == ("failed", "'mine'")


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_rows_go_elsewhere_where_the_process_ends_at_once(tmp_path: Path, engine: str) -> None:
    fmu = typed_fmu(tmp_path / "typed.fmu", 2)
    (tmp_path / "place").mkdir()
    with Simulation(fmu, inputs={"text_in": "first"}, engine=engine, step_size=0.1, stop_time=2.0) as sim:
        sim.keep_in(tmp_path / "out")
        sim.step(3)
        sim.override("fmu.text_in", "then")
        sim.step(3)
        assert sim._kept is not None
        assert sim._kept.folder.spare is not None
        assert sim._kept.folder.spare(tmp_path / "place") == 6
        now = sim.results
    saved = Results.read(tmp_path / "place")
    assert np.array_equal(saved.data, now.data[:6])
    assert saved["fmu.text_in"].tolist() == ["first"] * 3 + ["then"] * 3


def test_files_that_are_removed_in_the_run_are_needed_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that it was made of, and the working folder: a digest of them stands in run.json."""
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    Path("speed.csv").write_text("time,v\n0,10\n9,50\n")
    Path("own.toml").write_text(
        'leave_out = ["rider", "planner", "battery"]\n[parameters.ecu]\nenabled = false\n'
        '[[stimulus]]\nto = "ecu.throttle_request"\ncsv = "speed.csv"\ncolumn = "v"\n'
    )
    whole = simulate("scooter", "own.toml", stop_time=1.0)
    with Simulation("scooter", "own.toml", stop_time=1.0, to_stop=True) as sim:
        sim.keep_in(tmp_path / "out")
        shutil.rmtree(tmp_path / "work")
        sim.run()
    kept = Results.read(tmp_path / "out")
    assert np.array_equal(kept.data, whole.data)
    for key in ("settings", "files", "units"):
        assert kept.manifest[key] == whole.manifest[key]
