"""A shared library: functions are looked up by name when they are needed, and not before."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.master.fmi.library import Library
from support.c_fmu import SOURCES, compiled


@pytest.fixture(params=[False, True], ids=["gives up Python's lock", "keeps it"])
def library(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Library]:
    path = tmp_path / "mixed.so"
    path.write_bytes(compiled(SOURCES / "mixed.c", ("-DFMI=1", "-DBEHAVIOR=0", "-DMODEL=mixed")))
    loaded = Library(path, "mixed_", keeps_lock=request.param)
    yield loaded
    loaded.close()


def test_a_function_is_found_behind_the_prefix(library: Library) -> None:
    assert library.has("fmiDoStep")
    assert not library.has("mixed_fmiDoStep")
    component = library.function("fmiInstantiateSlave", ctypes.c_void_p)(
        b"a", b"mixed", b"", b"", ctypes.c_double(0.0), *[ctypes.c_char(0)] * 2, None, ctypes.c_char(0)
    )
    assert component
    library.function("fmiFreeSlaveInstance", None)(ctypes.c_void_p(component))


def test_what_is_missing_is_missed_when_it_is_looked_up(library: Library) -> None:
    assert not library.has("fmiResetSlave")
    with pytest.raises(AttributeError):
        library.function("fmiResetSlave")


def test_the_working_folder_stays_what_it_is(library: Library, tmp_path: Path) -> None:
    before = os.getcwd()
    Library(library.path).close()
    assert os.getcwd() == before
    (tmp_path / "no.so").write_bytes(b"no library")
    with pytest.raises(OSError):
        Library(tmp_path / "no.so")
    assert os.getcwd() == before
