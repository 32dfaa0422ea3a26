"""The frames of a log in the communication steps of a run.

A frame is seen at the first communication point at or after its time, as one that ends exactly at t_j is seen
at t_j. The times of a log are rounded, so that one counts as the point that it misses by that alone; of
several, where they are rounded to more than a step, as the nearest one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...clock import Clock, picoseconds
from ..wire import tables as T
from .recording import CHANNEL, PAYLOAD, TIME, VARIANT, Recording

_STRETCH = 1024
_LATEST = 2**62


@dataclasses.dataclass(frozen=True)
class Replayed:
    """The frames of one channel of a log, of which the run's clock shows 0 s at `offset` [ns of the log].

    They reach receivers `delay` [s] later. `messages`, shape (variants,), has the number of the message that
    a row's variant is of.
    """

    recording: Recording
    channel: str
    offset: int
    clock: Clock
    delay: float
    messages: NDArray[np.int64]

    def block(self, at: int) -> tuple[NDArray[np.int64], int]:
        """Return some frames from row `at` of the recording on, and the row behind them (-1: none is left).

        The frames have shape (n, LOG_WIDTH), with the columns of `wire.tables`' log: the step at which each
        is seen, its time [ps after the start], the number of the message, the payload.
        """
        table = self.recording.table
        while at < table.shape[0]:
            rows, at = table.rows(at, at + _STRETCH).view("<i8"), at + _STRETCH
            found = self._frames(rows)
            if len(found):
                return found, at if at < table.shape[0] else -1
        return np.empty((0, T.LOG_WIDTH), dtype=np.int64), -1

    def steps(self) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Yield variants and steps of some frames at a time, also of those before the start, shape (n,)."""
        for rows in map(self._own, self.recording.rows()):
            yield rows[:, VARIANT], self._timed(rows)[1]

    def _own(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        number = self.recording.channels.index(self.channel)
        found: NDArray[np.int64] = rows[rows[:, CHANNEL] == number]
        return found

    def _timed(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the times of rows [ps after the start] and the steps at which they are seen, shape (n,).

        A frame of a time before the start has the step -1, one that no run reaches a step that none has.
        """
        zero, rest = divmod(self.offset * 1000 + picoseconds(self.clock.start), 1000)  # in ns, exact
        if abs(zero) <= _LATEST:
            since = np.clip(rows[:, TIME] - zero, -_LATEST // 1000, _LATEST // 1000) * 1000 - rest
        else:  # no log has such a time
            since = np.full(len(rows), -_LATEST if zero > 0 else _LATEST, dtype=np.int64)
        resolution = self.recording.spans[self.channel].resolution * 1000  # in ps
        slack = min(resolution, picoseconds(self.clock.step)) // 2
        seen = (since + picoseconds(self.delay)) - slack
        clock = self.clock
        at = clock.start + seen * 1e-12
        step = np.ceil((at - clock.start) / clock.step)
        # the division rounds: the point before, or behind, may be the first that is not earlier
        step -= (clock.first + (step - 1) * clock.advance) / clock.divisor >= at
        step += (clock.first + step * clock.advance) / clock.divisor < at
        begun = since >= -slack
        return since, np.where(begun, np.maximum(step, 0), -1).astype(np.int64)

    def _frames(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        rows = self._own(rows)
        since, step = self._timed(rows)
        made = np.zeros((len(rows), T.LOG_WIDTH), dtype=np.int64)
        made[:, T.LOG_STEP], made[:, T.LOG_TIME] = step, since
        made[:, T.LOG_MESSAGE] = self.messages[rows[:, VARIANT]]
        made[:, T.LOG_PAYLOAD : T.LOG_PAYLOAD + rows.shape[1] - PAYLOAD] = rows[:, PAYLOAD:]
        return made[step >= 0]
