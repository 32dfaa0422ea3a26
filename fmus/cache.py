"""The user's cache of built FMUs: one file per content, so that a file is never outdated, only unused.

The folder is $EVCOSIM_CACHE if that is set, else the user's cache folder: ~/.cache/evcosim on Linux
($XDG_CACHE_HOME is followed), ~/Library/Caches/evcosim on macOS, %LOCALAPPDATA%\\evcosim on Windows. FMUs of
earlier sources stay in it; it can be deleted at any time.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable
from pathlib import Path


def folder() -> Path:
    """Return the cache folder, which need not exist."""
    if chosen := os.environ.get("EVCOSIM_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "evcosim"


def fetch(name: str, make: Callable[[], bytes]) -> Path:
    """Return the cached file `name`, written first with the bytes of `make` if it is missing.

    A cache that cannot be written is replaced by a temporary folder that lasts as long as the process.
    """
    path = folder() / name
    if path.is_file():
        return path
    content = make()
    try:
        return write(path, content)
    except OSError as error:
        path = _temporary(f"cannot write to the cache folder {path.parent} ({error.strerror})") / name
        return path if path.is_file() else write(path, content)


def write(path: Path, content: bytes) -> Path:
    """Write a file at once or not at all, and return its path; two processes may write it. Raises OSError."""
    import tempfile  # slow to import, and a run that finds its FMUs writes nothing

    path.parent.mkdir(parents=True, exist_ok=True)
    handle, draft = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(draft, 0o666 & ~_umask())
        os.replace(draft, path)
    except PermissionError:
        # Windows replaces no file that somebody has open: the same content is there already.
        Path(draft).unlink(missing_ok=True)
        if not (path.is_file() and path.read_bytes() == content):
            raise
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
    return path


@functools.cache
def _umask() -> int:
    """Return the process's mode mask, which mkstemp ignores; it can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


@functools.cache
def _temporary(reason: str) -> Path:
    """Make a folder that is deleted at exit, print the reason once, and return the folder."""
    import atexit
    import shutil
    import tempfile

    path = Path(tempfile.mkdtemp(prefix="evcosim-"))
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    print(f"evcosim: {reason}; FMUs are built into {path} for this run", file=sys.stderr)
    return path
