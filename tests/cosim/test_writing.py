"""A file has its name when it is whole, and never before."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.writing import in_place_of, markdown_table, replacing, write_text


def test_the_file_takes_its_place_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "made" / "here" / "a.csv"
    with in_place_of(path) as partial:
        partial.write_text("new")
        assert not path.exists()
        assert (partial.parent, partial.suffix) == (path.parent, ".csv")
    assert path.read_text() == "new"
    assert os.listdir(path.parent) == ["a.csv"]


def test_an_older_file_stays_until_then(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")
    with replacing(path) as file:
        file.write(b"new")
        file.flush()
        assert path.read_text() == "old"
    assert path.read_text() == "new"


@pytest.mark.parametrize(
    "failure", [KeyboardInterrupt(), ValueError("x"), OSError(errno.ENOSPC, "No space left on device")]
)
def test_a_failure_leaves_no_trace(failure: BaseException, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")
    expected = ConfigError if isinstance(failure, OSError) else type(failure)
    with pytest.raises(expected) as raised, replacing(path) as file:
        file.write(b"half")
        raise failure
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.csv"]
    if expected is ConfigError:
        assert str(raised.value) == f"{path}: cannot be written: No space left on device"


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with (
        pytest.raises(ConfigError, match=r"file/a.csv: cannot be written: .*file is a file, not a folder$"),
        replacing(tmp_path / "file" / "a.csv"),
    ):
        pytest.fail("there is nothing to write into")


@pytest.mark.parametrize("path", ["", ".", "/"])
def test_a_folder_without_a_name_is_refused(path: str) -> None:
    shown = path or "."
    with (
        pytest.raises(ConfigError, match=f"^{shown}: cannot be written: it is a folder$"),
        replacing(Path(path)),
    ):
        pytest.fail("there is nothing to write into")


def test_a_file_that_was_not_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be written: No such file"), in_place_of(tmp_path / "a"):
        pass


def test_a_cell_stays_a_cell() -> None:
    assert markdown_table(("a|b", "c"), [("1", "2\n3")]) == [r"| a\|b | c |", "|---|---|", "| 1 | 2 3 |"]


def test_a_text_keeps_its_line_ends(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "ä\r\nb\n")
    assert (tmp_path / "a.txt").read_bytes() == "ä\r\nb\n".encode()
