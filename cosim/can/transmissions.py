"""The transmissions of a message as they are kept: in memory while they are few, in a file beyond that."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..row_store import RowStore, Table
from .dbc import Message

_MEMORY = 2**20  # bytes of each message that stay in memory
_STRETCH = 4096  # transmissions that are read at a time

Steps = NDArray[np.int64]
Raws = dict[str, NDArray[Any]]


@dataclasses.dataclass(frozen=True)
class RawLog:
    """The transmissions of a message: their communication steps, and each signal's raw values, one for each.

    The raw values of an integer signal are whole float64, or integers where those could not hold them:
    `types` tells for each signal which, in numpy's letters. A row of the `table` is a step and the raw
    values, each the 8 bytes of its own type.
    """

    message: Message
    types: Mapping[str, str]
    table: Table

    @property
    def steps(self) -> Steps:
        """All steps, shape (transmissions,)."""
        return self._taken(0, len(self))[0]

    @property
    def raws(self) -> Raws:
        """All raw values by signal, each of shape (transmissions,)."""
        return self._taken(0, len(self))[1]

    def __len__(self) -> int:
        return self.table.shape[0]

    def stretches(self) -> Iterator[tuple[Steps, Raws]]:
        """Steps and raw values, some transmissions at a time."""
        for start in range(0, len(self), _STRETCH):
            yield self._taken(start, start + _STRETCH)

    def _taken(self, start: int, stop: int) -> tuple[Steps, Raws]:
        rows = self.table.rows(start, stop)
        raws = {name: rows[:, i].view(kind) for i, (name, kind) in enumerate(self.types.items(), start=1)}
        return rows[:, 0].view("<i8"), raws


def raw_store(signals: int) -> RowStore:
    """Where the transmissions of a message with so many signals are kept."""
    return RowStore(
        1 + signals, _MEMORY, what="the frames of a bus", advice="a run that keeps no frames needs none"
    )
