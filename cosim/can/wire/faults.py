"""Faults of a run, looked up when a frame is sent and when it is received.

A fault hits frames that are sampled in its time, of a message or of all messages of a node: each `EVERY`-th,
with its probability, and no more than LEFT. It counts and draws by itself: what others do to a frame changes
neither, and a frame that several hit counts for each of them.
"""

from __future__ import annotations

from ..timing.draws import drawn
from . import tables as T
from .arbitration import number_of
from .payload import low_bits
from .protect import protect, wipe
from .tables import Wire

_FAULT = 3  # what is drawn for


def hit(w: Wire, kind: int, i: int, now: int) -> int:
    """Return the first fault of a kind that hits the frame of message i sampled at a time; -1: none does.

    All that do count it.
    """
    found = -1
    for row in range(w.state[T.FAULTS]):
        if w.faults[row, T.FAULT_KIND] == kind and strikes(w, row, i, now) and found < 0:
            found = row
    return found


def strikes(w: Wire, row: int, i: int, now: int) -> bool:
    """Return True if the fault of a row hits the frame of message i sampled at a time, which it counts."""
    m, f = w.messages, w.faults
    if not f[row, T.SINCE_TIME] <= now < f[row, T.UNTIL_TIME]:
        return False
    by_key = f[row, T.FAULT_BUS] == m[i, T.BUS] and f[row, T.FAULT_KEY] == m[i, T.KEY]
    if not by_key and f[row, T.FAULT_NODE] != m[i, T.NODE]:
        return False
    f[row, T.MET] += 1
    if f[row, T.LEFT] == 0 or (f[row, T.MET] - 1) % f[row, T.EACH]:
        return False
    name = w.buses[m[i, T.BUS], T.NAME]
    purpose = _FAULT | f[row, T.FAULT_KIND] << 8 | f[row, T.FAULT_NUMBER] << 16
    if drawn(f[row, T.FAULT_SEED], name, number_of(w, i), f[row, T.MET], purpose) >= w.odds[row]:
        return False
    f[row, T.HITS] += 1
    if f[row, T.LEFT] > 0:
        f[row, T.LEFT] -= 1
    return True


def spoil(w: Wire, i: int, now: int, k: int) -> int:
    """Protect the frame at hand, of message i, and do what faults of its sender do to it.

    A frozen frame is the last one before; unless its counter is frozen too, that goes on. Return DONE
    or RAISED.
    """
    frozen = hit(w, T.FREEZE, i, now) if w.messages[i, T.KEPT] else -1
    if frozen >= 0:
        for byte in range(w.messages[i, T.LENGTH]):
            w.frame[byte] = w.kept[i, byte]
        if w.messages[i, T.PROFILE] and not w.faults[frozen, T.COUNTER_TOO]:
            m = w.messages
            wipe(w, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
            if protect(w, i, k) != T.DONE:
                return T.RAISED
    else:
        if protect(w, i, k) != T.DONE:
            return T.RAISED
        w.messages[i, T.KEPT] = 1
        for byte in range(w.messages[i, T.LENGTH]):
            w.kept[i, byte] = w.frame[byte]
    corrupt(w, i, now)
    return T.DONE


def spoil_logged(w: Wire, i: int, now: int, k: int) -> int:
    """Do to the frame at hand, of message i of a log, what faults of its sender would have done to it.

    A frozen frame has the payload of the last one; unless its counter is frozen too, its own counter. Return
    DONE or RAISED.
    """
    m = w.messages
    frozen = hit(w, T.FREEZE, i, now) if m[i, T.KEPT] else -1
    counter = low_bits(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
    for byte in range(m[i, T.LENGTH]):
        if frozen >= 0:
            w.frame[byte] = w.kept[i, byte]
        else:
            w.kept[i, byte] = w.frame[byte]
    m[i, T.KEPT] = 1
    if frozen >= 0 and m[i, T.PROFILE] and not w.faults[frozen, T.COUNTER_TOO]:
        wipe(w, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
        m[i - m[i, T.PAGE], T.COUNTER] = counter
        if protect(w, i, k) != T.DONE:
            return T.RAISED
    corrupt(w, i, now)
    return T.DONE


def corrupt(w: Wire, i: int, now: int) -> None:
    """Flip the bits of the frame at hand, of message i, that a fault at this time flips."""
    for row in range(w.state[T.FAULTS]):  # each has a byte of its own
        at = w.faults[row, T.BYTE]
        wrong = w.faults[row, T.FAULT_KIND] == T.CORRUPT and strikes(w, row, i, now)
        if wrong and at < w.messages[i, T.LENGTH]:
            w.frame[at] ^= w.faults[row, T.MASK]
