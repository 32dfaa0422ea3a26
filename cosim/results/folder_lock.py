"""The lock on a folder that a process writes into.

It is `flock` of the folder itself: there is no file of it, and it ends with the process, however that ends.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from ..errors import ConfigError
from ..file_names import flaw_of_name, short_path
from ..leftovers import temporary_files
from ..writing import reason, try_folder
from .manifest import is_cut, read_manifest

MANIFEST_NAME = "run.json"
KEPT_IN = "kept_in"
"""The key of run.json for the folder that has the results in its place."""
_PATIENCE = 0.3  # s for somebody who looks whether a run lives


class FolderLock:
    """A lock on a folder, which no other process can have meanwhile. It is made if needed.

    Raises ConfigError naming the run that has the folder, or the reason why it cannot be written. Where the
    system or the disk knows no such lock (Windows, some network disks), nothing is locked.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder
        self._descriptor: int | None = None
        self._take()

    def _take(self) -> None:
        folder = self.path
        if flaw := flaw_of_name(folder):
            raise ConfigError(f"output folder {short_path(folder)}: cannot be written: {flaw}")
        try:
            try_folder(folder)
        except OSError as error:
            said = reason(folder / MANIFEST_NAME, error)
            raise ConfigError(f"output folder {folder}: cannot be written: {said}") from error
        self._descriptor = _locked(folder)

    @property
    def is_there(self) -> bool:
        """False where somebody removed, renamed or replaced the folder meanwhile, as far as that is known."""
        if self._descriptor is None:
            return True
        with contextlib.suppress(OSError):
            return os.path.samestat(os.fstat(self._descriptor), self.path.stat())
        return False

    def take_again(self) -> None:
        """Make and lock the folder that is not there any more. Raises ConfigError as at the begin."""
        self.release()
        self._take()

    def release(self) -> None:
        """Give the folder free."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


def _locked(folder: Path) -> int | None:
    """Lock a folder and return the descriptor that holds the lock. Raises ConfigError as FolderLock does."""
    end = time.monotonic() + _PATIENCE
    while (descriptor := _try_lock(folder)) == _TAKEN:
        if time.monotonic() > end:
            raise ConfigError(
                f"output folder {folder}: {_owner(folder)} is writing into it; wait for its end"
            )
        time.sleep(0.01)
    return descriptor


_TAKEN = -1


def _try_lock(folder: Path) -> int | None:
    """Return the descriptor that holds the lock; _TAKEN: another one does; None: there are no locks."""
    try:
        import fcntl
    except ImportError:  # Windows
        return None
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:  # a folder that can be written and not read
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        return _TAKEN if isinstance(error, BlockingIOError) else None
    return descriptor


def _owner(folder: Path) -> str:
    """Return a name for the run that has a folder: run.json says which it is, once it has begun."""
    about = manifest_of(folder)
    process = about.get("process")
    if about.get("status") != "running" or not isinstance(process, dict):
        return "another run"
    name = " ".join(str(about[key]) for key in ("system", "scenario") if about.get(key))
    who = f"process {process.get('id')} on {process.get('host')} since {process.get('since')}"
    return f"the run '{name}', {who},"


def manifest_of(folder: Path) -> dict[str, Any]:
    """Return what run.json says of the run in a folder; nothing where there is none that can be read."""
    try:
        return read_manifest(folder / MANIFEST_NAME)[0]
    except ConfigError:
        return {}


def manifest_is_cut(folder: Path) -> bool:
    """Return True for a run.json of which a power cut, or a full disk, has left a part, or zeros."""
    return is_cut(folder / MANIFEST_NAME)


def lives(folder: Path) -> bool:
    """Return True while a run has the folder."""
    descriptor = _try_lock(folder)
    if descriptor is not None and descriptor != _TAKEN:
        os.close(descriptor)
    return descriptor == _TAKEN


def status(folder: Path, manifest: Mapping[str, Any]) -> str | None:
    """Return how the run in a folder ended, where its manifest says that it runs and it does not: "killed".

    "cut off" where the process has left its results elsewhere, and could not say so: its disk took no more.
    """
    said = manifest.get("status")
    if said != "running" or lives(folder):
        return said
    return "cut off" if kept_elsewhere(folder) else "killed"


def kept_elsewhere(folder: Path) -> Path | None:
    """Return where the run in a folder has left its results that its disk did not take; None: nowhere known.

    run.json says it, or the results among the temporary files of this user name the same process.
    """
    about = manifest_of(folder)
    if isinstance(said := about.get(KEPT_IN), str):
        return Path(said)
    if not isinstance(process := about.get("process"), dict) or about.get("status") != "running":
        return None
    with contextlib.suppress(OSError):
        for kept in Path(temporary_files()).glob("evcosim-results-*"):
            ours = not hasattr(os, "getuid") or kept.stat().st_uid == os.getuid()
            if ours and manifest_of(kept).get("process") == process:
                return kept
    return None
