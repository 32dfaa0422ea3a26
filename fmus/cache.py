"""The user's cache: built FMUs, one file per content, so that a file is never outdated, and machine code.

The folder is $EVCOSIM_CACHE if that is set, else the user's cache folder: ~/.cache/evcosim on Linux
($XDG_CACHE_HOME is followed), ~/Library/Caches/evcosim on macOS, %LOCALAPPDATA%\\evcosim on Windows. FMUs of
earlier sources stay in it; it can be deleted at any time.

What is in it is code that will run. It is used only if the folder and the file belong to this user or to
root, nobody else can write them, and its digest is the one with which it was kept: `NAME.sha256` beside an
FMU, which stays a plain file, the first line of any other entry. What fails is dropped and made anew.
"""

from __future__ import annotations

import contextlib
import contextvars
import errno
import functools
import hashlib
import os
import stat
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

_RECORD = ".sha256"
_MODE = 0o644  # of an entry, whatever the mode mask allows: nobody else writes it


_replaced: dict[Path, Path] = {}
"""The temporary folders of this process in the place of cache folders that cannot be used."""


class Unusable(OSError):
    """A cache that cannot be used; `strerror` is the reason."""


def folder() -> Path:
    """Return the cache folder, which need not exist."""
    if chosen := os.environ.get("EVCOSIM_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or _home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        base = _home() / "Library" / "Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or _home() / ".cache"
    return Path(base) / "evcosim"


def folders() -> list[Path]:
    """Return the cache folder, and the temporary one that this process has in its place."""
    return [folder(), *_replaced.values()]


def _home() -> Path:
    """Return the user's home; where there is none, as for a user id without a name, one of our own."""
    try:
        return Path.home()
    except RuntimeError:
        import tempfile

        return Path(tempfile.gettempdir()) / f"evcosim-{os.geteuid() if hasattr(os, 'geteuid') else 'home'}"


@contextlib.contextmanager
def looking_once() -> Iterator[None]:
    """Within the `with` block what was looked at and found in order is not looked at again.

    A run looks for the FMU of each of its units, and each look asks whether a source was written since.
    """
    token = _seen.set({} if (seen := _seen.get()) is None else seen)
    try:
        yield
    finally:
        _seen.reset(token)


_seen: contextvars.ContextVar[dict[object, str] | None] = contextvars.ContextVar("looked at", default=None)


def once(about: object, look: Callable[[], str]) -> str:
    """Return what a look finds; within `looking_once` it is asked once, unless it found "" before."""
    if (seen := _seen.get()) is None:
        return look()
    if not seen.get(about):
        seen[about] = look()
    return seen[about]


def fetch(name: str, make: Callable[[], bytes], anew: bool = False) -> Path:
    """Return the cached file `name`, written first with the bytes of `make` if it is missing or damaged.

    `anew` writes it in any case. A cache that cannot be used is replaced by a temporary folder that lasts as
    long as the process.
    """
    path, content = folder() / name, None
    try:
        if not anew and once(path, lambda: "held" if holds(path) else ""):
            return path
        if path.parent not in _replaced:
            _make_folder()
            content = make()
            return _keep_file(path, content)
    except OSError as error:
        if path.parent not in _replaced:
            reason = f"cannot use the cache folder {path.parent} ({error.strerror or error})"
            _replaced[path.parent] = _temporary(reason)
    path = _replaced[path.parent] / name
    return path if path.is_file() else write(path, make() if content is None else content)


def _keep_file(path: Path, content: bytes) -> Path:
    """Write a file with its record, and return its path. Raises OSError."""
    write(path, content, _MODE)
    write(path.with_name(path.name + _RECORD), f"{_digest(content)}  {path.name}\n".encode(), _MODE)
    return path


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file that `fetch` found; the record beside it says it. Raises OSError."""
    with contextlib.suppress(OSError):
        said = path.with_name(path.name + _RECORD).read_bytes().split()
        if path.parent == folder() and said[1:] == [path.name.encode()]:
            return said[0].decode()
    return _digest(path.read_bytes())


def load(name: str) -> bytes | None:
    """Return the bytes that `keep` kept under a name, or None: it has none, or none that can be trusted."""
    path = folder() / name
    with contextlib.suppress(OSError):  # `keep` has the reason
        if (entry := _read(path)) is not None:
            digest, _, content = entry.partition(b"\n")
            if digest == _digest(content).encode():
                return content
            _drop(path, _DAMAGED)
    return None


def keep(name: str, content: bytes) -> str:
    """Keep bytes under a name, in place of earlier ones, and return "", or why that is impossible."""
    try:
        _make_folder()
        write(folder() / name, _digest(content).encode() + b"\n" + content, _MODE)
    except OSError as error:
        return error.strerror or str(error)
    return ""


def leave(pattern: str, most: int) -> str:
    """Remove the oldest entries whose names fit a pattern, but for `most`; return "", or why it cannot be."""
    try:
        entries = [(path.stat().st_mtime_ns, path) for path in folder().glob(pattern)]
        for _, path in sorted(entries)[: max(0, len(entries) - most)]:
            path.unlink(missing_ok=True)
    except OSError as error:  # another process removes them, or may
        return error.strerror or str(error)
    return ""


_JUST_NOW = 100_000_000
"""Nanoseconds after a file was written, in which it may be written again and have the same times."""


def settled(path: Path | str) -> tuple[int, ...] | None:
    """Return the state of a file; None if it was written just now. Raises OSError where there is none."""
    found = state(path)
    return None if time.time_ns() - max(found[-2:]) < _JUST_NOW else found


def state(path: Path | str) -> tuple[int, ...]:
    """Return what stays the same as long as a file is neither written nor replaced. Raises OSError."""
    about = os.lstat(path)
    times = about.st_mtime_ns, about.st_ctime_ns
    return about.st_dev, about.st_ino, about.st_mode, about.st_uid, about.st_size, *times


def draft_folder(name: str) -> Path:
    """Make a folder in the cache for what is not whole yet; `remove_draft` ends it. Raises OSError."""
    import tempfile

    _make_folder()
    draft = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=folder()))
    _unfinished.add(draft)
    return draft


def remove_draft(draft: Path) -> None:
    """Remove a folder that was not finished; one that is there under its own name stays."""
    import shutil

    shutil.rmtree(draft, ignore_errors=True)
    _unfinished.discard(draft)


def write(path: Path, content: bytes, mode: int = 0o666) -> Path:
    """Write a file at once or not at all, and return its path; two processes may write it. Raises OSError.

    `mode` are its permissions, without those that the mode mask takes away.
    """
    import tempfile  # slow to import, and a run that finds its FMUs writes nothing

    path.parent.mkdir(parents=True, exist_ok=True)
    handle, draft = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    _unfinished.add(Path(draft))
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(draft, mode & ~_umask())
        os.replace(draft, path)
    except PermissionError:
        # Windows replaces no file that somebody has open: the same content is there already.
        Path(draft).unlink(missing_ok=True)
        if not (path.is_file() and path.read_bytes() == content):
            raise
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
    finally:
        _unfinished.discard(Path(draft))
    return path


_unfinished: set[Path] = set()


@contextlib.contextmanager
def temporary_folder() -> Iterator[Path]:
    """Give a folder that is removed at the end, also where the process ends at once."""
    import shutil
    import tempfile

    path = Path(tempfile.mkdtemp(prefix="evcosim-"))
    _unfinished.add(path)
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)
        _unfinished.discard(path)


def take_away() -> None:
    """Remove half-written files and the folder that is deleted at exit, before the process ends at once."""
    import shutil

    for path in list(_unfinished):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


_DAMAGED = "is damaged: its digest is not the one with which it was kept"


def holds(path: Path) -> bool:
    """Return True for a file of the cache whose digest stands in the record beside it; drop any other.

    Raises OSError.
    """
    beside = path.with_name(path.name + _RECORD)
    states: tuple[object, object] = None, None
    with contextlib.suppress(OSError):  # what it is, reading says
        states = settled(path), settled(beside)
        if all(states) and _known.get(path) == states:
            require_our_folder(path.parent)
            return True
    content = _read(path)
    record = _read(beside)
    if content is None or record is None:
        return False  # another process may be about to write the record
    if record != f"{_digest(content)}  {path.name}\n".encode():
        _drop(path, _DAMAGED)
        return False
    _known[path] = states
    return True


_known: dict[Path, tuple[object, object]] = {}
"""The states of files that this process has compared with their records, and of those."""


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _read(path: Path) -> bytes | None:
    """Return the bytes of a file of the cache; None if there is none, or none that can be trusted.

    The latter is dropped. Raises OSError if the folder cannot be used.
    """
    if not path.parent.exists():
        return None
    require_our_folder(path.parent)
    try:
        with open(path, "rb", opener=_open_no_link) as file:
            about = os.fstat(file.fileno())
            reason = _distrust(about) if stat.S_ISREG(about.st_mode) else "is no file"
            if not reason:
                return file.read()
    except FileNotFoundError:
        return None
    except IsADirectoryError:
        reason = "is a folder"
    except OSError as error:
        if error.errno != errno.ELOOP:
            raise
        reason = "is a link"
    _drop(path, reason)
    return None


def _open_no_link(path: str, flags: int) -> int:
    """Open a file, but no link, and without waiting for the other end of a pipe. Raises OSError."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))


def _distrust(about: os.stat_result) -> str:
    """Return why what a file or folder holds could be somebody else's, or ""."""
    if not hasattr(os, "geteuid"):  # Windows, where the folder of a user is the user's
        return ""
    if about.st_uid not in (os.geteuid(), 0):
        return f"it belongs to another user ({about.st_uid})"
    if about.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"others can write it (mode {stat.S_IMODE(about.st_mode):o}; chmod go-w ends that)"
    return ""


def _drop(path: Path, reason: str) -> None:
    """Say in a line that an entry cannot be used; the new one takes its place.

    A file is not removed: another process may have made it anew by now, and read it.
    """
    if path.is_dir() and not path.is_symlink():
        import shutil

        shutil.rmtree(path, ignore_errors=True)
    print(f"evcosim: {path}: {reason}; it is dropped and made anew", file=sys.stderr)


def _make_folder() -> None:
    """Make the cache folder for this user alone. Raises OSError if it is there and cannot be trusted."""
    path = folder()
    path.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(FileExistsError):
        path.mkdir(mode=0o700)
    require_our_folder(path)


def require_our_folder(path: Path) -> None:
    """Raise OSError for what is no folder, or one in which somebody else can write."""
    about = path.stat()
    if not stat.S_ISDIR(about.st_mode):
        raise Unusable(0, "it is a file, not a folder")
    if reason := _distrust(about):
        raise Unusable(0, f"{reason}, so that what is in it cannot be trusted")


@functools.cache
def _umask() -> int:
    """Return the process's mode mask, which mkstemp ignores; it can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def _temporary(reason: str) -> Path:
    """Make a folder that is deleted at exit, print the reason, and return the folder."""
    import atexit
    import shutil
    import tempfile

    path = Path(tempfile.mkdtemp(prefix="evcosim-"))
    _unfinished.add(path)
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    print(f"evcosim: {reason}; FMUs are built into {path} for this run", file=sys.stderr)
    return path
