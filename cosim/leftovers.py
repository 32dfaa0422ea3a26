"""Temporary folders, half-written files and child processes: what this process takes away before it ends.

Each is removed by the block that made it. A process that ends at once, on a signal, leaves no block: it calls
`take_away`. A name is listed before the file exists, and a kill as soon as there is a process. A process that
is killed itself leaves its files; its children end with it in other ways.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

_KILLED = 0.3  # s that killed processes may take to end before their folders are removed

_folders: set[Path] = set()
_files: set[Path] = set()
_children: dict[int, Callable[[], None]] = {}  # by process id, what kills it


def temporary_folder() -> Path:
    """Make a folder of this user alone, where the system has temporary files; `remove_folder` ends it.

    Raises OSError where there is no room, or no folder that can be written.
    """
    while True:
        folder = Path(temporary_files()) / f"evcosim-{secrets.token_hex(6)}"
        _folders.add(folder)
        try:
            folder.mkdir(mode=0o700)
            return folder
        except FileExistsError:
            _folders.discard(folder)
        except BaseException:
            _folders.discard(folder)
            raise


def temporary_files() -> str:
    """Return the folder of temporary files. Raises OSError where there is none that can be written."""
    try:
        return tempfile.gettempdir()
    except FileNotFoundError:
        os.close(os.open(os.devnull, os.O_RDONLY))  # raises the reason where no file can be opened at all
        raise


def remove_folder(folder: Path) -> None:
    """Remove a temporary folder with all that is in it; what cannot be removed stays."""
    shutil.rmtree(folder, ignore_errors=True)
    _folders.discard(folder)


def keep_folder(folder: Path, name: str) -> Path:
    """Let a temporary folder stay, with a word in its name that says what it is. Raises OSError."""
    kept = folder.with_name(folder.name.replace("-", f"-{name}-", 1))
    folder.rename(kept)
    _folders.discard(folder)
    return kept


@contextlib.contextmanager
def temporary() -> Iterator[Path]:
    """Give a temporary folder, which is removed at the end of the `with` block."""
    folder = temporary_folder()
    try:
        yield folder
    finally:
        remove_folder(folder)


@contextlib.contextmanager
def partial(path: Path) -> Iterator[None]:
    """List a file within the block, at the end of which it is removed, unless it has another name then."""
    _files.add(path)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
        _files.discard(path)


def add_child(process: int, kill: Callable[[], None]) -> None:
    """List a child process. `kill` ends it and takes no lock, since a signal handler may call it."""
    _children[process] = kill


def forget_child(process: int) -> None:
    """Take a child from the list: it has ended and was waited for."""
    _children.pop(process, None)


def take_away() -> None:
    """Kill the children and remove the files and folders that are there; a signal handler may call it."""
    children = list(_children.items())
    for _, kill in children:
        with contextlib.suppress(OSError):
            kill()
    end = time.monotonic() + _KILLED
    for process, _ in children:
        while not _ended(process) and time.monotonic() < end:
            time.sleep(0.002)
    for path in list(_files):
        with contextlib.suppress(OSError):
            path.unlink()
    for folder in list(_folders):
        shutil.rmtree(folder, ignore_errors=True)


def _ended(process: int) -> bool:
    """Return True for a child that has ended; it is not waited for, which its owner may be doing."""
    if not hasattr(os, "waitid"):  # Windows and macOS
        return True
    try:
        return os.waitid(os.P_PID, process, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
    except ChildProcessError:  # somebody has waited for it
        return True
