"""Rows of numbers that a run appends: in memory while they are few, in a file beyond that.

A run of 8 hours at 100 Hz records a gigabyte. Its results are read a stretch of rows at a time, so that is
all that is in memory of a Table in a file. The times of equal steps are not kept at all (Grid).
"""

from __future__ import annotations

import dataclasses
import os
import tempfile
import threading
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from .clock import Clock
from .errors import RunError
from .shortage import reason

Array = NDArray[np.float64]
"""Numbers in memory; what is declared with it says its shape."""

MEMORY = 16 * 2**20  # bytes of rows that stay in memory: nine minutes of 40 variables at 100 Hz
_STRETCH = 2**20  # bytes that are read at a time to take some of the columns


@dataclasses.dataclass(frozen=True)
class Grid:
    """The times t_k [s] of a clock, k = 0 ... count - 1."""

    clock: Clock
    count: int

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, rows: slice) -> Array:
        """Return the times [s] of some rows, shape (rows,)."""
        first, stop, stride = rows.indices(self.count)
        return self.clock.times(first, stop)[::stride]


@runtime_checkable
class Table(Protocol):
    """Numbers in n rows and m columns."""

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of rows and of columns, (n, m)."""

    def rows(self, start: int, stop: int) -> Array:
        """Return the rows from `start` to before `stop`, or to the end, shape (rows, m)."""

    def part(self, start: int, stop: int, columns: Sequence[int]) -> Array:
        """Return some columns of these rows, shape (rows, len(columns))."""

    def column(self, j: int) -> Array:
        """Return column j, shape (n,)."""

    def whole(self) -> Array:
        """Return all of it, shape (n, m), in memory."""


class MemoryTable:
    """A Table that is an array of shape (n, m); rows and columns are views of it."""

    def __init__(self, array: Array) -> None:
        self._array = array
        self.shape: tuple[int, int] = (array.shape[0], array.shape[1])

    def rows(self, start: int, stop: int) -> Array:
        """Return a view of some rows, shape (rows, m)."""
        return self._array[start:stop]

    def part(self, start: int, stop: int, columns: Sequence[int]) -> Array:
        """Return a copy of some columns of some rows, shape (rows, len(columns))."""
        return self._array[start:stop, list(columns)]

    def column(self, j: int) -> Array:
        """Return a view of column j, shape (n,)."""
        return self._array[:, j]

    def whole(self) -> Array:
        """Return the array itself, shape (n, m)."""
        return self._array


class _RowFile:
    """A file with rows from byte `offset` on, closed when the last that refers to it has gone.

    Two threads may read and write it.
    """

    def __init__(self, file: Any, offset: int = 0) -> None:
        self._file = file  # whose type depends on the platform
        self._offset = offset
        self._lock = threading.Lock()
        weakref.finalize(self, file.close)

    def read(self, place: int, into: memoryview[int]) -> None:
        """Fill `into` from byte `place` on. Raises RunError where the file has fewer bytes."""
        with self._lock:
            self._file.seek(self._offset + place)
            while into:  # one call reads 2 GiB at most
                count = self._file.readinto(into)
                if not count:
                    raise RunError(f"the file of the rows ends {len(into)} bytes too early")
                into = into[count:]

    def write(self, place: int, data: memoryview[int]) -> None:
        """Write bytes from byte `place` on. Raises OSError where the disk refuses."""
        with self._lock:
            self._file.seek(self._offset + place)
            write_all(self._file, data)

    def is_at(self, path: Path) -> bool:
        """Return False where the file has no longer the name that it was made with."""
        try:
            return os.path.samestat(os.fstat(self._file.fileno()), path.stat(follow_symlinks=False))
        except OSError:
            return False


def write_all(file: Any, data: memoryview[int]) -> None:
    """Write bytes into an unbuffered file, as many as the disk takes. Raises OSError where it is full."""
    while data:
        data = data[file.write(data) :]


def rows_in(path: Path, offset: int, width: int) -> Table:
    """Return the whole rows of `width` numbers from byte `offset` of a file on. Raises OSError.

    A row without numbers stands in the file as a number that counts for nothing.
    """
    file = path.open("rb", buffering=0)
    count = max(0, os.fstat(file.fileno()).st_size - offset) // (8 * (width or 1))
    if not width:
        file.close()
        return MemoryTable(np.empty((count, 0)))
    return _FileTable(_RowFile(file, offset), count, np.empty((0, width)))


class _FileTable:
    """A Table of the first `count` rows of a file, and then those of `last`, shape (rows, m)."""

    def __init__(self, file: _RowFile, count: int, last: Array) -> None:
        self._file, self._count, self._last = file, count, last
        self.shape: tuple[int, int] = (count + len(last), last.shape[1])

    def rows(self, start: int, stop: int) -> Array:
        """Return some rows, shape (rows, m), read from the file."""
        start, stop, _ = slice(start, stop).indices(self.shape[0])
        count, width = max(0, min(stop, self._count) - start), self.shape[1]
        found = np.empty((max(0, stop - start), width))
        if count:
            self._file.read(start * width * 8, found[:count].data.cast("B"))
        found[count:] = self._last[max(0, start - self._count) : max(0, stop - self._count)]
        return found

    def part(self, start: int, stop: int, columns: Sequence[int]) -> Array:
        """Return some columns of some rows, shape (rows, len(columns)), read a stretch of rows at a time."""
        start, stop, _ = slice(start, stop).indices(self.shape[0])
        found = np.empty((max(0, stop - start), len(columns)))
        step = max(1, _STRETCH // (8 * self.shape[1]))
        for k in range(0, len(found), step):
            found[k : k + step] = self.rows(start + k, min(start + k + step, stop))[:, list(columns)]
        return found

    def column(self, j: int) -> Array:
        """Return column j, shape (n,), read a stretch of rows at a time."""
        return self.part(0, self.shape[0], [j])[:, 0]

    def whole(self) -> Array:
        """Return all rows, shape (n, m), read from the file."""
        return self.rows(0, self.shape[0])


class RowStore:
    """Rows of `width` numbers, appended in order.

    Beyond `memory` bytes they are in a temporary file without a name in `folder` (default: the system's,
    which TMPDIR sets); it is gone when nothing refers to it any more, however the process ends. After
    `keep_in` they are in a file with a name, which `save` brings up to date, in any thread. Where a file
    cannot be written, the error names the rows by `what`, and what to do by `advice`.
    """

    def __init__(
        self,
        width: int,
        memory: int = MEMORY,
        folder: Path | None = None,
        what: str = "what the run records",
        advice: str = "`record` less needs less",
    ) -> None:
        self._width, self._memory, self._folder = width, memory, folder
        self._what, self._advice = what, advice
        self._chunks: list[Array] = []  # the rows in memory: those from row `_freed` on
        self._file: _RowFile | None = None
        self._path: Path | None = None
        self._head = b""
        self._before: Callable[[], None] = lambda: None
        self._there: Callable[[], bool] = lambda: True
        self._freed = self._in_memory = self._in_file = 0
        self._gone = False  # the file has lost its name
        self._lock = threading.RLock()

    def __len__(self) -> int:
        return self._freed + self._in_memory

    def keep_in(
        self,
        path: Path,
        head: bytes,
        before: Callable[[], None] = lambda: None,
        there: Callable[[], bool] = lambda: True,
    ) -> None:
        """Name the file that `save` makes: it begins with `head`, then the rows follow from the first on.

        `before` is called before rows are written; it may raise OSError as writing them may. Rows that are no
        more in memory are copied at once. Raises RunError where that fails; then all is as it was. A file
        that somebody removed is made anew as long as its folder is `there`.
        """
        with self._lock:
            earlier = self._path, self._head, self._before, self._file, self._in_file
            self._path, self._head, self._before, self._there = path, head, before, there
            if self._file is None:
                return
            try:
                self._copy(self._file)
            except OSError as error:
                refused = self._refused(error)
                self._path, self._head, self._before, self._file, self._in_file = earlier
                raise refused from error

    def _copy(self, file: _RowFile) -> None:
        """Write the rows that are in another file alone, a stretch of rows at a time. Raises OSError."""
        rows = _FileTable(file, self._freed, np.empty((0, self._width)))
        self._file, self._in_file = None, 0
        self._before()
        step = max(1, _STRETCH // (8 * self._width))
        for k in range(0, self._freed, step):
            self._save(k, rows.rows(k, k + step))

    def append(self, rows: Array) -> None:
        """Keep rows, shape (n, width), which are not to be changed afterwards.

        Raises RunError when the file cannot be written; the rows are then kept in memory.
        """
        if not len(rows):
            return  # nothing to keep, and a memoryview of nothing cannot be cast
        with self._lock:
            self._chunks.append(rows)
            self._in_memory += len(rows)
            if self._in_memory * self._width * 8 > self._memory:
                self.save()
                self._freed += self._in_memory
                self._chunks, self._in_memory = [], 0

    def save(self, more: Array | None = None, after: int = 0) -> None:
        """Write the rows that are not yet in the file.

        `more`, shape (n, width), are the first ones of the rows that will be appended when there are `after`
        rows; they are left out where there are more already. Raises RunError as `append` does.
        """
        with self._lock:
            first = self._freed
            chunks = list(self._chunks)
            if more is not None and after == len(self):
                chunks.append(more)
            try:
                self._restore()
                self._before()
                for rows in chunks:
                    self._save(first, rows)
                    first += len(rows)
            except OSError as error:
                raise self._refused(error) from error

    def _restore(self) -> None:
        """Make the file anew that somebody removed; where that is impossible, it goes on without a name."""
        old, count = self._file, self._in_file
        if old is None or self._path is None or self._gone or old.is_at(self._path):
            return
        if not self._there():
            self._gone = True
            return
        try:
            self._copy(old)
        except OSError:
            self._gone = True
            if self._file is not None and self._file.is_at(self._path):
                self._path.unlink()
            self._file, self._in_file = old, count

    def _save(self, first: int, rows: Array) -> None:
        """Write what the file does not have of `rows`, the first of which is row `first`."""
        data = np.ascontiguousarray(rows[max(0, self._in_file - first) :])
        if not self._width:  # so that the rows can be counted
            data = np.zeros((len(data), 1))
        if not data.size:
            return
        if self._file is None:
            self._file = self._made()
        self._file.write(self._in_file * data.shape[1] * 8, data.data.cast("B"))
        self._in_file += len(data)

    def _made(self) -> _RowFile:
        if self._path is None:
            return _RowFile(tempfile.TemporaryFile(prefix="evcosim-", dir=self._folder, buffering=0))
        file = self._path.open("x+b", buffering=0)  # exclusively: it follows no link
        try:
            write_all(file, memoryview(self._head))
        except OSError:
            file.close()
            self._path.unlink()
            raise
        return _RowFile(file, len(self._head))

    def _refused(self, error: OSError) -> RunError:
        folder = self._folder or tempfile.gettempdir() if self._path is None else self._path.parent
        other = "TMPDIR names another folder, " if self._path is None else ""
        return RunError(f"{self._what} cannot be kept in {folder}: {reason(error)}; {other}{self._advice}")

    def table(self, last: Array | None = None) -> Table:
        """Return the rows up to now and after them `last`, shape (rows, width).

        Rows that are appended later do not change it.
        """
        with self._lock:
            tail = [*self._chunks, *([] if last is None else [last])]
            rows = np.vstack([np.empty((0, self._width)), *tail])
            if not self._freed or self._file is None:
                return MemoryTable(rows)
            return _FileTable(self._file, self._freed, rows)


def check_times(times: Array) -> None:
    """Raise ValueError for times [s], shape (n,), of which one is not finite or comes before the last one."""
    if times.ndim != 1:
        raise ValueError(f"time has {times.ndim} dimensions: it is a list of numbers")
    bad = np.flatnonzero(~np.isfinite(times))
    if len(bad):
        raise ValueError(f"time[{bad[0]}] = {times[bad[0]]}: times are finite")
    back = np.flatnonzero(times[1:] < times[:-1])
    if len(back):
        k = int(back[0]) + 1
        raise ValueError(f"time[{k}] = {times[k]!r} comes after {times[k - 1]!r}: time must not decrease")
