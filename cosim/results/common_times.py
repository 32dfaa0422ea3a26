"""The times at which two runs are compared: those of both, over the stretch that both cover.

Where one run has a time and the other has not, the other is interpolated: linearly between continuous values,
the previous value for what is held. So the first compared with the second is the second compared with the
first. What lies before or after that stretch in one run alone is counted, and said.
"""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..csv_text import as_date
from ..errors import counted
from ..row_store import Array

_SAME_TIME = 1e-9  # s: other tools print accumulated times, 0.29000000000000004 for 0.29
_OF_A_STEP = 0.01  # and of the usual step at most: steps may be as short as that

Side = Literal["first", "second"]


@dataclasses.dataclass(frozen=True)
class NotCompared:
    """The points of one run alone, before or after the stretch that both cover: from `begin` to `end` [s]."""

    side: Side
    points: int
    begin: float
    end: float

    def __str__(self) -> str:
        span = f"at {self.begin:.12g} s"
        if self.begin != self.end:
            span = f"from {self.begin:.12g} to {self.end:.12g} s"
        return f"{counted(self.points, 'point')} of the {self.side} {span}"


@dataclasses.dataclass(frozen=True)
class RowsAt:
    """The rows of one run at the compared times, shape (n,).

    Where it has none of its `own`, `rows` has the one before, whose values are held.
    """

    times: Array
    rows: NDArray[np.intp]
    own: NDArray[np.bool_]

    @property
    def interpolated(self) -> int:
        """The number of compared times that the run has not."""
        return int(np.count_nonzero(~self.own))

    def values(self, column: Array, held: bool, time: Array) -> Array:
        """Return the values of a column, shape (rows of the run,), at the compared times [s], shape (n,)."""
        found = column[self.rows]
        if not held and not self.own.all():
            found[~self.own] = np.interp(time[~self.own], self.times, column)
        return found

    def texts(self, column: NDArray[Any]) -> NDArray[Any]:
        """Return the texts of a column at the compared times, shape (n,)."""
        return column[self.rows]


@dataclasses.dataclass(frozen=True)
class CommonTimes:
    """The times [s] at which two runs are compared, shape (n,), the rows there, and what is left out."""

    time: Array
    first: RowsAt
    second: RowsAt
    not_compared: tuple[NotCompared, ...]
    remarks: tuple[str, ...]

    @property
    def same_span(self) -> bool:
        """True where both runs begin and end together."""
        return not self.not_compared

    @classmethod
    def of(cls, first: Array, second: Array) -> CommonTimes:
        """Return what two runs with these times [s] have in common; times never decrease, and may repeat.

        Rows of one time are paired in their order; the last one of a run stands for those that it lacks.
        """
        of_first, of_second = _groups(first, second)
        rows = _shared(of_first, of_second)
        in_first, in_second = (RowsAt(t, *r) for t, r in zip((first, second), rows, strict=True))
        time = np.empty(len(in_first.rows))
        time[in_second.own] = second[in_second.rows[in_second.own]]
        time[in_first.own] = first[in_first.rows[in_first.own]]
        left = (*_left("first", first, of_first, of_second), *_left("second", second, of_second, of_first))
        return cls(time, in_first, in_second, left, tuple(_remarks(first, second, in_first, in_second, left)))


def _groups(first: Array, second: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return for each time [s] of both runs its place, counted from 0, among the different times of both."""
    both = np.concatenate((first, second))
    order = np.argsort(both, kind="stable")
    places = np.empty(len(both), dtype=np.intp)
    places[order] = np.concatenate(([0], np.cumsum(np.diff(both[order]) > _tolerance(first, second))))[
        : len(both)
    ]
    return places[: len(first)], places[len(first) :]


def _tolerance(*times: Array) -> float:
    """Return how far apart two times [s] are one."""
    steps = np.concatenate([np.diff(each) for each in times])
    steps = steps[steps > 0.0]
    return min(_SAME_TIME, _OF_A_STEP * float(np.median(steps))) if len(steps) else _SAME_TIME


def _shared(
    first: NDArray[np.intp], second: NDArray[np.intp]
) -> list[tuple[NDArray[np.intp], NDArray[np.bool_]]]:
    """Return rows and `own` of both runs, as in RowsAt, by the places of their times."""
    nothing = np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.bool_)
    if not len(first) or not len(second):
        return [nothing, nothing]
    count = 1 + max(first[-1], second[-1])
    begin, end = max(first[0], second[0]), min(first[-1], second[-1])
    counts = [np.bincount(each, minlength=count) for each in (first, second)]
    repeats = np.maximum(*counts)[begin : end + 1]
    place = np.repeat(np.arange(begin, begin + len(repeats)), repeats)
    nth = np.arange(len(place)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    found = []
    for each in counts:
        before = (np.cumsum(each) - each)[place]  # rows of the run before this time
        own = each[place] > 0
        found.append((before + np.minimum(nth, each[place] - 1), own))  # -1 where it has none of its own
    return found


def _left(side: Side, times: Array, own: NDArray[np.intp], other: NDArray[np.intp]) -> list[NotCompared]:
    """Return what a run with these times [s] has before and after the other one, by the places of both."""
    outside = [times[own < other[0]], times[own > other[-1]]] if len(other) else [times]
    return [NotCompared(side, len(t), float(t[0]), float(t[-1])) for t in outside if len(t)]


def _remarks(
    first: Array, second: Array, in_first: RowsAt, in_second: RowsAt, left: tuple[NotCompared, ...]
) -> list[str]:
    if not len(first) or not len(second):
        return ["there is nothing to compare: a run has no points"]
    remarks = []
    alone = in_second.interpolated, in_first.interpolated
    if any(alone):
        remarks.append(
            f"the times differ: {alone[0]} are of the first alone and {alone[1]} of the second alone, where "
            "the other was interpolated (linear; held values: the previous one)"
        )
    elif not left and len(first) != len(second):
        remarks.append(
            f"the first has {counted(len(first), 'row')}, the second {len(second)}: of a time that one has "
            "more often, the last row of the other is taken"
        )
    if left:
        spans = [f"{t[0]:.12g} to {t[-1]:.12g} s" for t in (first, second)]
        remarks.append(f"the first goes from {spans[0]}, the second from {spans[1]}")
        dates = [as_date(float(t[0])) for t in (first, second)]
        if bool(dates[0]) != bool(dates[1]):
            side = "first" if dates[0] else "second"
            remarks.append(
                f"the times of the {side} look like {dates[0] or dates[1]}: write them in s from the start "
                "of the other on"
            )
        remarks.append(f"not compared: {', '.join(map(str, left))}")
    return remarks
