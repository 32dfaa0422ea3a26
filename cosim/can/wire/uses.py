"""The steps of units in which values of frames are used for the first time: the delays that controllers have.

A value that a newer one replaces before its receiver has a turn is never used, and does not count.
"""

from __future__ import annotations

from typing import Any

from . import tables as T
from .tables import Wire


def note(m: Any, i: int, least: int, high: int, time: int, before: int) -> None:
    """Add a time to three columns that follow each other: the least so far, the sum, and the most.

    The sum is at most SUM; the column `high` counts how often that was taken out. `before` times were added
    already.
    """
    if before == 0 or time < m[i, least]:
        m[i, least] = time
    m[i, least + 1] += time
    if m[i, least + 1] > T.SUM:
        m[i, least + 1] -= T.SUM
        m[i, high] += 1
    if before == 0 or time > m[i, least + 2]:
        m[i, least + 2] = time


def use(w: Wire, i: int, k: int, sampled: int) -> None:
    """Let those that take a frame of message i use, in their next turns, the values that arrive in step k."""
    u, first, alone = w.uses, w.messages[i, T.FIRST_USE], w.messages[i, T.LISTENERS] == 1
    for row in range(first, first + w.messages[i, T.USES]):
        if not (alone or w.listeners[u[row, T.USER], T.TAKES]):
            continue
        wait = max(0, k + u[row, T.LATER] - u[row, T.FIRST_TURN])
        turn = (
            u[row, T.FIRST_TURN]
            + (wait + u[row, T.TURN_EVERY] - 1) // u[row, T.TURN_EVERY] * u[row, T.TURN_EVERY]
        )
        if turn != u[row, T.USED_AT]:
            count_use(w, row)
        u[row, T.USED_AT], u[row, T.USE_SAMPLED] = turn, sampled


def count_use(w: Wire, row: int) -> None:
    """Count the value that waits for the turn of a receiver, if any, as used."""
    u = w.uses
    if u[row, T.USED_AT] >= 0:
        time = u[row, T.USED_AT] * w.state[T.STEP_TIME] - u[row, T.USE_SAMPLED]
        note(u, row, T.USE_LEAST, T.USE_HIGH, time, u[row, T.USE_COUNT])
        u[row, T.USE_COUNT] += 1
