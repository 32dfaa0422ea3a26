"""What is listed is taken away, and nothing else."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.cosim import leftovers
from support.forked import forked
from support.needs import need_linux


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The system's folder for temporary files, with lists of this test's own."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    for name in ("_folders", "_files", "_children"):
        monkeypatch.setattr(leftovers, name, type(getattr(leftovers, name))())
    yield tmp_path


def test_without_a_file_that_can_be_opened_that_is_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    need_linux()

    def refused(most: int) -> str:
        tempfile.tempdir = None  # so that it is looked for
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
        with pytest.raises(OSError) as caught:
            leftovers.temporary_folder()
        return str(caught.value.strerror)

    assert forked(lambda: refused(0)).value == "Too many open files"


def test_a_folder_lasts_as_long_as_its_block(scratch: Path) -> None:
    with leftovers.temporary() as folder:
        (folder / "a").mkdir()
        assert folder.parent == scratch
        if sys.platform != "win32":
            assert folder.stat().st_mode & 0o777 == 0o700
    assert list(scratch.iterdir()) == []
    leftovers.take_away()


def test_a_folder_that_cannot_be_made_is_not_listed(scratch: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(scratch / "none"))
    with pytest.raises(FileNotFoundError):
        leftovers.temporary_folder()
    assert not leftovers._folders


def test_all_that_is_listed_is_taken_away(scratch: Path) -> None:
    folder = leftovers.temporary_folder()
    (folder / "deep").mkdir()
    (folder / "deep" / "file").touch()
    half, mine = scratch / "half", scratch / "mine"
    mine.touch()
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    leftovers.add_child(child.pid, child.kill)
    with leftovers.partial(half):
        half.touch()
        leftovers.take_away()
        assert list(scratch.iterdir()) == [mine]
    assert child.wait(10) != 0


def test_what_was_ended_is_left_alone(scratch: Path) -> None:
    killed = []
    leftovers.add_child(1, lambda: killed.append(1))
    leftovers.forget_child(1)
    folder = leftovers.temporary_folder()
    leftovers.remove_folder(folder)
    folder.mkdir()  # somebody else's now
    with leftovers.partial(scratch / "a"):
        pass
    (scratch / "a").touch()
    leftovers.take_away()
    assert killed == []
    assert sorted(path.name for path in scratch.iterdir()) == sorted(["a", folder.name])
