"""An FMU's archive is opened by the rules of all archives, and is an FMU in every message."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from evcosim.master.fmi.archive import FmuError, entries_of, extract, read_entry


def test_messages_speak_of_an_fmu(tmp_path: Path) -> None:
    path = tmp_path / "a.fmu"
    path.write_bytes(b"no archive")
    for refuse in (entries_of, extract):
        with pytest.raises(FmuError, match=r"a\.fmu: is not an FMU: it is no zip archive"):
            refuse(path)
    with pytest.raises(FmuError, match="is a folder, not an FMU; an FMU is one file"):
        entries_of(tmp_path)


def test_a_missing_entry_is_an_error_of_the_fmu(tmp_path: Path) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", b"<a/>")
    assert read_entry(path, "modelDescription.xml") == b"<a/>"
    with pytest.raises(FmuError, match="entry 'b' cannot be read"):
        read_entry(path, "b")
