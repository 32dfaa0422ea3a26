"""The cache of the kernel has another entry as soon as one of the sources is another, and heals."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from evcosim.master.engine.compiled import cache, frames, kernel
from evcosim.master.engine.progress import reporting
from evcosim.master.machine import flat, serving
from evcosim.master.machine.hands import POSSIBLE


def imported(module: ModuleType) -> set[str]:
    """The names of the modules of this project that a module imports as soon as it is loaded itself."""
    found = set()
    for node in ast.parse(Path(module.__file__ or "").read_text()).body:
        if isinstance(node, ast.ImportFrom) and node.level:
            origin = importlib.util.resolve_name("." * node.level + (node.module or ""), module.__package__)
            inner = {f"{origin}.{alias.name}" for alias in node.names}
            found |= {name for name in inner if name in sys.modules} or {origin}
    return found


def test_the_sources_are_the_kernel_and_all_that_it_imports() -> None:
    known, new = set(), {kernel.__name__}
    while new:
        known |= new
        new = {name for each in new for name in imported(importlib.import_module(each))} - known
    assert {module.__name__ for module in cache.SOURCES} == known


@pytest.mark.parametrize("place", range(len(cache.SOURCES)))
def test_another_source_gives_another_entry(
    place: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = cache._name(False)
    changed = tmp_path / "changed.py"
    changed.write_bytes(Path(cache.SOURCES[place].__file__ or "").read_bytes() + b"\n")
    monkeypatch.setattr(cache.SOURCES[place], "__file__", str(changed))
    assert cache._name(False) != before


def test_the_sources_of_the_turns_are_all_that_they_import() -> None:
    known, new = set(), {serving.__name__}
    while new:
        known |= new
        new = {name for each in new for name in imported(importlib.import_module(each))} - known
    assert {module.__name__ for module in cache._SERVING} == known | {flat.__name__}


@pytest.mark.skipif(not POSSIBLE, reason="an object file of another system has another format")
def test_the_turns_come_from_the_cache_and_heal(
    own_cache: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    code = cache.served()
    (entry,) = own_cache.glob("turns-*.bin")
    monkeypatch.setattr(flat, "flat", lambda function: code)  # compiling once is enough
    assert code is not None and cache.served() == code
    entry.write_bytes(entry.read_bytes()[:-1])
    assert cache.served() == code
    assert "is damaged" in capsys.readouterr().err


def test_turns_that_are_not_flat_stay_with_python(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(function: object) -> bytes:
        raise flat.NotFlatError

    monkeypatch.setattr(flat, "flat", refuse)
    assert cache.served() is None


def test_another_processor_and_the_kernel_with_a_profile_have_entries_of_their_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = cache._name(False)
    assert cache._name(True) != before
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_name", lambda: "another")
    assert cache._name(False) != before


def small(address: int) -> int:
    """Stand for the kernel, of which the compilation takes seconds."""
    return address + 1


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def hits(name: str = "small.zip") -> int:
    """Return 1 where the machine code came from the cache, 0 where it was compiled; it works in any case."""
    made, reason = cache._through_the_cache(small, name)
    assert (made.ctypes(41), reason) == (42, "")
    return int(made.cache_hits)


def test_machine_code_comes_from_the_cache_unless_it_was_changed(
    own_cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert [hits(), hits()] == [0, 1]
    entry = own_cache / "small.zip"
    whole = entry.read_bytes()
    for place in (0, 70, len(whole) // 2, len(whole) - 1):
        changed = bytearray(whole)
        changed[place] ^= 1
        entry.write_bytes(changed)
        assert hits() == 0
        assert capsys.readouterr().err.count(f"{entry}: is damaged") == 1
        assert hits() == 1
    for size in (0, 1, len(whole) - 1):
        entry.write_bytes(whole[:size])
        assert [hits(), hits()] == [0, 1]


def test_an_entry_in_which_numba_finds_nothing_is_made_anew(own_cache: Path, tmp_path: Path) -> None:
    """As after an installation that gave the sources another date, which some versions of numba compare."""
    (tmp_path / "empty").mkdir()
    said: list[str] = []
    with reporting(said.append):
        assert [hits(), hits()] == [0, 1]
        assert said == ["compiling a function, once: some seconds"]
        assert cache.keep("small.zip", cache._packed(tmp_path / "empty")) == ""
        assert [hits(), hits()] == [0, 1]
    assert said == ["compiling a function, once: some seconds"] * 2


def test_the_frames_of_buses_from_the_cache_compile_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    cache.wire()  # it is in the cache now
    monkeypatch.setattr(cache, "_made", {})
    monkeypatch.setattr(frames, "_compiled", None)  # would be called
    said: list[str] = []
    with reporting(said.append):
        assert cache.wire()[0] != 0
    assert said == []


def test_without_a_temporary_folder_it_is_compiled_in_memory(
    own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nowhere"))
    made, reason = cache._through_the_cache(small, "small.zip")
    assert made.ctypes(41) == 42
    assert reason == "No such file or directory"
    assert not own_cache.exists()
