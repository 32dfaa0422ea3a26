"""The cache of machine code has another entry as soon as one of the sources is another, and heals."""

from __future__ import annotations

import ast
import ctypes
import importlib
import importlib.util
import io
import sys
from pathlib import Path

import pytest

from evcosim.master.engine.compiled import cache, compiling
from evcosim.master.engine.compiled.cache import PIECES, TURNS, Piece
from evcosim.master.engine.progress import reporting
from evcosim.master.machine import flat
from evcosim.master.machine.hands import POSSIBLE

alone = pytest.mark.skipif(not POSSIBLE, reason="an object file of another system has another format")
CODE = bytes.fromhex("488d4701 c3")  # lea rax, [rdi + 1]; ret
PIECE = Piece("small", "a function", ("evcosim.master.machine.slots",))


def imported(name: str) -> set[str]:
    """The names of the modules of this project that a module imports as soon as it is loaded itself."""
    module = importlib.import_module(name)
    found = set()
    for node in ast.parse(Path(module.__file__ or "").read_text()).body:
        if isinstance(node, ast.ImportFrom) and node.level:
            origin = importlib.util.resolve_name("." * node.level + (node.module or ""), module.__package__)
            inner = {f"{origin}.{alias.name}" for alias in node.names}
            found |= {name for name in inner if name in sys.modules} or {origin}
    return found


@pytest.mark.parametrize("piece", [piece for piece in PIECES if piece is not cache.WIRE])
def test_the_sources_are_the_function_and_all_that_it_imports(piece: Piece) -> None:
    known, new = set(), {piece.sources[0]}
    while new:
        known |= new
        new = {name for each in new for name in imported(each)} - known
    assert set(piece.sources) == known


@pytest.mark.parametrize("piece", PIECES)
def test_another_source_library_or_processor_gives_another_entry(
    piece: Piece, monkeypatch: pytest.MonkeyPatch
) -> None:
    entries = [cache.entry(piece)]

    def another() -> None:
        assert cache.entry(piece) not in entries
        entries.append(cache.entry(piece))

    source, version = cache._source, cache._version
    for name in (*piece.sources, flat.__name__, compiling.__name__):
        monkeypatch.setattr(cache, "_source", lambda each, name=name: source(each) + b"\n" * (each == name))
        another()
    for name in ("numba", "llvmlite"):
        monkeypatch.setattr(cache, "_version", lambda each, name=name: version(each) + b"0" * (each == name))
        another()
    monkeypatch.setattr(sys, "version", "another")
    another()
    monkeypatch.setattr(cache, "_processor", lambda: b"another")
    another()


def test_pieces_have_entries_of_their_own() -> None:
    assert len({cache.entry(piece) for piece in PIECES}) == len(PIECES)


CPU = "processor\t: {n}\nmodel\t\t: 49\ncpu MHz\t\t: {mhz}\nflags\t\t: fpu {flag}\n\n"


def processor(monkeypatch: pytest.MonkeyPatch, text: str | None) -> bytes:
    """What the cache says of a processor of which the system says a text."""

    def opened(path: str, mode: str) -> io.BytesIO:
        assert (path, mode) == ("/proc/cpuinfo", "rb")
        if text is None:
            raise FileNotFoundError
        return io.BytesIO(text.encode())

    monkeypatch.setattr(cache, "open", opened, raising=False)
    return cache._processor.__wrapped__()


def test_a_processor_is_what_it_can_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither its clock nor the number of cores counts; without the system's words LLVM's do."""
    core = CPU.format(n=0, mhz=2000, flag="avx2")
    said = processor(monkeypatch, core)
    assert b"avx2" in said
    assert processor(monkeypatch, CPU.format(n=0, mhz=3000, flag="avx2") + core) == said
    assert processor(monkeypatch, CPU.format(n=0, mhz=2000, flag="avx512f")) != said
    assert processor(monkeypatch, None) == processor(monkeypatch, "nothing") != said


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache for the code of PIECE, which is CODE and not compiled."""
    monkeypatch.setattr(cache, "_made", {})
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setitem(compiling._FUNCTIONS, PIECE, (lambda x: x + 1, "int64(int64)"))
    monkeypatch.setattr(compiling, "flat", lambda function, signature: CODE)
    return tmp_path / "cache"


def compiled(monkeypatch: pytest.MonkeyPatch) -> bool:
    """Return True where the code of PIECE had to be compiled, as by a new process; it works in any case."""
    monkeypatch.setattr(cache, "_made", {})
    said: list[str] = []
    with reporting(said.append):
        address, notice = cache._address(PIECE)
    assert notice == ""
    assert ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(address)(41) == 42
    assert said in ([], ["compiling a function, once: some seconds"])
    return bool(said)


@alone
def test_machine_code_comes_from_the_cache_unless_it_was_changed(
    own_cache: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert [compiled(monkeypatch), compiled(monkeypatch)] == [True, False]
    (entry,) = own_cache.iterdir()
    whole = entry.read_bytes()
    for place in range(0, len(whole), 7):
        entry.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert compiled(monkeypatch)
        assert capsys.readouterr().err.count(f"{entry}: is damaged") == 1
        assert not compiled(monkeypatch)
    for size in (0, 1, len(whole) - 1):
        entry.write_bytes(whole[:size])
        assert [compiled(monkeypatch), compiled(monkeypatch)] == [True, False]


@alone
def test_code_that_others_could_have_written_is_not_run(
    own_cache: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled(monkeypatch)
    (entry,) = own_cache.iterdir()
    entry.chmod(0o666)
    assert compiled(monkeypatch)
    assert "others can write it" in capsys.readouterr().err


@alone
def test_where_no_such_code_may_run_numba_loads_its_own(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(code: bytes) -> object:
        raise PermissionError(1, "Operation not permitted")

    compiled(monkeypatch)  # bytes are kept, as by another system on this machine
    for module in (cache, compiling):
        monkeypatch.setattr(module, "Loaded", refuse)
    assert [compiled(monkeypatch), compiled(monkeypatch)] == [True, False]
    assert sorted(entry.suffix for entry in own_cache.iterdir()) == [".bin", ".zip"]


@alone
def test_the_turns_come_from_the_cache_and_heal(own_cache: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cache.served() == CODE
    (entry,) = own_cache.glob("turns-*.bin")
    assert cache.served() == CODE
    entry.write_bytes(entry.read_bytes()[:-1])
    assert cache.served() == CODE
    assert "is damaged" in capsys.readouterr().err


def test_turns_that_are_not_flat_stay_with_python(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(function: object, signature: str) -> bytes:
        raise flat.NotFlatError

    monkeypatch.setattr(compiling, "flat", refuse)
    assert cache.served() is None
    monkeypatch.setitem(sys.modules, compiling.__name__, None)  # nor where there is no numba
    assert cache.served() is None
    assert not cache._kept(TURNS)
