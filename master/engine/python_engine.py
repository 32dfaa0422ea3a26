"""The python engine: one communication step after the other, each the actions of `schedule` in order."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from .engine import CHUNK_SECONDS, Engine
from .profile import part_of
from .routes import Act
from .schedule import Action


class PythonEngine(Engine):
    """The engine whose actions are Python functions."""

    name = "python"

    def _run(self, count: int, drives: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        first, width = self.k, int(self.columns.max(initial=-1)) + 1
        wide = np.empty((count, width))  # all slots up to the last recorded one: faster than picking them
        self._under_way = first, wide
        acts = self._acts(first, drives, wide)
        clock, end = time.perf_counter, time.perf_counter() + CHUNK_SECONDS
        ending = self.ending
        try:
            for k in range(first, first + count):
                # the actions of the schedule in order, each at the steps at which it is due
                for act in acts:
                    act(k)
                # the step is done: an error in a later one leaves its row
                self.k = k + 1
                # the caller looks at progress, events and Ctrl-C; a unit may have asked for the end
                if clock() > end or ending.step <= self.k:
                    break
        finally:
            np.take(wide[: self.k - first], self.columns, axis=1, out=rows[: self.k - first])

    def rows_under_way(self) -> NDArray[np.float64]:
        if (under_way := self._under_way) is None:
            return np.empty((0, len(self.columns)))
        first, wide = under_way
        return wide[: self.k - first, self.columns]

    def _acts(self, first: int, drives: NDArray[np.float64], wide: NDArray[np.float64]) -> list[Act]:
        """Return the functions of the schedule's actions for a chunk that begins at step `first`.

        `drives` has shape (drives, count); `wide`, shape (count, slots), receives the rows.
        """
        acts = [self._act_in_chunk(action, first, drives, wide) for action in self.schedule]
        acts = [_when_due(action, act) for action, act in zip(self.schedule, acts, strict=True)]
        if self.profile is None:
            return acts
        return [self._timed(action, act) for action, act in zip(self.schedule, acts, strict=True)]

    def _act_in_chunk(
        self, action: Action, first: int, drives: NDArray[np.float64], wide: NDArray[np.float64]
    ) -> Act:
        if action.kind == "drive":
            slot, values = self.plan.drives[action.index].sink, drives[action.index].tolist()
            view = self.view

            def drive(k: int) -> None:
                view[slot] = values[k - first]

            return drive
        if action.kind == "record":
            memory = self.memory[: wide.shape[1]]

            def record(k: int) -> None:
                wide[k - first] = memory

            return record
        return self.act(action)

    def _timed(self, action: Action, act: Act) -> Act:
        profile, part = self.profile, part_of(action, self.plan, apart=self.is_apart(action))
        assert profile is not None  # it is wanted

        def timed(k: int) -> None:
            begin = profile.clock()
            act(k)
            profile.add(part, profile.clock() - begin)

        return timed


def _when_due(action: Action, act: Act) -> Act:
    """Return a function that does the action at the steps at which it is due only."""
    if action.always:
        return act
    every, first = action.every, action.first

    def when_due(k: int) -> None:
        if k >= first and (k - first) % every == 0:
            act(k)

    return when_due
