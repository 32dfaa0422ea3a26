"""The frames of a log of ASAM MDF 4, by asammdf, written to the standard output as records.

It is a program of its own, which `mf4` starts: the machine code of asammdf crashes on some damaged files, and
takes as much memory as they tell.
"""

from __future__ import annotations

import contextlib
import heapq
import logging
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE, LoggedFrame

RECORD = np.dtype(
    [
        ("time", "<i8"), ("place", "<i8"), ("id", "<u4"), ("channel", "<u4"),
        ("resolution", "<u4"), ("extended", "u1"),
        ("kind", "u1"), ("length", "u1"), ("end", "u1"), ("data", f"({MOST_BYTES},)u1"),
    ]
)  # fmt: skip # the fields of a frame
"""A frame; in the last record, which has none, `end` is 1."""
STRETCH = 20_000
"""Frames that are read, and written, at a time."""
UNREAD = 3
"""The exit code where the library cannot read the file; the reason stands on the standard error."""

_KINDS = {"CAN_DataFrame": DATA, "CAN_RemoteFrame": REMOTE, "CAN_ErrorFrame": ERROR}
_ID, _EXTENDED = 0x1FFFFFFF, 0x80000000
_INTEGERS = 3  # the greatest type of data that is an integer
_MEMORY = 8 << 30  # bytes of address space


def frames_of(path: Path, stretch: int = STRETCH) -> Iterator[LoggedFrame]:
    """Yield the frames in the order of time. Raises whatever the library does for a damaged file."""
    from asammdf import MDF

    with contextlib.closing(MDF(path)) as mdf:
        streams = [
            _frames(mdf, number, name, stretch)
            for number, group in enumerate(mdf.groups)
            for name in dict.fromkeys(channel.name for channel in group.channels)
            if name in _KINDS and group.channel_group.cycles_nr
        ]
        yield from heapq.merge(*streams, key=lambda frame: frame.time)


def _frames(mdf: Any, group: int, name: str, stretch: int) -> Iterator[LoggedFrame]:
    """Yield the frames of one group of channels, a stretch at a time."""
    resolution = _resolution(mdf, group)
    for start in range(0, mdf.groups[group].channel_group.cycles_nr, stretch):
        found = mdf.get(name, group, record_offset=start, record_count=stretch, raw=True)
        for time, channel, key, extended, data, number in _rows(found, name, start):
            if not abs(time) < LATEST / 1e9:
                raise ValueError(f"frame {number + 1} of group {group + 1}: its time is {time} s")
            far = extended or bool(key & _EXTENDED)
            place = number + 1
            yield LoggedFrame(
                round(time * 1e9), str(channel), key & _ID, far, data, place, _KINDS[name], resolution
            )


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


def _rows(found: Any, name: str, start: int) -> list[tuple[float, int, int, bool, bytes, int]]:
    """Return time [s], channel, identifier, extended or not, data and number of each frame."""
    samples, count = found.samples, len(found.timestamps)
    fields = samples.dtype.names or ()

    def column(field: str, instead: int) -> Any:
        full = f"{name}.{field}"
        return samples[full].tolist() if full in fields else [instead] * count

    data = [b""] * count
    if _KINDS[name] == DATA:
        lengths = column("DataLength", 0)
        payloads = np.ascontiguousarray(samples[f"{name}.DataBytes"], dtype=np.uint8).reshape(count, -1)
        width = payloads.shape[1]
        if max(lengths, default=0) > min(width, MOST_BYTES):
            raise ValueError(f"a frame of {max(lengths)} bytes")
        whole = payloads.tobytes()
        data = [whole[i * width : i * width + n] for i, n in enumerate(lengths)]
    return list(
        zip(
            found.timestamps.tolist(), column("BusChannel", 1), column("ID", 0), map(bool, column("IDE", 0)),
            data, range(start, start + count), strict=True,
        )
    )  # fmt: skip # the fields of a frame


def records_of(frames: Iterator[LoggedFrame], out: BinaryIO) -> None:
    """Write frames as records, and the one that ends them."""
    rows = np.zeros(STRETCH, dtype=RECORD)
    count = 0
    for frame in frames:
        rows[count] = (
            frame.time, frame.place, frame.frame_id, int(frame.channel), frame.resolution, frame.extended,
            frame.kind, len(frame.data), 0,
            np.frombuffer(frame.data.ljust(MOST_BYTES, b"\0"), dtype=np.uint8),
        )  # fmt: skip # a record
        count += 1
        if count == STRETCH:
            out.write(rows.tobytes())
            count = 0
    last = np.zeros(1, dtype=RECORD)
    last["end"] = 1
    out.write(rows[:count].tobytes() + last.tobytes())
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
