"""Frames of a log as columns of numbers, many at a time, so that logs of millions of frames are read."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .logged import MOST_BYTES, LoggedFrame

STRETCH = 1 << 14
"""Frames of a block that is made of single ones."""

_FIELDS = [
    ("time", "<i8"), ("place", "<i8"), ("resolution", "<i8"), ("frame_id", "<u4"), ("channel", "<i4"),
    ("extended", "?"), ("kind", "u1"), ("length", "u1"), ("data", "u1", (MOST_BYTES,)),
]  # fmt: skip # the columns
FRAME = np.dtype(_FIELDS)
"""The columns of a block: the fields of `LoggedFrame`; `channel` is a place in the block's names, and the
bytes of `data` behind `length` are 0."""


@dataclasses.dataclass(frozen=True)
class Block:
    """Some frames of a log in the order of the file, shape (n,) of FRAME, and the names of channels.

    `note` is a sentence on the log as a whole, in its last block.
    """

    rows: NDArray[Any]
    channels: Sequence[str]
    note: str = ""

    def frames(self) -> Iterator[LoggedFrame]:
        """Yield the frames one by one."""
        rows, payloads = self.rows, self.rows["data"].tobytes()
        names = ("time", "channel", "frame_id", "extended", "length", "place", "kind", "resolution")
        columns = [rows[name].tolist() for name in names]
        for i, (time, channel, key, extended, length, place, kind, resolution) in enumerate(
            zip(*columns, strict=True)
        ):
            data = payloads[MOST_BYTES * i : MOST_BYTES * i + length]
            yield LoggedFrame(time, self.channels[channel], key, extended, data, place, kind, resolution)


class Channels:
    """The names of a log's channels in the order in which they come up, each with its place."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self._places: dict[str, int] = {}

    def place(self, name: str) -> int:
        """Return the place of a name, which is added where it is new."""
        if name not in self._places:
            self._places[name] = len(self.names)
            self.names.append(name)
        return self._places[name]


def set_frame(rows: NDArray[Any], i: int, frame: LoggedFrame, channels: Channels) -> None:
    """Write a frame into row i of a block."""
    row = rows[i]
    row["time"], row["place"], row["resolution"] = frame.time, frame.place, frame.resolution
    row["frame_id"], row["channel"] = frame.frame_id, channels.place(frame.channel)
    row["extended"], row["kind"], row["length"] = frame.extended, frame.kind, len(frame.data)
    row["data"] = np.frombuffer(frame.data.ljust(MOST_BYTES, b"\0"), dtype=np.uint8)


def blocks_of(frames: Iterable[LoggedFrame]) -> Iterator[Block]:
    """Yield single frames as blocks."""
    left, channels = iter(frames), Channels()
    while some := list(itertools.islice(left, STRETCH)):
        rows = np.zeros(len(some), dtype=FRAME)
        for name in ("time", "place", "resolution", "frame_id", "extended", "kind"):
            rows[name] = [getattr(frame, name) for frame in some]
        rows["channel"] = [channels.place(frame.channel) for frame in some]
        rows["length"] = [len(frame.data) for frame in some]
        payloads = b"".join(frame.data.ljust(MOST_BYTES, b"\0") for frame in some)
        rows["data"] = np.frombuffer(payloads, dtype=np.uint8).reshape(-1, MOST_BYTES)
        yield Block(rows, channels.names)
