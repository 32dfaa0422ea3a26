"""Frames of a node that babbles: it sends one identifier at a period, or whenever the bus is idle.

Its frames are rows of messages that nobody samples and nobody receives; the time of a fault is theirs.
"""

from __future__ import annotations

from . import tables as T
from .tables import Wire


def begin(w: Wire, bus: int, end: int) -> None:
    """Let the faults of a bus babble that begin before a time."""
    m, first = w.messages, w.buses[bus, T.FIRST_MESSAGE]
    for i in range(first, first + w.buses[bus, T.MESSAGES]):
        row = m[i, T.BABBLES] - 1
        if row >= 0 and w.faults[row, T.MET] == 0 and w.faults[row, T.SINCE_TIME] < end:
            w.faults[row, T.MET] = 1
            w.buses[bus, T.TO_BABBLE] -= 1
            wait(w, i, w.faults[row, T.SINCE_TIME])


def wait(w: Wire, i: int, since: int) -> None:
    """Let the next frame of a fault wait for the bus, if the fault lasts until then."""
    m = w.messages
    if since < w.faults[m[i, T.BABBLES] - 1, T.UNTIL_TIME]:
        m[i, T.QUEUED] = 1
        m[i, T.SINCE] = m[i, T.SAMPLED] = since
        m[i, T.SENT] += 1
        w.buses[m[i, T.BUS], T.PENDING] += 1


def ended(w: Wire, i: int, now: int) -> int:
    """Return 1 if message i babbles, and does no more; its frame waits no longer then."""
    m = w.messages
    if m[i, T.BABBLES] == 0 or now < w.faults[m[i, T.BABBLES] - 1, T.UNTIL_TIME]:
        return 0
    m[i, T.QUEUED] = 0
    w.buses[m[i, T.BUS], T.PENDING] -= 1
    return 1


def go_on(w: Wire, i: int) -> None:
    """Count a frame that was carried, and let the next one wait.

    Newer ones took the place of one that waited for longer than a period.
    """
    m, row, bus = w.messages, w.messages[i, T.BABBLES] - 1, w.messages[i, T.BUS]
    period = w.faults[row, T.AMOUNT]
    w.faults[row, T.HITS] += 1
    if period == 0:
        wait(w, i, w.buses[bus, T.FREE_AT])
        return
    newer = (w.buses[bus, T.BEGUN] - m[i, T.SAMPLED]) // period
    m[i, T.REPLACED] += newer
    m[i, T.SENT] += newer
    wait(w, i, m[i, T.SAMPLED] + (newer + 1) * period)
