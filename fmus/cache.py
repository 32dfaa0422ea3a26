"""Where built FMUs wait for the next run: one file per content, so nothing in it is ever wrong, only unused.

The folder is $EVCOSIM_CACHE, or else the user's cache folder: ~/.cache/evcosim on Linux ($XDG_CACHE_HOME is
followed), ~/Library/Caches/evcosim on macOS, %LOCALAPPDATA%\\evcosim on Windows. FMUs of earlier sources stay
in it; it can be deleted at any time.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable
from pathlib import Path


def folder() -> Path:
    """The cache folder, which need not exist."""
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
    """The cached file `name`, made first if it is missing.

    A cache that cannot be written is replaced by a temporary folder that lives as long as the process.
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
    """Write a file at once or not at all: two processes may write it at the same time. Raises OSError."""
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
    """The mode that mkstemp ignores. It can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


@functools.cache
def _temporary(reason: str) -> Path:
    import atexit
    import shutil
    import tempfile

    path = Path(tempfile.mkdtemp(prefix="evcosim-"))
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    print(f"evcosim: {reason}; FMUs are built into {path} for this run", file=sys.stderr)
    return path
