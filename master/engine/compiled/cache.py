"""The compiled kernel, from numba's cache or compiled now.

What numba keeps in its own cache folder stands as one entry in the user's cache of built FMUs, which gives
nothing back that somebody else could have written or that was changed (`evcosim.fmus.cache`). Its name has a
digest of all SOURCES of the kernel, of which numba itself compares only one, and of this processor.
"""

# numba has no types
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import contextlib
import hashlib
import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import llvmlite.binding
import numba

from ....cosim import leftovers
from ....cosim.can.wire import tables as wire_tables
from ...builtin import cache_folder, keep, kept
from ...fmi import types
from ...machine import access, calling, flat, handing, serving, slots, tables
from ..progress import announce
from . import frames, kernel

SOURCES: tuple[ModuleType, ...] = (kernel, calling, handing, access, tables, slots, types, wire_tables)
"""The modules of this project that the machine code is made of: `kernel` and those that it imports."""
_SERVING: tuple[ModuleType, ...] = (serving, flat, calling, handing, access, tables, slots, types)
_WIRE = "wire"
_KERNEL = "int64(int64)"
_made: dict[bool | str, Any] = {}


def compiled(timed: bool = False) -> tuple[int, str]:
    """Return the address of the kernel (`timed`: of the one that measures a profile) and a notice.

    The notice is "", unless the kernel could not be kept. Compiling takes some seconds, the cache 0.1 s.
    """
    notice = ""
    if timed not in _made:
        function = kernel.run_timed if timed else kernel.run
        _made[timed], reason = _through_the_cache(function, _name(timed), what="the engine")
        if reason:
            notice = _not_kept(reason)
    return int(_made[timed].address), notice


def wire() -> tuple[int, str]:
    """Return the address of the frame path's function and a notice, as `compiled` does: in 10 s, or 0.1 s."""
    if _WIRE not in _made:
        name = f"wire-{_digest((frames, *frames.SOURCES), str(frames.__file__).encode())}.zip"
        _made[_WIRE], reason = _through_the_cache(
            frames.function(), name, frames.SIGNATURE, "the frames of buses"
        )
        if reason:
            return int(_made[_WIRE].address), _not_kept(reason)
    return int(_made[_WIRE].address), ""


def _not_kept(reason: str) -> str:
    return f"cannot use the cache folder {cache_folder()} ({reason}): the engine is compiled anew"


def served() -> bytes | None:
    """Return the machine code of the turns of an isolated unit, from the cache or compiled now.

    None: it needs more than its own bytes on this machine, so that Python does the turns there.
    """
    name = f"turns-{_digest(_SERVING)}.bin"
    code = kept(name)
    if code is None:
        try:
            code = flat.flat(serving.run)
        except flat.NotFlatError:
            return None
        keep(name, code)  # a cache that keeps nothing is told by the engine's own
    return code


def _name(timed: bool) -> str:
    """Return the name of the kernel's entry: another one in another place, too, which numba's files name."""
    digest = _digest(SOURCES, str(kernel.__file__).encode())
    return f"engine-{digest}-{'timed' if timed else 'plain'}.zip"


def _digest(modules: tuple[ModuleType, ...], *more: bytes) -> str:
    """Return a digest of these sources and of this processor."""
    parts = [Path(module.__file__ or "").read_bytes() for module in modules]
    parts += [numba.__version__.encode(), *more]
    parts += [llvmlite.binding.get_host_cpu_name().encode()]
    parts += [llvmlite.binding.get_host_cpu_features().flatten().encode()]
    return hashlib.sha256(b"\n".join(parts)).hexdigest()[:16]


def _through_the_cache(
    function: Any, name: str, signature: str = _KERNEL, what: str = "a function"
) -> tuple[Any, str]:
    """Return the compiled function, and why it could not be kept, or ""; `what` is its name in a report."""
    try:
        with leftovers.temporary() as folder:
            if (packed := kept(name)) is not None:
                with zipfile.ZipFile(io.BytesIO(packed)) as archive:
                    archive.extractall(folder)
            with _cached_in(str(folder)):
                made = _compiled(function, signature, what, cache=True)
            return made, "" if made.cache_hits else keep(name, _packed(folder))
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
