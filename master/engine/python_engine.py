"""The python engine: one communication step after the other, each the actions of `schedule` in order."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from .engine import CHUNK_SECONDS, Act, Engine
from .profile import part_of
from .schedule import Action


class PythonEngine(Engine):
    """See `Engine`."""

    name = "python"

    def _run(self, count: int, drives: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        first, width = self.k, int(self.columns.max(initial=-1)) + 1
        wide, memory = np.empty((count, width)), self.memory[:width]
        stimuli, view = [values.tolist() for values in drives], self.view

        def drive(slot: int, values: list[float]) -> Act:
            def act(k: int, time: float) -> None:
                view[slot] = values[k - first]

            return act

        def record(k: int, time: float) -> None:
            wide[k - first] = memory

        acts = [
            _when_due(
                action,
                record
                if action.kind == "record"
                else drive(self.plan.drives[action.index].sink, stimuli[action.index])
                if action.kind == "drive"
                else self.act(action),
            )
            for action in self.schedule
        ]
        if self.profile is not None:
            acts = [self._timed(*pair) for pair in zip(self.schedule, acts, strict=True)]
        clock, end = time.perf_counter, time.perf_counter() + CHUNK_SECONDS
        try:
            for k in range(first, first + count):
                now = self.time_at(k)
                for act in acts:
                    act(k, now)
                self.k = k + 1
                if clock() > end:
                    break
        finally:
            np.take(wide[: self.k - first], self.columns, axis=1, out=rows[: self.k - first])

    def _timed(self, action: Action, act: Act) -> Act:
        profile, part = self.profile, part_of(action, self.plan)
        assert profile is not None  # it is wanted

        def timed(k: int, time: float) -> None:
            begin = profile.clock()
            act(k, time)
            profile.add(part, profile.clock() - begin)

        return timed


def _when_due(action: Action, act: Act) -> Act:
    if action.always:
        return act
    every, first = action.every, action.first

    def when_due(k: int, time: float) -> None:
        if k >= first and (k - first) % every == 0:
            act(k, time)

    return when_due
