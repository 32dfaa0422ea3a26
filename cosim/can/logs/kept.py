"""Recordings that are made once: for all runs of a process, and of the processes that run points of a study.

A recording is kept as long as the file is as it was and the same signals of it are wanted. Of the latest ones
a process keeps two; their frames are in memory or in a temporary file (`recording`). The processes of a study
share a folder, in which each finds what the one that started them, or another of them, has read.
"""

from __future__ import annotations

import collections
import contextlib
import dataclasses
import hashlib
import os
import pickle
from pathlib import Path

import numpy as np

from ...errors import RunError
from ...row_store import MemoryTable, rows_in
from .recording import Recording, recorded
from .variants import Variants

_MOST = 2
_STRETCH = 1 << 16  # rows that are written at a time

_latest: collections.OrderedDict[str, Recording] = collections.OrderedDict()
_folder: Path | None = None


def recorded_once(path: Path, variants: Variants) -> Recording:
    """Return the recording of a log, read where none is kept. Raises as `recorded`."""
    try:
        key = _key(path, variants)
    except OSError:
        return recorded(path, variants)  # which says what is wrong
    found = _latest.get(key)
    if found is None and _folder is not None:
        found = _taken(_folder, key)
    if found is None:
        found = recorded(path, variants)
        if _folder is not None:
            _give(_folder, key, found)
    _latest[key] = found
    _latest.move_to_end(key)
    while len(_latest) > _MOST:
        _latest.popitem(last=False)
    return dataclasses.replace(found, path=path)


def share(folder: Path) -> None:
    """Take recordings from a folder of this user, and put others into it, from now on."""
    global _folder
    _folder = folder


def hand_over(folder: Path) -> None:
    """Write what this process keeps into a folder, for processes that share it; not what finds no room."""
    for key, recording in _latest.items():
        _give(folder, key, recording)


def _key(path: Path, variants: Variants) -> str:
    """Return what a recording depends on, as a name. Raises OSError where there is no such file."""
    there = path.resolve()
    about = there.stat()
    file = str(there), about.st_dev, about.st_ino, about.st_size, about.st_mtime_ns
    return hashlib.sha256(repr((file, variants.wanted)).encode()).hexdigest()


def _give(folder: Path, key: str, recording: Recording) -> None:
    rows, draft = folder / f"{key}.rows", folder / f"{key}.{os.getpid()}"
    table = recording.table
    empty = MemoryTable(np.empty((0, table.shape[1])))
    try:
        with draft.open("wb") as file:
            for start in range(0, table.shape[0], _STRETCH):
                file.write(np.ascontiguousarray(table.rows(start, start + _STRETCH)).data)
        draft.replace(rows)
        draft.write_bytes(pickle.dumps(dataclasses.replace(recording, table=empty)))
        draft.replace(folder / key)  # the last: where it is, the rows are
    except (OSError, RunError):  # no room: others read the log by themselves
        with contextlib.suppress(OSError):
            draft.unlink()


def _taken(folder: Path, key: str) -> Recording | None:
    try:
        recording: Recording = pickle.loads((folder / key).read_bytes())
        return dataclasses.replace(
            recording, table=rows_in(folder / f"{key}.rows", 0, recording.table.shape[1])
        )
    except OSError:
        return None
