"""Any prefix of a file of rows reads, as the rows that it holds whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.cosim.results.rows_file import file_of_run, has_no_row, head, read
from evcosim.cosim.results.variable import ResultVariable

VARIABLES = [ResultVariable("a.x", "m/s"), ResultVariable("b.n", type="Integer", variability="discrete")]
HEAD = head(Clock.counted(0.5, 0.1, 4), VARIABLES, {"system": "toy", "note": "ä\udc80"})
ROWS = np.arange(10.0).reshape(5, 2)


@given(st.integers(0, ROWS.nbytes))
def test_a_prefix_reads(tmp_path_factory: pytest.TempPathFactory, kept: int) -> None:
    path = tmp_path_factory.mktemp("rows") / "results.rows"
    path.write_bytes(HEAD + ROWS.tobytes()[:kept])
    results = Results.read(path)
    n = kept // 16
    assert np.array_equal(results.data, ROWS[:n])
    assert np.array_equal(results.time, [0.5, 0.6, 0.7, 0.8, 0.9][:n])
    assert results.variables == tuple(VARIABLES)
    assert (results.manifest["system"], results.manifest["steps"]) == ("toy", n)


def test_rows_begin_at_a_multiple_of_eight_bytes() -> None:
    assert len(HEAD) % 8 == 0
    assert HEAD.endswith(b"\n")
    assert HEAD.count(b"\n") == 1


@pytest.mark.parametrize("kept", [0, 1, 40, len(HEAD) - 1])
def test_half_a_head_is_of_a_run_that_saved_no_row(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "results.rows"
    path.write_bytes(HEAD[:kept])
    for zeros in (0, 1, 4096):  # which a power cut leaves
        path.write_bytes(HEAD[:kept] + zeros * b"\0")
        with pytest.raises(ConfigError, match=r"results.rows: no row was saved in it: the run ended before"):
            read(path)
        assert has_no_row(path)


@pytest.mark.parametrize(
    "text", [HEAD, HEAD + b"x", b"mine", b"\n", b"{}", b'{"format": "evcosim rows 2"', b"\0\n"]
)
def test_other_files_are_none_that_a_run_left_without_a_row(tmp_path: Path, text: bytes) -> None:
    path = tmp_path / "results.rows"
    path.write_bytes(text)
    assert not has_no_row(path)
    link = tmp_path / "link.rows"
    (tmp_path / "empty").touch()
    link.symlink_to("empty")
    assert not has_no_row(link) and not has_no_row(tmp_path) and not has_no_row(tmp_path / "none")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (b"[1]\n", "does not begin as a file of rows"),
        (b"{}\n", "does not begin as a file of rows"),
        (b"\xff\n", "its first line does not describe rows"),
        (HEAD.replace(b'"little"', b'"middle"').replace(b'"big"', b'"middle"'), "the other byte order"),
        (HEAD.replace(b'"clock": {', b'"clock": {"x": 1,'), "its first line does not describe rows"),
        (HEAD.replace(b'"clock"', b'"clack"'), "its first line does not describe rows"),
        (HEAD.replace(b'"unit"', b'"color"'), "'variables' does not describe the variables"),
    ],
)
def test_what_is_no_file_of_rows_is_refused(tmp_path: Path, line: bytes, message: str) -> None:
    path = tmp_path / "results.rows"
    path.write_bytes(line)
    with pytest.raises(ConfigError, match=f"results.rows: {message}|results.rows: .*{message}"):
        read(path)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none.rows: cannot be read: No such file"):
        read(tmp_path / "none.rows")


def test_a_run_that_records_nothing_has_no_rows(tmp_path: Path) -> None:
    (tmp_path / "results.rows").write_bytes(head(Clock.counted(0.0, 0.1, 4), [], {}))
    assert read(tmp_path / "results.rows").data.shape == (0, 0)


def test_the_folders_of_runs_below_a_folder_are_named(tmp_path: Path) -> None:
    for name in ("results/a", "b"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "results.csv").touch()
        assert file_of_run(tmp_path / name, "results.csv") == tmp_path / name / "results.csv"
    with pytest.raises(ConfigError) as refused:
        file_of_run(tmp_path, "results.csv")
    assert str(refused.value).endswith(f"; it has {tmp_path / 'b'}, {tmp_path / 'results' / 'a'}")
    (tmp_path / "results.rows").touch()  # of a run that lives
    assert file_of_run(tmp_path, "results.csv").name == "results.rows"
