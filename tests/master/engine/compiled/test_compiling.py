"""What numba keeps in its own cache stands in the user's, and heals there."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.engine.compiled import compiling
from evcosim.master.engine.compiled.cache import PIECES, Piece
from evcosim.master.engine.progress import reporting
from evcosim.master.machine.flat import NotFlatError


def small(address: int) -> int:
    """Stand for the kernel, of which the compilation takes seconds."""
    return address + 1


PIECE = Piece("small", "a function", ("evcosim.master.machine.slots",))


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of the test's own, on a machine of which no code is flat."""

    def refuse(function: object, signature: str) -> bytes:
        raise NotFlatError

    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setitem(compiling._FUNCTIONS, PIECE, (small, "int64(int64)"))
    monkeypatch.setattr(compiling, "flat", refuse)
    return tmp_path / "cache"


def hits() -> int:
    """Return 1 where the machine code came from the cache, 0 where it was compiled; it works in any case."""
    made, reason = compiling.made(PIECE)
    assert (made.ctypes(41), reason) == (42, "")
    return int(made.cache_hits)


def test_each_piece_has_a_function() -> None:
    assert set(PIECES) <= set(compiling._FUNCTIONS)


def test_machine_code_comes_from_the_cache_unless_it_was_changed(
    own_cache: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert [hits(), hits()] == [0, 1]
    (entry,) = own_cache.glob("small-*.zip")
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
    assert [hits(), hits()] == [0, 1]
    (entry,) = own_cache.glob("small-*.zip")
    said: list[str] = []
    with reporting(said.append):
        assert hits() == 1
        assert said == []
        assert compiling.keep(entry.name, compiling._packed(tmp_path / "empty")) == ""
        assert [hits(), hits()] == [0, 1]
    assert said == ["compiling a function, once: some seconds"]


def test_without_a_temporary_folder_it_is_compiled_in_memory(
    own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nowhere"))
    made, reason = compiling.made(PIECE)
    assert made.ctypes(41) == 42
    assert reason == "No such file or directory"
    assert not own_cache.exists()
