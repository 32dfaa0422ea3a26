"""The compiled kernel, from numba's cache or compiled now.

The cache is in the user's folder of built FMUs, since the folder of the sources may be read-only; its name
has a digest of all SOURCES of the kernel, of which numba itself compares only one.
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
"""The modules of this project that the machine code is made of: `kernel` and those that it imports."""
_made: dict[bool, Any] = {}


def compiled(timed: bool = False) -> tuple[int, str]:
    """Return the address of the kernel (`timed`: of the one that measures a profile) and a notice.

    The notice is "", unless the kernel could not be kept. Compiling takes some seconds, the cache 0.1 s.
    """
    function = kernel.run_timed if timed else kernel.run
    folder, notice = _folder()
    if timed not in _made:
        with _cached_in(folder):
            _made[timed] = numba.cfunc("int64(int64)", cache=not notice, error_model="numpy")(function)
    return int(_made[timed].address), notice


def _folder() -> tuple[Path, str]:
    """Return the folder of the cache, and a notice if nothing can be written there, else ""."""
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
    """Let numba use this folder as its cache within the block."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before
