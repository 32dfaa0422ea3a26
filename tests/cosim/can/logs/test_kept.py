"""Recordings that are made once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs import kept
from evcosim.cosim.can.logs.recording import Recording, recorded
from evcosim.cosim.can.logs.variants import Variants
from evcosim.cosim.errors import ConfigError

MESSAGE = Message("f", "M", 0x123, False, 2, signals={name: Signal(name, 0, 8) for name in "AB"})


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Forget what is kept; return a list of the logs that are read from now on."""
    found: list[Path] = []

    def counted(path: Path, variants: Variants) -> Recording:
        found.append(path)
        return recorded(path, variants)

    monkeypatch.setattr(kept, "recorded", counted)
    monkeypatch.setattr(kept, "_latest", type(kept._latest)())
    monkeypatch.setattr(kept, "_folder", None)
    return found


def wanted(*names: str) -> Variants:
    return Variants([(MESSAGE, names or ("A",))])


def log(folder: Path, name: str = "a.log", text: str = "(1.0) can0 123#AABB\n(1.5) can0 123#CCDD\n") -> Path:
    (folder / name).write_text(text)
    return folder / name


def rows(recording: Recording) -> list[list[int]]:
    return [row for part in recording.rows() for row in part.tolist()]


def test_a_log_is_read_once_until_it_changes_or_other_signals_are_wanted(
    tmp_path: Path, read: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = log(tmp_path)
    first = kept.recorded_once(path, wanted())
    monkeypatch.chdir(tmp_path)
    again = kept.recorded_once(Path("a.log"), wanted())
    assert len(read) == 1 and rows(first) == rows(again) and again.path == Path("a.log")
    kept.recorded_once(path, wanted("A", "B"))
    assert len(read) == 2
    log(tmp_path, text="(1.0) can0 123#0000\n")
    assert len(rows(kept.recorded_once(path, wanted()))) == 1
    about = path.stat()
    os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns + 1))
    kept.recorded_once(path, wanted())
    assert len(read) == 4 and len(kept._latest) == 2


def test_processes_that_share_a_folder_read_nothing_anew(
    tmp_path: Path, read: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, folder = log(tmp_path), tmp_path / "shared"
    folder.mkdir()
    mine = kept.recorded_once(path, wanted())
    kept.hand_over(folder)
    monkeypatch.setattr(kept, "_latest", type(kept._latest)())
    kept.share(folder)
    theirs = kept.recorded_once(path, wanted())
    assert len(read) == 1 and rows(theirs) == rows(mine)
    assert (theirs.spans, theirs.seen, theirs.variants) == (mine.spans, mine.seen, mine.variants)
    other = log(tmp_path, "b.log")
    kept.recorded_once(other, wanted())
    monkeypatch.setattr(kept, "_latest", type(kept._latest)())
    kept.recorded_once(other, wanted())
    assert read == [path, other]


def test_a_folder_without_room_costs_a_reading(tmp_path: Path, read: list[Path]) -> None:
    path = log(tmp_path)
    kept.recorded_once(path, wanted())
    kept.hand_over(tmp_path / "nothing")
    kept.share(tmp_path / "nothing")
    assert len(rows(kept.recorded_once(path, wanted("B")))) == 2 and len(read) == 2


def test_what_is_no_file_is_said_as_ever(tmp_path: Path, read: list[Path]) -> None:
    with pytest.raises(ConfigError, match=r"a\.log: cannot be read: "):
        kept.recorded_once(tmp_path / "a.log", wanted())
