"""The raw values that a message's transmissions had: few in memory, more in a temporary file."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..row_store import RowStore, Table
from .database import Message
from .wire import tables as T

_MEMORY = 2**20  # bytes of each message that stay in memory
_STRETCH = 4096  # transmissions that are read at a time
_FRAMES, _ADVICE = "the frames of a bus", "a run that keeps no frames needs none"

Steps = NDArray[np.int64]
"""Communication steps of n transmissions, shape (n,)."""

Raws = dict[str, NDArray[Any]]
"""Raw values of n transmissions by signal, each of shape (n,)."""


@dataclasses.dataclass(frozen=True)
class RawLog:
    """The transmissions of a message: their communication steps, and each signal's raw values, one for each.

    The raw values of an integer signal are whole float64, or integers where those could not hold them:
    `types` has the type of each signal, in numpy's letters. The `table` has shape (transmissions, 1 +
    signals); a row is a step and the raw values, each the 8 bytes of its own type.
    """

    message: Message
    types: Mapping[str, str]
    table: Table

    @property
    def steps(self) -> Steps:
        """The steps of all transmissions."""
        return self._taken(0, len(self))[0]

    @property
    def raws(self) -> Raws:
        """The raw values of all transmissions."""
        return self._taken(0, len(self))[1]

    def __len__(self) -> int:
        return self.table.shape[0]

    def stretches(self) -> Iterator[tuple[Steps, Raws]]:
        """Yield steps and raw values of some transmissions at a time, in order."""
        for start in range(0, len(self), _STRETCH):
            yield self._taken(start, start + _STRETCH)

    def _taken(self, start: int, stop: int) -> tuple[Steps, Raws]:
        rows = self.table.rows(start, stop)
        raws = {name: rows[:, i].view(kind) for i, (name, kind) in enumerate(self.types.items(), start=1)}
        return rows[:, 0].view("<i8"), raws


@dataclasses.dataclass(frozen=True)
class FrameLog:
    """The frames of messages whose payloads were made in the run, in the order of their ends.

    A row of `table`, shape (frames, LOG_WIDTH), has the columns of `wire.tables`' log, each 8 bytes with an
    int64; the third is the number of a message. Those that are not in `messages` are not of this log. `sent`:
    units of the run have sent them.
    """

    messages: Mapping[int, Message]
    table: Table
    sent: bool = True

    def errors(self) -> Iterator[tuple[int, int, Message]]:
        """Yield of each error frame the step, the time of its end [ps], and the message that it ended."""
        for start in range(0, self.table.shape[0], _STRETCH):
            rows = self.table.rows(start, start + _STRETCH).view("<i8")
            for row in rows[rows[:, T.LOG_MESSAGE] < 0, : T.LOG_PAYLOAD].tolist():
                message = self.messages.get(-1 - row[T.LOG_MESSAGE])
                if message is not None:
                    yield row[T.LOG_STEP], row[T.LOG_TIME], message

    def frames(self) -> Iterator[tuple[int, int, Message, bytes]]:
        """Yield of each frame the step in which it was sent, the time of its end [ps], message, payload."""
        for start in range(0, self.table.shape[0], _STRETCH):
            rows = self.table.rows(start, start + _STRETCH).view("<i8")
            payloads = np.ascontiguousarray(rows[:, T.LOG_PAYLOAD :]).view(np.uint8)
            for row, payload in zip(rows[:, : T.LOG_PAYLOAD].tolist(), payloads, strict=True):
                message = self.messages.get(row[T.LOG_MESSAGE])
                if message is not None:
                    data = payload[: message.length].tobytes()
                    yield row[T.LOG_STEP], row[T.LOG_TIME], message, data


def frame_store() -> RowStore:
    """Return an empty store for the frames of a FrameLog."""
    return RowStore(T.LOG_WIDTH, _MEMORY, what=_FRAMES, advice=_ADVICE)


def raw_store(signals: int) -> RowStore:
    """Return an empty store for the transmissions of a message with so many signals."""
    return RowStore(1 + signals, _MEMORY, what=_FRAMES, advice=_ADVICE)
