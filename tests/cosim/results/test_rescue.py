"""The results of a run whose folder takes no results.csv are kept, and run.json says where."""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.results import rescue
from evcosim.cosim.results.folder_lock import kept_elsewhere
from evcosim.cosim.results.results import Results
from evcosim.cosim.results.rows_file import head
from evcosim.cosim.results.run_folder import RunFolder, recover
from evcosim.cosim.results.text_table import TextTable
from evcosim.cosim.results.variable import ResultVariable
from evcosim.cosim.row_store import Grid
from support.forked import forked
from support.needs import need_linux
from support.small_disk import small_disk

COUNT = 2000
CLOCK = Clock.counted(0.0, 0.1, COUNT)
VARIABLES = [ResultVariable("a.x", "m/s"), ResultVariable("a.y")]
TEXTS = TextTable([ResultVariable("a.s", type="String")], [(0, ("",)), (1500, ("on",))])
ABOUT: dict[str, Any] = {"evcosim": "0", "system": "toy", "warnings": [], "experiment": {"step_size": 0.1}}
VALUES = np.arange(2.0 * COUNT).reshape(-1, 2) / 7.0  # 8 bytes each as rows, and 18 in results.csv
ROWS_SIZE = 8 * VALUES.size


def results_of(**manifest: Any) -> Results:
    about = {**ABOUT, "status": "done", "steps": COUNT - 1} | manifest
    return Results(Grid(CLOCK, COUNT), VALUES, VARIABLES, about, texts=TEXTS)


def begun(folder: Path, saved: int = 0) -> RunFolder:
    """The folder of a run that has saved some rows."""
    run = RunFolder(folder)
    run.begin(ABOUT, (*VARIABLES, *TEXTS.variables))
    run.head = head(CLOCK, VARIABLES, ABOUT)
    if saved:
        run.rows.write_bytes(run.head + VALUES[:saved].tobytes() + b"half")
    return run


def about(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "run.json").read_text())
    return found


def refusal(run: RunFolder, results: Results) -> str:
    """What the end of a run says of a disk that refuses; "": nothing."""
    with run:
        try:
            rescue.finish(run, results)
        except RunError as error:
            return str(error)
    return ""


def limited_refusal(most: int, run: RunFolder, results: Results) -> str:
    """The same in a copy of this process whose files have at most so many bytes."""

    def within() -> str:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
        return refusal(run, results)

    need_linux()
    found = forked(within)
    run.release()  # which the copy had too
    assert not found.crash, found.crash
    return str(found.value)


@pytest.mark.parametrize("saved", [0, 700])
def test_rows_that_fit_where_results_do_not_are_kept_whole(saved: int, tmp_path: Path) -> None:
    run = begun(tmp_path, saved)
    manifest = {"metrics": {"distance": {"value": 1.0, "unit": "km"}}, "loop_seconds": 2.0}
    said = limited_refusal(ROWS_SIZE + 5000, run, results_of(**manifest))
    first, second = said.splitlines()
    assert first.startswith(f"{tmp_path}/results.csv: cannot be written: File too large: the limit of a file")
    assert second.startswith(f"all {COUNT} rows are in {tmp_path}/results.rows, which `evcosim plot` and")
    assert f"`evcosim results recover {tmp_path}` makes results.csv of them" in second
    assert (about(tmp_path)["status"], about(tmp_path)["unwritten"]) == ("done", first)
    read = Results.read(tmp_path)
    assert np.array_equal(read.data, VALUES)
    assert read["a.s"].tolist() == [""] * 1500 + ["on"] * 500
    assert read.manifest["metrics"] == manifest["metrics"]
    found = recover(tmp_path)
    assert found is not None
    assert {path.name for path in tmp_path.iterdir()} == {"results.csv", "results.texts.csv", "run.json"}
    assert (about(tmp_path)["status"], about(tmp_path).get("unwritten")) == ("done", None)
    assert np.array_equal(Results.read(tmp_path).data, VALUES)
    assert recover(tmp_path) is None


def test_as_many_whole_rows_as_fit_are_kept(tmp_path: Path) -> None:
    run = begun(tmp_path, 300)
    said = limited_refusal(ROWS_SIZE // 2, run, results_of())
    assert "File too large: the limit of a file's size is 16 KiB (`ulimit -f`" in said
    assert "nor can they be kept elsewhere" in said
    kept = (ROWS_SIZE // 2 - len(run.head)) // 16
    assert f"{kept} of {COUNT} rows, up to t = {CLOCK.at(kept - 1):.6g} s, are in {run.rows}" in said
    assert about(tmp_path)["status"] == "failed"
    assert about(tmp_path)["error"] == about(tmp_path)["unwritten"] == said.splitlines()[0]
    found = recover(tmp_path)
    assert found is not None
    assert (about(tmp_path)["status"], len(found)) == ("failed", kept)
    assert np.array_equal(Results.read(tmp_path).data, VALUES[:kept])


@pytest.mark.parametrize(
    ("before", "status", "error"),
    [
        ({}, "failed", "cannot be written"),
        ({"status": "failed", "error": "the chain came off"}, "failed", "the chain came off"),
        ({"status": "interrupted"}, "interrupted", None),
    ],
)
def test_a_full_disk_keeps_run_json_true(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: dict[str, Any], status: str, error: str | None
) -> None:
    """Not one byte is free: what run.json says is changed where it stands."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    with small_disk(tmp_path / "disk", 6) as disk:
        run = begun(disk / "out", 300)
        fill(disk)
        said = refusal(run, results_of(**before))
        (kept,) = (tmp_path / "elsewhere").iterdir()
        assert "No space left on device: make room on the disk\nthe results up to t = 199.9 s are" in said
        assert f"are kept in {kept}" in said
        found = about(disk / "out")
        assert (found["status"], found["kept_in"], found["steps"]) == (status, str(kept), COUNT - 1)
        assert error in found["error"] if error else "error" not in found
        assert found["variables"] == json.loads((kept / "run.json").read_text())["variables"]
        rows = Results.read(disk / "out")
        assert np.array_equal(rows.data, VALUES[: len(rows)])
        assert len(rows) >= 300
        assert f"{len(rows)} of {COUNT} rows" in said
    assert np.array_equal(Results.read(kept).data, VALUES)


def fill(disk: Path) -> None:
    """Take the last byte of a disk."""
    with (disk / "other").open("wb", buffering=0) as file, pytest.raises(OSError):
        while True:
            file.write(bytes(100))


def test_where_run_json_alone_finds_no_room_the_rows_make_it(tmp_path: Path) -> None:
    page = os.sysconf("SC_PAGE_SIZE")
    pages = 40
    with small_disk(tmp_path / "disk", pages) as disk:
        run = begun(disk / "out", COUNT)
        results = results_of()
        results.write(tmp_path / "try")
        shutil.copy(tmp_path / "try" / "results.texts.csv", disk / "out")
        size = (tmp_path / "try" / "results.csv").stat().st_size
        used = sum(-(-path.stat().st_size // page) for path in (disk / "out").iterdir())
        (disk / "other").write_bytes(bytes(page * (pages - used - -(-size // page))))
        assert refusal(run, results) == ""  # all is there
        assert {path.name for path in (disk / "out").iterdir()} == {
            "results.csv", "results.texts.csv", "run.json",
        }  # fmt: skip # a list
        assert about(disk / "out")["status"] == "done"
        assert np.array_equal(Results.read(disk / "out").data, VALUES)


def test_a_folder_that_was_removed_is_made_anew(tmp_path: Path) -> None:
    run = begun(tmp_path / "out", 300)
    assert run.is_there
    shutil.rmtree(tmp_path / "out")
    assert not run.is_there
    results = results_of()
    assert refusal(run, results) == ""
    assert "was removed or renamed while the run went on, and was made anew" in run.remark
    assert about(tmp_path / "out")["warnings"] == [run.remark]
    assert np.array_equal(Results.read(tmp_path / "out").data, VALUES)


@pytest.mark.parametrize("name", ["results.csv", "figure.png", "results.rows"])
def test_a_folder_that_took_its_place_stays_as_it_is(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    run = begun(tmp_path / "out", 300)
    (tmp_path / "out").rename(tmp_path / "moved")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text("mine")
    said = refusal(run, results_of())
    (kept,) = (tmp_path / "elsewhere").iterdir()
    assert said == (
        f"output folder {tmp_path}/out: while the run went on, another one took its place\n"
        f"the results up to t = 199.9 s are kept in {kept}"
    )
    assert {path.name: path.read_text() for path in (tmp_path / "out").iterdir()} == {name: "mine"}
    found = recover(tmp_path / "moved")  # nobody has it any more
    assert found is not None
    assert len(found) == 300


def test_rows_of_somebody_else_are_not_completed(tmp_path: Path) -> None:
    for content in (b"mine", head(CLOCK, VARIABLES[:1], ABOUT)):
        run = begun(tmp_path)
        run.rows.write_bytes(content)
        said = limited_refusal(ROWS_SIZE + 5000, run, results_of())
        assert "nor can they be kept elsewhere" in said
        assert "results-" in said  # as rows, where temporary files are
        assert f"{COUNT} of {COUNT} rows are in " in said
        assert run.rows.read_bytes() == content
        shutil.rmtree(Path(said.rpartition(" rows are in ")[2]).parent)
        run.rows.unlink()


def test_the_rows_of_a_process_that_ends_at_once_go_where_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    run = begun(tmp_path / "out", 300)

    def refused() -> int:
        raise RunError("what the run records cannot be kept")

    def spare(place: Path) -> int:
        (place / "results.rows").write_bytes(run.head + VALUES.tobytes())
        return COUNT

    run.saver = refused
    with run:
        said = run.rescue()
        assert said.startswith(f"; 300 rows are in {run.rows}, and evcosim results recover {run.path} makes")
        assert said.endswith(" of them: what the run records cannot be kept")
        run.spare = spare
        said = run.rescue()
    (kept,) = (tmp_path / "elsewhere").iterdir()
    assert said.startswith(
        f"; {COUNT} rows are in {kept}, and evcosim results recover {kept} makes results.csv"
    )
    assert (about(run.path)["status"], about(run.path)["kept_in"]) == ("interrupted", str(kept))
    assert about(kept)["status"] == "interrupted"
    assert np.array_equal(Results.read(kept).data, VALUES)
    shutil.rmtree(run.path)
    run = RunFolder(tmp_path / "other")
    with run:
        run.begin(ABOUT, VARIABLES)
        run.saver = lambda: 300
        assert "no row was saved" in run.rescue()  # the rows that it speaks of are not there


def test_in_place_a_manifest_is_never_cut(tmp_path: Path) -> None:
    with small_disk(tmp_path / "disk", 4) as disk, begun(disk) as run:
        fill(disk)
        before = (disk / "run.json").read_bytes()
        assert "No space left on device" in run.note({"error": "e" * 9000})
        assert (disk / "run.json").read_bytes() == before
        assert run.note({"error": "e" * 1000}) == ""
        assert about(disk)["error"] == "e" * 1000
        assert len((disk / "run.json").read_bytes()) == len(before)


@pytest.mark.parametrize("saved", [0, 300])
def test_a_disk_that_is_read_only_in_the_end_hides_neither_the_end_nor_the_results(
    saved: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    with small_disk(tmp_path / "disk", 256) as disk:
        folder = disk / "out"
        run = begun(folder, saved)
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        said = refusal(run, results_of(saved=saved))
        (kept,) = (tmp_path / "temporary").iterdir()
        assert "Read-only file system" in said
        assert f"the results up to t = {CLOCK.at(COUNT - 1):.6g} s are kept in {kept}" in said
        assert about(folder)["status"] == "running", "nobody can change it"
        assert kept_elsewhere(folder) == kept
        with pytest.raises(ConfigError, match="Read-only file system"):
            recover(folder)
        if saved:
            assert (Results.read(folder).manifest["status"], len(Results.read(folder))) == ("cut off", saved)
        assert np.array_equal(Results.read(kept).data, VALUES)
        # another run's results are nobody's here
        manifest = json.loads((kept / "run.json").read_text())
        manifest["process"]["id"] += 1
        (kept / "run.json").write_text(json.dumps(manifest))
        assert kept_elsewhere(folder) is None
