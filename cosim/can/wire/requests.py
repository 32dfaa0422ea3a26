"""The frames that are not sent at each cycle: whether one is wanted, from the raw values at hand.

A request is kept while the least interval since the last frame has not passed; the frame then has the values
of the moment at which it is sent. Counters and checksums are filled later, so that they are no change.
"""

from __future__ import annotations

from . import tables as T
from .tables import Wire


def wanted(w: Wire, i: int, k: int) -> int:
    """Return 1 if message i, whose signals have been sampled, is sent in step k, else 0."""
    m = w.messages
    kind, changed = m[i, T.SEND_TYPE], differs(w, i)
    due = kind == T.ON_WRITE or (kind == T.MIXED and (k - m[i, T.FIRST]) % m[i, T.CYCLE] == 0)
    if due or (kind != T.IF_ACTIVE and changed):
        m[i, T.ASKED] = 1
    elif kind == T.IF_ACTIVE:
        look_active(w, i, k)
    if m[i, T.ASKED] == 0 or k < m[i, T.NEXT_STEP]:
        return 0
    m[i, T.ASKED], m[i, T.NEXT_STEP] = 0, k + m[i, T.INTERVAL]
    return 1


def differs(w: Wire, i: int) -> int:
    """Return 1 if a signal of message i has another raw value than at the last look, or this is the first."""
    found = 0 if w.messages[i, T.LOOKED] else 1
    w.messages[i, T.LOOKED] = 1
    first = w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        low, high = w.signals[j, T.LOW], w.signals[j, T.HIGH]
        if low != w.signals[j, T.BEFORE_LOW] or high != w.signals[j, T.BEFORE_HIGH]:
            found = 1
        w.signals[j, T.BEFORE_LOW], w.signals[j, T.BEFORE_HIGH] = low, high
    return found


def look_active(w: Wire, i: int, k: int) -> None:
    """Ask for a frame of message i in step k if it became active, or inactive, or its cycle is over."""
    m, active = w.messages, 0
    first = m[i, T.FIRST_SIGNAL]
    for j in range(first, first + m[i, T.SIGNALS]):
        if (
            w.signals[j, T.LOW] != w.signals[j, T.IDLE_LOW]
            or w.signals[j, T.HIGH] != w.signals[j, T.IDLE_HIGH]
        ):
            active = 1
    if active != m[i, T.ACTIVE]:
        m[i, T.ACTIVE], m[i, T.PHASE] = active, k
        m[i, T.ASKED] = 1
    elif active and (k - m[i, T.PHASE]) % m[i, T.CYCLE] == 0:
        m[i, T.ASKED] = 1
