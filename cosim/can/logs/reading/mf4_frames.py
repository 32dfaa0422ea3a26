"""The frames of a log of ASAM MDF 4, by asammdf, written to the standard output as records.

It is a program of its own, which `mf4` starts: the machine code of asammdf crashes on some damaged files, and
takes as much memory as they tell.
"""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from .blocks import FRAME
from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE

Rows = NDArray[Any]
"""Frames, shape (n,) of FRAME, of which `channel` is the number that the log gives the bus."""
END = 255
"""The kind of the last record, which is no frame."""
STRETCH = 20_000
"""Frames that are read, and written, at a time."""
UNREAD = 3
"""The exit code where the library cannot read the file; the reason stands on the standard error."""

_KINDS = {"CAN_DataFrame": DATA, "CAN_RemoteFrame": REMOTE, "CAN_ErrorFrame": ERROR}
_ID, _EXTENDED = 0x1FFFFFFF, 0x80000000
_INTEGERS = 3  # the greatest type of data that is an integer
_MEMORY = 8 << 30  # bytes of address space


def frames_of(path: Path, stretch: int = STRETCH) -> Iterator[Rows]:
    """Yield the frames in the order of time. Raises whatever the library does for a damaged file."""
    from asammdf import MDF

    with contextlib.closing(MDF(path)) as mdf:
        streams = [
            _frames(mdf, number, name, stretch)
            for number, group in enumerate(mdf.groups)
            for name in dict.fromkeys(channel.name for channel in group.channels)
            if name in _KINDS and group.channel_group.cycles_nr
        ]
        yield from merged(streams)


def merged(streams: Iterable[Iterator[Rows]]) -> Iterator[Rows]:
    """Yield the rows of several streams by time; those of a stream keep their order whatever it is."""
    heads = [_Head(stream) for stream in streams]
    while heads := [head for head in heads if head.fill()]:
        until = min(int(head.keys[-1]) for head in heads)
        parts = [head.taken(until) for head in heads]
        keys, rows = (np.concatenate(column) for column in zip(*parts, strict=True))
        yield rows[np.argsort(keys, kind="stable")]


class _Head:
    """The rows of a stream that are not taken yet; `keys` are the latest times [ns] up to each of them."""

    def __init__(self, stream: Iterator[Rows]) -> None:
        self._stream, self._rows, self.keys = stream, np.zeros(0, dtype=FRAME), np.zeros(0, dtype=np.int64)
        self._latest = -LATEST

    def fill(self) -> bool:
        """Read on where there are no rows; return False where there are no more."""
        while not len(self._rows):
            found = next(self._stream, None)
            if found is None:
                return False
            self._rows = found
            self.keys = np.maximum.accumulate(np.maximum(found["time"], self._latest))
        self._latest = int(self.keys[-1])
        return True

    def taken(self, until: int) -> tuple[NDArray[np.int64], Rows]:
        """Return keys and rows up to a key, and keep the others."""
        n = int(np.searchsorted(self.keys, until, side="right"))
        found = self.keys[:n], self._rows[:n]
        self.keys, self._rows = self.keys[n:], self._rows[n:]
        return found


def _frames(mdf: Any, group: int, name: str, stretch: int) -> Iterator[Rows]:
    """Yield the frames of one group of channels, a stretch at a time."""
    resolution = _resolution(mdf, group)
    for start in range(0, mdf.groups[group].channel_group.cycles_nr, stretch):
        found = mdf.get(name, group, record_offset=start, record_count=stretch, raw=True)
        times = np.asarray(found.timestamps, dtype=np.float64)
        bad = np.flatnonzero(~(np.abs(times) < LATEST / 1e9))
        if len(bad):
            place = start + int(bad[0]) + 1
            raise ValueError(f"frame {place} of group {group + 1}: its time is {times[bad[0]]} s")
        rows = np.zeros(len(times), dtype=FRAME)
        rows["time"], rows["resolution"] = np.rint(times * 1e9), resolution
        rows["place"] = np.arange(start + 1, start + 1 + len(times))
        rows["kind"] = _KINDS[name]
        _fill(rows, found.samples, name)
        yield rows


def _resolution(mdf: Any, group: int) -> int:
    """Return the nanoseconds that one unit of a group's times is, 1 where they are doubles."""
    number = mdf.masters_db.get(group)
    if number is None:
        return 1
    master = mdf.groups[group].channels[number]
    unit = getattr(master.conversion, "a", None)  # of a linear one
    if master.data_type > _INTEGERS or not isinstance(unit, float) or not 0.0 < unit < 1.0:
        return 1
    return max(1, round(unit * 1e9))


def _fill(rows: Rows, samples: Any, name: str) -> None:
    """Write channels, identifiers and data of the samples of a group into rows."""
    fields = samples.dtype.names or ()

    def column(field: str, instead: int) -> NDArray[np.int64]:
        full = f"{name}.{field}"
        return samples[full].astype(np.int64) if full in fields else np.full(len(rows), instead)

    key = column("ID", 0)
    rows["frame_id"], rows["channel"] = key & _ID, column("BusChannel", 1)
    rows["extended"] = (column("IDE", 0) != 0) | (key & _EXTENDED != 0)
    if _KINDS[name] != DATA:
        return
    lengths = column("DataLength", 0)
    data = np.ascontiguousarray(samples[f"{name}.DataBytes"], dtype=np.uint8).reshape(len(rows), -1)
    width = min(data.shape[1], MOST_BYTES)
    if lengths.max(initial=0) > width:
        raise ValueError(f"a frame of {lengths.max()} bytes")
    rows["length"] = lengths
    rows["data"][:, :width] = np.where(np.arange(width) < lengths[:, None], data[:, :width], 0)


def records_of(blocks: Iterable[Rows], out: BinaryIO) -> None:
    """Write frames as records, and the one that ends them."""
    for rows in blocks:
        out.write(rows.tobytes())
        out.flush()
    last = np.zeros(1, dtype=FRAME)
    last["kind"] = END
    out.write(last.tobytes())
    out.flush()


def main() -> None:
    """Write the records of the file that the command line names; exit with UNREAD where it is damaged."""
    logging.disable(logging.CRITICAL)
    with contextlib.suppress(ImportError, ValueError, OSError):  # elsewhere, or the limit is lower already
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    try:
        records_of(frames_of(Path(sys.argv[1])), sys.stdout.buffer)
    except Exception as error:  # a stranger's bytes: the library raises whatever its parsing comes across
        said = str(error).partition("\n")[0][:120]
        print(f"{type(error).__name__}: {said}", file=sys.stderr, flush=True)
        os._exit(UNREAD)  # at once: what was opened in part would print a traceback when it is forgotten


if __name__ == "__main__":
    main()
