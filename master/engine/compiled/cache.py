"""The compiled kernel from numba's cache, or made now.

The cache lies in the user's folder of built FMUs, not beside the sources, which may stand where nobody can
write; its name has a digest of all SOURCES of the kernel, since numba looks at one of them alone.
"""

# numba has no types
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numba

from ...builtin import cache_folder
from ...fmi import types
from . import call, kernel, tables

SOURCES: tuple[ModuleType, ...] = (kernel, call, tables, types)
"""The modules of this project that the machine code is made of: `kernel` and what it imports."""
_made: dict[bool, Any] = {}


def compiled(timed: bool = False) -> tuple[int, str]:
    """The address of the kernel, and a notice where it could not be kept ("": it could).

    Compiling takes some seconds, the cache a tenth of one.
    """
    function = kernel.run_timed if timed else kernel.run
    folder, notice = _folder()
    if timed not in _made:
        with _cached_in(folder):
            _made[timed] = numba.cfunc("int64(int64)", cache=not notice, error_model="numpy")(function)
    return int(_made[timed].address), notice


def _folder() -> tuple[Path, str]:
    """The folder of the cache, and a notice where nothing can be written there."""
    content = b"".join(Path(module.__file__ or "").read_bytes() for module in SOURCES)
    digest = hashlib.sha256(content + numba.__version__.encode()).hexdigest()[:16]
    folder = cache_folder() / f"engine-{digest}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        reason = "" if os.access(folder, os.W_OK) else "Permission denied"
    except OSError as error:
        reason = error.strerror or str(error)
    if not reason:
        return folder, ""
    return folder, f"cannot write to the cache folder {folder.parent} ({reason}): the engine is compiled anew"


@contextlib.contextmanager
def _cached_in(folder: Path) -> Iterator[None]:
    """Let numba keep in this folder what it compiles meanwhile."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before
