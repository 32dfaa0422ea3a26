"""The pieces of machine code, compiled by numba.

On x86-64 under Linux a piece is bytes that any process maps without numba. Elsewhere, and where the system
lets no such bytes run, numba loads what it keeps in its own cache folder: that stands as one entry in the
user's cache.
"""

# numba has no types
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import contextlib
import hashlib
import io
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba

from ....cosim import leftovers
from ...builtin import keep, kept
from ...machine import serving
from ...machine.flat import NotFlatError, flat
from ...machine.hands import POSSIBLE
from ...machine.loaded import Loaded
from ..progress import announce
from . import frames, kernel
from .cache import KERNEL, OPERATION, TIMED, TURNS, WIRE, Made, Piece, entry

_NOTHING = b"\xc3"  # ret
_OF_ONE = "int64(int64)"
_FUNCTIONS: dict[Piece, tuple[Callable[..., int], str]] = {
    KERNEL: (kernel.run, _OF_ONE),
    TIMED: (kernel.run_timed, _OF_ONE),
    OPERATION: (kernel.run_one, "int64(int64, int64, int64, int64)"),
    TURNS: (serving.run, _OF_ONE),
    WIRE: (frames.function(), frames.SIGNATURE),
}


def made(piece: Piece) -> tuple[Made, str]:
    """Return a piece that is compiled now, and why it could not be kept in the cache, or "".

    Where no bytes can be made of it or run, numba's cache may have it.
    """
    name = _packed_name(piece)
    packed = kept(name)
    if packed is None and _may_run() and (code := flat_code(piece)) is not None:
        return Loaded(code), keep(entry(piece), code)
    return _through_the_cache(*_FUNCTIONS[piece], name, packed, piece.what)


def _may_run() -> bool:
    """Return True where bytes can be mapped and run as machine code of this machine."""
    try:
        return POSSIBLE and bool(Loaded(_NOTHING).address)
    except OSError:
        return False


def flat_code(piece: Piece) -> bytes | None:
    """Return a piece as bytes, compiled now; None: it needs more than its own bytes on this machine."""
    announce(f"compiling {piece.what}, once: some seconds")
    try:
        return flat(*_FUNCTIONS[piece])
    except NotFlatError:
        return None


def _packed_name(piece: Piece) -> str:
    """Return the name of numba's entry: another one in another place, too, which numba's files name."""
    place = hashlib.sha256(str(kernel.__file__).encode()).hexdigest()[:8]
    return entry(piece, f"{place}.zip")


def _through_the_cache(
    function: Callable[..., int], signature: str, name: str, packed: bytes | None, what: str
) -> tuple[Any, str]:
    """Return numba's compiled function, and why it could not be kept, or "".

    `packed` is the entry of this `name`, if there is one, `what` are words for a report.
    """
    try:
        with leftovers.temporary() as folder:
            if packed is not None:
                with zipfile.ZipFile(io.BytesIO(packed)) as archive:
                    archive.extractall(folder)
            with _cached_in(str(folder)):
                found = _compiled(function, signature, what, cache=True)
            return found, "" if found.cache_hits else keep(name, _packed(folder))
    except OSError as error:  # no temporary folder, or a full disk
        return _compiled(function, signature, what, cache=False), error.strerror or str(error)


def _compiled(function: Any, signature: str, what: str, cache: bool) -> Any:
    """Return the compiled function, or the one that numba's cache has; say so before it is compiled."""

    class Compiler(numba.core.compiler.Compiler):  # type: ignore[misc] # numba's
        def define_pipelines(self) -> Any:
            announce(f"compiling {what}, once: some seconds")
            return super().define_pipelines()

    return numba.cfunc(signature, cache=cache, error_model="numpy", pipeline_class=Compiler)(function)


def _packed(folder: Path) -> bytes:
    """Return the files below a folder as an archive."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(path for path in folder.rglob("*") if path.is_file()):
            archive.write(file, file.relative_to(folder).as_posix())
    return packed.getvalue()


@contextlib.contextmanager
def _cached_in(folder: str) -> Iterator[None]:
    """Let numba use this folder as its cache within the block."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = folder
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before
