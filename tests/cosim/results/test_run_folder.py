"""A folder holds the files of one run, and says how that ended."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.cosim.results.rows_file import head
from evcosim.cosim.results.run_folder import FILES, RunFolder, recover, same_settings
from evcosim.cosim.results.variable import ResultVariable

CLOCK = Clock.counted(0.0, 0.1, 9)
VARIABLES = [ResultVariable("a.x", "m/s")]
ABOUT: dict[str, Any] = {
    "evcosim": "0", "system": "toy", "scenario": "", "experiment": {"step_size": 0.1}, "order": ["a"],
    "units": {"a": {"sha256": "1", "parameters": {"m": 1.0}}}, "ideal": False, "buses": {}, "settings": "x",
    "saturations": {}, "loop_seconds": 0.0,
}  # fmt: skip # a table


def status(folder: Path) -> str:
    found: str = json.loads((folder / "run.json").read_text())["status"]
    return found


def begun(folder: Path, rows: int | None = None) -> None:
    """Leave a folder as a run does that is killed after it has saved some rows, or none."""
    with RunFolder(folder) as run:
        run.begin(ABOUT, VARIABLES)
        if rows is not None:
            run.rows.write_bytes(head(CLOCK, VARIABLES, ABOUT) + np.arange(float(rows)).tobytes() + b"half")


def done(folder: Path, about: dict[str, Any] = ABOUT) -> None:
    with RunFolder(folder) as run:
        run.begin(about, VARIABLES)
        run.finish(Results([0.0, 0.1], [[1.0], [2.0]], VARIABLES, {**about, "status": "done"}))


def test_the_begin_removes_what_an_earlier_run_left(tmp_path: Path) -> None:
    done(tmp_path)
    for name in (*FILES, "results.rows", ".evcosim-0a.part", "notes.txt"):
        (tmp_path / name).write_text("")
    begun(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"run.json", "notes.txt"}
    assert status(tmp_path) == "running"
    assert json.loads((tmp_path / "run.json").read_text())["process"]["id"] > 0


def test_a_killed_run_reads_and_is_recovered(tmp_path: Path) -> None:
    begun(tmp_path, rows=5)
    before = Results.read(tmp_path)
    assert (len(before), before.manifest["status"], before.manifest["steps"]) == (5, "killed", 5)
    assert "saturations" not in before.manifest  # they are counted at the end
    found = recover(tmp_path)
    assert found is not None
    assert {path.name for path in tmp_path.iterdir()} == {"run.json", "results.csv"}
    after = Results.read(tmp_path)
    assert status(tmp_path) == "killed"
    assert after.variables == tuple(VARIABLES)
    assert np.array_equal(after.data, np.arange(5.0)[:, None])
    assert recover(tmp_path) is None


def test_a_run_that_lives_is_read_and_not_recovered(tmp_path: Path) -> None:
    begun(tmp_path, rows=2)
    with RunFolder(tmp_path):
        assert Results.read(tmp_path).manifest["status"] == "running"
        with pytest.raises(ConfigError, match="the run 'toy', process"):
            recover(tmp_path)


def test_a_run_that_was_killed_at_once_has_nothing(tmp_path: Path) -> None:
    begun(tmp_path)
    with pytest.raises(ConfigError, match="the run was killed before it had saved any rows; run it again"):
        recover(tmp_path)
    with pytest.raises(ConfigError, match=r"no such folder"):
        recover(tmp_path / "none")


BEGIN = head(CLOCK, VARIABLES, ABOUT)


@pytest.mark.parametrize(
    "left", [b"", BEGIN[:1], BEGIN[:100], BEGIN[:-1], 512 * b"\0", BEGIN[:60] + 512 * b"\0"]
)
def test_half_a_first_line_is_of_a_run_that_saved_no_row(tmp_path: Path, left: bytes) -> None:
    begun(tmp_path)
    (tmp_path / "results.rows").write_bytes(left)
    with pytest.raises(ConfigError, match=r"results.rows: no row was saved in it: the run ended before that"):
        Results.read(tmp_path)
    with RunFolder(tmp_path) as run:  # the next run
        assert not run.has_rows and not run.foreign_files()
        assert not run.is_of_another({**ABOUT, "system": "other"})
    with pytest.raises(ConfigError, match="the run was killed before it had saved any rows; run it again"):
        recover(tmp_path)
    with RunFolder(tmp_path) as run:
        assert run.recover() is None
        run.begin(ABOUT, VARIABLES)
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]


@pytest.mark.parametrize("kept", [0, 1, 5, 12, 40, -30])
@pytest.mark.parametrize("zeros", [0, 100])
def test_half_a_run_json_stands_in_no_ones_way(tmp_path: Path, kept: int, zeros: int) -> None:
    begun(tmp_path, rows=3)
    manifest = tmp_path / "run.json"
    text = manifest.read_bytes().rstrip()
    manifest.write_bytes(text[:kept] + zeros * b"\0")
    read = Results.read(tmp_path)
    assert (len(read), read.manifest["status"], read.manifest["system"]) == (3, "killed", "toy")
    found = recover(tmp_path)
    assert found is not None and len(found) == 3
    after = Results.read(tmp_path)
    assert (after.manifest["status"], after.variables, len(after)) == ("killed", tuple(VARIABLES), 3)
    # results.csv alone beside it: nobody knows what it is of, so that no run replaces it
    manifest.write_bytes(text[:kept] + zeros * b"\0")
    with RunFolder(tmp_path) as run:
        assert not run.foreign_files() and run.is_of_another(ABOUT)
    found = recover(tmp_path)
    assert found is not None and found.manifest["status"] == "killed"
    assert Results.read(tmp_path).data.tolist() == [[0.0], [1.0], [2.0]]
    with RunFolder(tmp_path) as run:
        assert not run.foreign_files() and run.is_of_another(ABOUT)
    # and without any rows the next run just runs
    for path in tmp_path.iterdir():
        path.unlink()
    manifest.write_bytes(text[:kept] + zeros * b"\0")
    with RunFolder(tmp_path) as run:
        assert not run.foreign_files() and run.recover() is None
        run.begin(ABOUT, VARIABLES)
    assert status(tmp_path) == "running"


@pytest.mark.parametrize(("values", "zeros"), [([1, 0, 2, 0, 0], 2), ([1, 0, 2], 0), ([0, 0, 0], 0), ([], 0)])
def test_zeros_at_the_end_of_a_killed_run_are_told(tmp_path: Path, values: list[int], zeros: int) -> None:
    begun(tmp_path)
    (tmp_path / "results.rows").write_bytes(BEGIN + np.array(values, dtype=float).tobytes())
    found = recover(tmp_path)
    assert found is not None and len(found) == len(values)
    told = [w for w in found.manifest.get("warnings", ()) if "hold zeros alone" in w]
    assert [w.split()[2] for w in told] == [str(zeros)] * bool(zeros)


def test_a_run_json_of_somebodys_own_is_no_half_one(tmp_path: Path) -> None:
    for text in ("mine", "{}", "[", '{"name": 1', "{ }"):
        (tmp_path / "run.json").write_text(text)
        with RunFolder(tmp_path) as run:
            assert run.foreign_files() == ["run.json"]


def test_a_run_that_was_killed_between_its_files_is_whole(tmp_path: Path) -> None:
    begun(tmp_path, rows=1)  # the rows that were saved are fewer than the results that were written
    Results([0.0, 0.1], [[1.0], [2.0]], VARIABLES).to_csv(tmp_path / "results.csv")
    assert Results.read(tmp_path).manifest["status"] == "killed"
    found = recover(tmp_path)
    assert found is not None
    assert len(found) == 2
    assert (status(tmp_path), (tmp_path / "results.rows").exists()) == ("killed", False)


def test_rows_that_stayed_after_the_last_word_are_removed(tmp_path: Path) -> None:
    done(tmp_path)
    (tmp_path / "results.rows").write_bytes(head(CLOCK, VARIABLES, ABOUT))
    assert recover(tmp_path) is None
    assert (status(tmp_path), (tmp_path / "results.rows").exists()) == ("done", False)


def test_only_a_run_of_the_same_settings_is_replaced(tmp_path: Path) -> None:
    done(tmp_path)
    other = json.loads(json.dumps(ABOUT))
    other["units"]["a"]["sha256"] = "2"
    with RunFolder(tmp_path) as run:
        run.check(ABOUT | {"steps": 3, "loop_seconds": 1.0})
        with pytest.raises(ConfigError, match="it has the results of a run of other files, FMUs or settings"):
            run.check(other)
        (tmp_path / "results.csv").unlink()
        run.check(other)  # no row is lost
        (tmp_path / "run.json").unlink()
        (tmp_path / "figure.png").symlink_to("nowhere")
        with pytest.raises(ConfigError, match=r"figure.png would be replaced, but no run.json says"):
            run.check(ABOUT)


@pytest.mark.parametrize("key", ["system", "scenario", "settings", "experiment", "ideal", "order", "units"])
def test_every_setting_counts(key: str) -> None:
    assert same_settings(ABOUT, dict(ABOUT))
    assert not same_settings(ABOUT, {**ABOUT, key: "other"})
    assert same_settings(ABOUT, {k: v for k, v in ABOUT.items() if k != key})


def test_a_folder_that_cannot_be_emptied_is_named(tmp_path: Path) -> None:
    (tmp_path / "results.csv").mkdir()
    with RunFolder(tmp_path) as run, pytest.raises(ConfigError, match=r"cannot be written: .*results.csv"):
        run.begin(ABOUT, VARIABLES)


def test_a_csv_that_was_cut_off_at_the_end_of_a_row_is_found_and_mended(tmp_path: Path) -> None:
    done(tmp_path)
    whole = (tmp_path / "results.csv").read_bytes()
    for rows in (1, 0):
        done(tmp_path)
        (tmp_path / "results.csv").write_bytes(b"".join(whole.splitlines(keepends=True)[: 1 + rows]))
        with pytest.raises(
            ConfigError, match=rf"results.csv: has {rows} rows, where run.json says 2: .*recover"
        ):
            Results.read(tmp_path)
        found = recover(tmp_path)
        assert found is not None
        assert (len(found), status(tmp_path)) == (rows, "cut off")
        assert len(Results.read(tmp_path)) == rows
        assert recover(tmp_path) is None


def test_a_csv_that_is_none_stands_in_no_runs_way(tmp_path: Path) -> None:
    done(tmp_path)
    for content in (b"", b"tim", b"a,b\n0,1\n"):
        (tmp_path / "results.csv").write_bytes(content)
        assert recover(tmp_path) is None


def test_a_part_that_is_written_is_whole(tmp_path: Path) -> None:
    done(tmp_path)
    part = Results.read(tmp_path).part(slice(0, 1), ["a.x"])
    part.write(tmp_path / "part")
    assert len(Results.read(tmp_path / "part")) == 1
    assert "rows" not in Results.read(tmp_path / "part").manifest


def test_a_csv_that_was_cut_off_within_its_last_row_is_mended(tmp_path: Path) -> None:
    """Whatever is left of the last row: it may be half a number."""
    done(tmp_path)
    whole = (tmp_path / "results.csv").read_bytes()
    assert recover(tmp_path) is None
    last = whole.rindex(b"\n", 0, -1) + 1
    for end in range(last + 1, len(whole)):
        (tmp_path / "results.csv").write_bytes(whole[:end])
        with pytest.raises(ConfigError, match=r"results.csv: line 3, the last, does not end: '0.*recover"):
            Results.read(tmp_path)
        found = recover(tmp_path)
        assert found is not None
        assert (len(found), status(tmp_path)) == (1, "cut off")
        assert Results.read(tmp_path).data.tolist() == [[1.0]]
