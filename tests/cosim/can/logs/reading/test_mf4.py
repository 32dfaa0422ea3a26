"""Logs of ASAM MDF 4."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from evcosim.cosim.can.logs.reading import mf4
from evcosim.cosim.can.logs.reading.files import logged_frames
from support.log_readers import written
from support.logged import check_reads_what_was_written, check_survives, refused


def test_what_was_written_is_read(tmp_path: Path) -> None:
    check_reads_what_was_written(tmp_path, ".mf4")


def test_without_the_library_the_error_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    assert "pip install 'evcosim[mf4]'" in refused(tmp_path / "a.mf4", b"MDF     4.10")


def test_damaged_logs_are_read_or_refused(tmp_path: Path) -> None:
    good = written(tmp_path, ".mf4").read_bytes()
    assert "asammdf cannot read it" in refused(tmp_path / "a.mf4", good[:500])
    check_survives(tmp_path, ".mf4", good, rounds=3)  # a process for each


def test_a_process_that_crashes_says_that_the_log_is_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\nkill -SEGV $$\n")
    program.chmod(0o700)
    monkeypatch.setattr(sys, "executable", str(program))
    said = refused(tmp_path / "a.mf4", b"MDF     4.10")
    assert said == "asammdf ended with exit code -11 on it: the log is damaged"


def test_a_reader_that_takes_some_frames_ends_the_process(tmp_path: Path) -> None:
    with logged_frames(written(tmp_path, ".mf4")) as frames:
        assert next(frames).frame_id == 0x123
        frames.close()  # type: ignore[attr-defined] # of a generator


@pytest.mark.parametrize("begin", ["", "head -c 1000 /dev/zero; "])
def test_a_process_that_hangs_is_ended_and_said_to_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, begin: str
) -> None:
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\n{begin}exec sleep 600\n")
    program.chmod(0o700)
    monkeypatch.setattr(sys, "executable", str(program))
    monkeypatch.setattr(mf4, "LONGEST", 0.3)
    said = refused(tmp_path / "a.mf4", b"MDF     4.10")
    assert said.startswith("asammdf gave no frame for 0.3 s and was ended: the log is damaged")
