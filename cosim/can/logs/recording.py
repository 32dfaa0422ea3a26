"""The frames of a log that are wanted, in order, and counts of all others.

The file is read once, frame by frame, before the run; what is wanted is kept as rows of numbers, the first
ones in memory and the rest in a temporary file, so that a log may be larger than the memory.
"""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import ConfigError
from ...row_store import RowStore, Table
from ..database import Message
from .reading.files import format_of, logged_frames
from .reading.logged import DATA, LoggedFrame

TIME, CHANNEL, VARIANT, PAYLOAD = range(4)
WIDTH = PAYLOAD + 8
"""Columns of the rows, int64: time [ns of the log], channel, variant, and the payload, 8 bytes each."""

_ROW = struct.Struct("<qqq64s")
_ROOM = 1 << 20  # bytes of rows between two writes
_STRETCH = 4096

Key = tuple[int, bool]
"""Identifier of a message, and True for an extended one."""


def key_of(message: Message) -> Key:
    """Return identifier and kind of a message."""
    return message.frame_id, message.extended


@dataclasses.dataclass
class Seen:
    """The numbers of frames of an identifier on a channel, and of those too short for the message."""

    frames: int = 0
    short: int = 0
    least: int = 64


@dataclasses.dataclass
class Span:
    """The times [ns] of the first and the last frame with data of a channel, exact to `resolution` [ns]."""

    first: int
    last: int
    resolution: int


@dataclasses.dataclass(frozen=True)
class Recording:
    """The wanted frames of a log, and what was seen of each identifier by channel.

    `spans` has the times of each channel. `backward` has for a channel the first place at which its time goes
    back, in words.
    """

    path: Path
    table: Table
    channels: tuple[str, ...]
    seen: Mapping[str, Mapping[Key, Seen]]
    backward: Mapping[str, str]
    spans: Mapping[str, Span]
    others: int

    @property
    def first(self) -> int:
        """The time [ns] of the first frame with data, of any channel; 0 where there is none."""
        return min((span.first for span in self.spans.values()), default=0)

    def rows(self) -> Iterator[NDArray[np.int64]]:
        """Yield some rows at a time, shape (n, WIDTH), in the order of the file."""
        for start in range(0, self.table.shape[0], _STRETCH):
            yield self.table.rows(start, start + _STRETCH).view("<i8")

    def count(self, channel: str) -> int:
        """Return the number of frames with data of a channel."""
        return sum(each.frames for each in self.seen.get(channel, {}).values())


def recorded(
    path: Path, lengths: Mapping[Key, int], variant: Callable[[Key, bytes], int | None]
) -> Recording:
    """Return what a log has of messages by identifier, each with its number of bytes.

    `variant` returns the number with which a frame's row is kept, None for a frame that is not kept. Raises
    ConfigError where the log cannot be read or kept.
    """
    form = format_of(path)
    store = RowStore(WIDTH, what=f"the frames of {path}", advice="a log of fewer frames needs less")
    seen: dict[str, dict[Key, Seen]] = {}
    numbers: dict[str, int] = {}
    backward: dict[str, str] = {}
    spans: dict[str, Span] = {}
    latest: dict[str, int] = {}
    others, rows = 0, bytearray()
    with logged_frames(path) as frames:
        for frame in frames:
            if frame.kind != DATA:
                others += 1
                continue
            time, channel, key = frame.time, frame.channel, (frame.frame_id, frame.extended)
            of_channel = seen.get(channel)
            if of_channel is None:
                of_channel = seen[channel] = {}
                numbers[channel] = len(numbers)
                spans[channel] = Span(time, time, frame.resolution)
                latest[channel] = time
            span = spans[channel]
            found = of_channel.get(key)
            if found is None:
                found = of_channel[key] = Seen()
            found.frames += 1
            span.first, span.last = min(span.first, time), max(span.last, time)
            span.resolution = form.resolution(span.resolution, frame.resolution)
            if time < latest[channel] and channel not in backward:
                backward[channel] = _backward(frame, latest[channel], form.place)
            latest[channel] = time
            length = lengths.get(key)
            if length is None:
                continue
            if len(frame.data) < length:
                found.short += 1
                found.least = min(found.least, len(frame.data))
                continue
            number = variant(key, frame.data)
            if number is not None:
                rows += _ROW.pack(time, numbers[channel], number, frame.data)
                if len(rows) >= _ROOM:
                    _keep(store, rows)
    _keep(store, rows)
    return Recording(path, store.table(), tuple(seen), seen, backward, spans, others)


def _keep(store: RowStore, rows: bytearray) -> None:
    """Move rows into the store, and leave none."""
    store.append(np.frombuffer(bytes(rows), "<f8").reshape(-1, WIDTH))
    rows.clear()


def _backward(frame: LoggedFrame, before: int, place: str) -> str:
    return f"at {place} {frame.place} the time goes back from {_seconds(before)} to {_seconds(frame.time)}"


def _seconds(nanoseconds: int) -> str:
    whole, rest = divmod(abs(nanoseconds), 10**9)
    return f"{'-' if nanoseconds < 0 else ''}{whole}.{rest:09d}".rstrip("0").rstrip(".") + " s"


def chosen_channel(recording: Recording, wanted: int | str | None, bus: str, place: str) -> str:
    """Return the channel of a log that is replayed: the wanted one, else the only one, else the bus' own.

    Raises ConfigError, which starts with `place`, with all channels where it is none of them.
    """
    there = ", ".join(f"{name} ({recording.count(name)} frames)" for name in recording.channels)
    if not recording.channels:
        raise ConfigError(f"{place}: {recording.path} has no frame with data")
    if wanted is not None:
        if str(wanted) not in recording.channels:
            raise ConfigError(
                f"{place}.channel: {recording.path} has no channel {wanted}; it has the channels {there}"
            )
        return str(wanted)
    if len(recording.channels) == 1:
        return recording.channels[0]
    if bus in recording.channels:
        return bus
    raise ConfigError(
        f"{place}: {recording.path} has several channels, and none is named {bus}: {there}; say which one "
        "with `channel`"
    )
