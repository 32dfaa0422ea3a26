"""The frames of a log that are wanted, in order, and counts of all others.

The file is read once, many frames at a time, before the run; what is wanted is kept as rows of numbers, the
first ones in memory and the rest in a temporary file, so that a log may be larger than the memory.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import ConfigError
from ...row_store import RowStore, Table
from .reading.blocks import Block
from .reading.files import format_of, logged_blocks
from .reading.logged import DATA
from .variants import Key, Variant, Variants

TIME, CHANNEL, VARIANT, PAYLOAD = range(4)
"""Columns of the rows, int64: time [ns of the log], channel, variant, and from PAYLOAD on 8 bytes each of the
payload, as many as the longest message needs."""

_STRETCH = 4096


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
    back, in words. `variants` are those that the rows have the numbers of. `notes` are sentences on the log
    as a whole.
    """

    path: Path
    table: Table
    channels: tuple[str, ...]
    seen: Mapping[str, Mapping[Key, Seen]]
    backward: Mapping[str, str]
    spans: Mapping[str, Span]
    others: int
    variants: tuple[Variant, ...]
    notes: tuple[str, ...] = ()

    @property
    def first(self) -> int:
        """The time [ns] of the first frame with data, of any channel; 0 where there is none."""
        return min((span.first for span in self.spans.values()), default=0)

    def rows(self) -> Iterator[NDArray[np.int64]]:
        """Yield some rows at a time, shape (n, width), in the order of the file."""
        for start in range(0, self.table.shape[0], _STRETCH):
            yield self.table.rows(start, start + _STRETCH).view("<i8")

    def count(self, channel: str) -> int:
        """Return the number of frames with data of a channel."""
        return sum(each.frames for each in self.seen.get(channel, {}).values())


def recorded(path: Path, variants: Variants) -> Recording:
    """Return the frames of a log that are of the messages and hold a signal that `variants` know.

    Raises ConfigError where the log cannot be read or kept.
    """
    form = format_of(path)
    width = PAYLOAD + variants.words
    store = RowStore(width, what=f"the frames of {path}", advice="a log of fewer frames needs less")
    tally = _Tally(variants, form.resolution, form.place)
    notes = []
    with logged_blocks(path) as blocks:
        for block in blocks:
            notes += [block.note] if block.note else []
            rows = tally.taken(block, width)
            if len(rows):
                store.append(rows.view("<f8"))
    return Recording(
        path, store.table(), tuple(tally.seen), tally.seen, tally.backward, tally.spans, tally.others,
        tuple(variants.found), tuple(notes),
    )  # fmt: skip # what was found


class _Tally:
    """Counts of the frames of a log up to now."""

    def __init__(self, variants: Variants, resolution: Callable[[int, int], int], place: str) -> None:
        self._variants, self._resolution, self._place = variants, resolution, place
        self._messages = variants.messages
        self._latest: dict[str, int] = {}
        self._numbers: dict[str, int] = {}
        self.seen: dict[str, dict[Key, Seen]] = {}
        self.spans: dict[str, Span] = {}
        self.backward: dict[str, str] = {}
        self.others = 0

    def taken(self, block: Block, width: int) -> NDArray[np.int64]:
        """Count the frames of a block, and return the rows of those that are wanted."""
        rows = block.rows
        data = rows["kind"] == DATA
        if not data.all():
            self.others += int(len(rows) - data.sum())
            rows = rows[data]
        variant = np.full(len(rows), -1, dtype=np.int64)
        channel = np.zeros(len(rows), dtype=np.int64)
        used, begins = np.unique(rows["channel"], return_index=True)
        for place in used[np.argsort(begins)].tolist():  # in the order in which they come up
            name = block.channels[place]
            own = slice(None) if len(used) == 1 else np.flatnonzero(rows["channel"] == place)
            self._note_times(name, rows[own])
            channel[own] = self._numbers.setdefault(name, len(self._numbers))
            variant[own] = self._counted(name, rows[own])
        kept = np.flatnonzero(variant >= 0)
        made = np.empty((len(kept), width), dtype=np.int64)
        made[:, TIME], made[:, CHANNEL], made[:, VARIANT] = rows["time"][kept], channel[kept], variant[kept]
        made[:, PAYLOAD:] = np.ascontiguousarray(rows["data"][kept, : 8 * (width - PAYLOAD)]).view("<i8")
        return made

    def _note_times(self, name: str, rows: NDArray[np.void]) -> None:
        times, resolutions = rows["time"], rows["resolution"]
        span = self.spans.setdefault(name, Span(int(times[0]), int(times[0]), int(resolutions[0])))
        span.first, span.last = min(span.first, int(times.min())), max(span.last, int(times.max()))
        for each in (int(resolutions.min()), int(resolutions.max())):
            span.resolution = self._resolution(span.resolution, each)
        before = np.concatenate(([self._latest.get(name, times[0])], times[:-1]))
        back = np.flatnonzero(times < before)
        if len(back) and name not in self.backward:
            i = int(back[0])
            self.backward[name] = (
                f"at {self._place} {rows['place'][i]} the time goes back from {_seconds(int(before[i]))} to "
                f"{_seconds(int(times[i]))}"
            )
        self._latest[name] = int(times[-1])

    def _counted(self, name: str, rows: NDArray[np.void]) -> NDArray[np.int64]:
        """Return the variants of frames of a channel, -1 for those that are not wanted."""
        of_channel = self.seen.setdefault(name, {})
        keys = rows["frame_id"].astype(np.int64) << 1 | rows["extended"]
        found, begins, which, counts = np.unique(
            keys, return_index=True, return_inverse=True, return_counts=True
        )
        variant = np.full(len(rows), -1, dtype=np.int64)
        for i in np.argsort(begins).tolist():
            key = int(found[i]) >> 1, bool(found[i] & 1)
            about = of_channel.setdefault(key, Seen())
            about.frames += int(counts[i])
            message = self._messages.get(key)
            if message is None:
                continue
            own = np.flatnonzero(which == i)
            lengths = rows["length"][own]
            short = lengths < message.length
            if short.any():
                about.short += int(short.sum())
                about.least = min(about.least, int(lengths.min()))
                own = own[~short]
            variant[own] = self._variants.numbers(key, rows["data"][own])
        return variant


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
