"""A file has its name when it is whole, and never before."""

from __future__ import annotations

import errno
import math
import os
import sys
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.writing import (
    create,
    finite,
    markdown_table,
    remove_drafts,
    replacing,
    try_folder,
    write_text,
)

needs_links = pytest.mark.skipif(sys.platform == "win32", reason="links and modes as POSIX has them")


def test_the_file_takes_its_place_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "made" / "here" / "a.csv"
    with replacing(path) as file:
        file.write(b"new")
        assert not path.exists()
        assert os.listdir(path.parent) == [os.path.basename(file.name)]
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
        assert (
            str(raised.value) == f"{path}: cannot be written: No space left on device: make room on the disk"
        )


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


@needs_links
def test_a_link_is_replaced_and_not_followed(tmp_path: Path) -> None:
    own, path, dangling = tmp_path / "own.txt", tmp_path / "a.csv", tmp_path / "b.csv"
    own.write_text("mine")
    path.symlink_to(own)
    dangling.symlink_to(tmp_path / "new.txt")
    for each in (path, dangling):
        write_text(each, "results")
        assert not each.is_symlink()
        assert each.read_text() == "results"
    assert own.read_text() == "mine"
    assert not (tmp_path / "new.txt").exists()


@needs_links
def test_a_new_file_is_made_exclusively(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("mine")
    (tmp_path / "link").symlink_to(tmp_path / "there")
    (tmp_path / "dangling").symlink_to(tmp_path / "new")
    for name in ("there", "link", "dangling"):
        with pytest.raises(FileExistsError):
            create(tmp_path / name)
    assert (tmp_path / "there").read_text() == "mine"
    assert not (tmp_path / "new").exists()


@needs_links
def test_a_device_a_pipe_or_a_folder_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/null")
    (tmp_path / "folder").mkdir()
    for name, why in (("pipe", "a device or a pipe"), ("link", "a device or a pipe"), ("folder", "Is a dir")):
        with pytest.raises(ConfigError, match=f"{name}: cannot be written: .*{why}"):
            write_text(tmp_path / name, "results")
    assert (tmp_path / "link").is_symlink()


@needs_links
def test_a_file_has_the_mode_of_a_new_file(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "")
    (tmp_path / "b.txt").touch()
    assert (tmp_path / "a.txt").stat().st_mode == (tmp_path / "b.txt").stat().st_mode


def test_drafts_of_a_killed_process_are_removed(tmp_path: Path) -> None:
    (tmp_path / "notes.part").write_text("mine")
    with pytest.raises(ConfigError), replacing(tmp_path / "a.csv") as file:
        os.link(file.name, tmp_path / ".evcosim-123456.part")
        raise OSError(errno.EIO, "no matter")
    assert len(os.listdir(tmp_path)) == 2
    remove_drafts(tmp_path)
    assert os.listdir(tmp_path) == ["notes.part"]


def test_trying_a_folder_leaves_nothing(tmp_path: Path) -> None:
    try_folder(tmp_path / "a" / "b")
    assert os.listdir(tmp_path / "a" / "b") == []
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        try_folder(tmp_path / "file")


def test_a_cell_stays_a_cell() -> None:
    assert markdown_table(("a|b", "c"), [("1", "2\n3")]) == [r"| a\|b | c |", "|---|---|", "| 1 | 2 3 |"]


def test_a_text_keeps_its_line_ends(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "ä\r\nb\n")
    assert (tmp_path / "a.txt").read_bytes() == "ä\r\nb\n".encode()


def test_data_as_json_has_it() -> None:
    data = {
        1: (np.float64(2.5), math.nan, -math.inf),
        "path": Path("a"),
        "flag": np.bool_(True),
        "none": None,
    }
    assert finite(data) == {"1": [2.5, None, None], "path": "a", "flag": True, "none": None}
    assert type(finite(np.int64(3))) is int and finite(np.float32("nan")) is None
