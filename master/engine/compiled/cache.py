"""The machine code of the compiled engine, from the user's cache or compiled now.

An entry of the cache is code as plain bytes (`machine.flat`), which is mapped and called in a millisecond:
numba takes half a second to be imported, and is only where there is no entry. Its name has a digest of all
sources of the code, of numba and LLVM, and of this processor; the cache gives nothing back that somebody else
could have written or that was changed (`evcosim.fmus.cache`).
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import importlib.metadata
import importlib.util
import sys
from pathlib import Path
from typing import Protocol

from ...builtin import cache_folder, keep, kept
from ...machine.hands import POSSIBLE
from ...machine.loaded import Loaded

_LIBRARIES = ("numba", "llvmlite")
_ENGINE, _FRAMES = "evcosim.master.engine.compiled", "evcosim.cosim.can.wire"
_MACHINE = (
    "evcosim.master.machine.calling", "evcosim.master.machine.handing", "evcosim.master.machine.access",
    "evcosim.master.machine.tables", "evcosim.master.machine.slots", "evcosim.master.fmi.types",
)  # fmt: skip # names
_COMPILING = (f"{_ENGINE}.compiling", "evcosim.master.machine.flat")


@dataclasses.dataclass(frozen=True)
class Piece:
    """A function of machine code.

    `what` are the words for it in a report, `sources` the names of the modules that it is made of.
    """

    name: str
    what: str
    sources: tuple[str, ...]


_OF_KERNEL = (f"{_ENGINE}.kernel", f"{_FRAMES}.tables", *_MACHINE)
_OF_FRAMES = (
    f"{_ENGINE}.frames", f"{_ENGINE}.wire_types", f"{_ENGINE}.addresses", "evcosim.master.machine.access",
    "evcosim.cosim.can.timing.draws", "evcosim.cosim.can.timing.lengths",
    "evcosim.cosim.can.protection.profiles", "evcosim.cosim.can.protection.counters",
    f"{_FRAMES}.arbitration", f"{_FRAMES}.babble", f"{_FRAMES}.buffers", f"{_FRAMES}.faults",
    f"{_FRAMES}.log", f"{_FRAMES}.medium",
    f"{_FRAMES}.off", f"{_FRAMES}.payload", f"{_FRAMES}.protect", f"{_FRAMES}.requests", f"{_FRAMES}.tables",
    f"{_FRAMES}.uses", f"{_FRAMES}.values",
)  # fmt: skip # names
KERNEL = Piece("engine", "the engine", _OF_KERNEL)
TIMED = Piece("engine-timed", "the engine", _OF_KERNEL)
OPERATION = Piece("operation", "the engine", _OF_KERNEL)
TURNS = Piece("turns", "the turns of isolated units", ("evcosim.master.machine.serving", *_MACHINE))
WIRE = Piece("wire", "the frames of buses", _OF_FRAMES)
PIECES = (KERNEL, TIMED, OPERATION, TURNS, WIRE)


class Made(Protocol):
    """Machine code in this process, at an address as long as the object is."""

    @property
    def address(self) -> int:
        """The address of its function."""


_made: dict[str, Made] = {}


def compiled(timed: bool = False) -> tuple[int, str]:
    """Return the address of the kernel (`timed`: of the one that measures a profile) and a notice.

    The notice is "", unless the kernel could not be kept. Compiling takes some seconds.
    """
    return _address(TIMED if timed else KERNEL)


def wire() -> tuple[int, str]:
    """Return the address of the frame path's function and a notice, as `compiled` does: in 10 s."""
    return _address(WIRE)


def one_operation() -> tuple[int, str]:
    """Return the address of the function that does one operation and a notice, as `compiled` does."""
    return _address(OPERATION)


def operation() -> int:
    """Return the address of the function that does one operation; 0: the cache has none.

    It is made with the kernel.
    """
    return _made[OPERATION.name].address if _found(OPERATION) else 0


def at_hand(timed: bool, frames: bool) -> bool:
    """Return True if a run finds its machine code without numba: `frames`: it has some on a bus."""
    return all(_found(piece) for piece in [TIMED if timed else KERNEL, *([WIRE] if frames else [])])


def _address(piece: Piece) -> tuple[int, str]:
    notice = ""
    if not _found(piece):
        from .compiling import made

        _made[piece.name], reason = made(piece)
        if piece is KERNEL:  # no run waits for it alone
            _address(OPERATION)
        if reason:
            notice = f"cannot use the cache folder {cache_folder()} ({reason}): the engine is compiled anew"
    return _made[piece.name].address, notice


def _found(piece: Piece) -> bool:
    """Return True if the code of a piece is in this process, and load it from the cache if it has it."""
    if piece.name not in _made and POSSIBLE and (code := _kept(piece)) is not None:
        try:
            _made[piece.name] = Loaded(code)
        except OSError:  # the system lets no such code run
            return False
    return piece.name in _made


def served() -> bytes | None:
    """Return the machine code of the turns of an isolated unit, from the cache or compiled now.

    None: there is no numba, or it needs more than its own bytes on this machine, so that Python does the
    turns there.
    """
    if (code := _kept(TURNS)) is not None:
        return code
    try:
        from .compiling import flat_code
    except (ImportError, OSError):  # OSError: no memory is left for its libraries
        return None
    if (code := flat_code(TURNS)) is not None:
        keep(entry(TURNS), code)  # a cache that keeps nothing is told by the engine's own
    return code


def _kept(piece: Piece) -> bytes | None:
    try:
        return kept(entry(piece))
    except (ImportError, OSError):  # no numba, of which it would be
        return None


def entry(piece: Piece, kind: str = "bin") -> str:
    """Return the name of a piece's entry in the cache. Raises ImportError without numba."""
    return f"{piece.name}-{digest(piece.sources)}.{kind}"


def digest(sources: tuple[str, ...]) -> str:
    """Return a digest of these modules, of the libraries that compile them and of this processor."""
    parts = [_source(name) for name in (*sources, *_COMPILING)]
    parts += [_version(name) for name in _LIBRARIES]
    parts += [sys.version.encode(), _processor()]
    return hashlib.sha256(b"\n".join(parts)).hexdigest()[:16]


@functools.cache  # reading the metadata of a distribution takes a millisecond
def _version(distribution: str) -> bytes:
    return importlib.metadata.version(distribution).encode()


@functools.cache
def _source(name: str) -> bytes:
    """Return the text of a module, without importing it: it may import numba."""
    found = importlib.util.find_spec(name)
    assert found is not None and found.origin is not None  # it is a part of this package
    return Path(found.origin).read_bytes()


_OF_PROCESSOR = ("vendor_id", "cpu family", "model", "model name", "stepping", "flags")


@functools.cache
def _processor() -> bytes:
    """Return what this processor can do: as the system says it, or as LLVM does where that says nothing."""
    try:
        with open("/proc/cpuinfo", "rb") as file:
            first = file.read(1 << 14).partition(b"\n\n")[0].decode()
    except OSError:
        first = ""
    said = [line for line in first.splitlines() if line.partition("\t")[0].strip() in _OF_PROCESSOR]
    if any(line.startswith("flags") for line in said):
        return "\n".join(said).encode()
    import llvmlite.binding as llvm

    return f"{llvm.get_host_cpu_name()}\n{llvm.get_host_cpu_features().flatten()}".encode()
