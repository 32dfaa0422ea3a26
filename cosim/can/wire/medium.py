"""The way of a frame from its sender to its receivers."""

from __future__ import annotations

from typing import Any

from . import tables as T
from .tables import Wire
from .values import ask, pack, sample, unpack


def send(w: Wire, i: int, k: int) -> int:
    """Sample and pack message i in step k, and send the frame; return DONE or RAISED."""
    if sample(w, i, k) != T.DONE:
        return T.RAISED
    pack(w, i)
    m, now = w.messages, k * w.state[T.STEP_TIME]
    m[i, T.SENT] += 1
    m[i, T.INSTANCE] += 1
    if log(w, i, k, now) != T.DONE:
        return T.RAISED
    if m[i, T.RING] < 0:
        return deliver(w, i, k, now, now)
    push(w, m[i, T.RING], i, now + w.buses[m[i, T.BUS], T.DELAY], now)
    return T.DONE


def arrive(w: Wire, ring: int, k: int) -> int:
    """Bring the frames of a ring that have arrived by step k to their receivers; return DONE or RAISED."""
    r, now = w.rings, k * w.state[T.STEP_TIME]
    while r[ring, T.COUNT] > 0:
        row = r[ring, T.START_ROW] + r[ring, T.HEAD]
        if w.flights[row, T.ARRIVAL] > now:
            break
        r[ring, T.HEAD] = (r[ring, T.HEAD] + 1) % r[ring, T.ROWS]
        r[ring, T.COUNT] -= 1
        i = w.flights[row, T.MESSAGE_OF]
        for byte in range(w.messages[i, T.LENGTH]):
            w.frame[byte] = w.flights[row, T.PAYLOAD + byte]
        if deliver(w, i, k, w.flights[row, T.SAMPLE_TIME], w.flights[row, T.ARRIVAL]) != T.DONE:
            return T.RAISED
    return T.DONE


def push(w: Wire, ring: int, i: int, arrival: int, sampled: int) -> None:
    """Let the frame at hand, of message i, be under way until its arrival."""
    r = w.rings
    row = r[ring, T.START_ROW] + (r[ring, T.HEAD] + r[ring, T.COUNT]) % r[ring, T.ROWS]
    r[ring, T.COUNT] += 1
    w.flights[row, T.MESSAGE_OF], w.flights[row, T.ARRIVAL] = i, arrival
    w.flights[row, T.SAMPLE_TIME] = sampled
    for byte in range(w.messages[i, T.LENGTH]):
        w.flights[row, T.PAYLOAD + byte] = w.frame[byte]


def deliver(w: Wire, i: int, k: int, sampled: int, arrival: int) -> int:
    """Give the frame at hand, of message i, to its receivers in step k; return DONE or RAISED."""
    m = w.messages
    note(m, i, T.LATENCY_LEAST, arrival - sampled)
    note(m, i, T.SEEN_LEAST, k * w.state[T.STEP_TIME] - sampled)
    m[i, T.ARRIVED] += 1
    return unpack(w, i, k)


def note(m: Any, i: int, least: int, time: int) -> None:
    """Add a time to three columns that follow each other: the least so far, the sum, and the most."""
    if m[i, T.ARRIVED] == 0 or time < m[i, least]:
        m[i, least] = time
    m[i, least + 1] += time
    if time > m[i, least + 2]:
        m[i, least + 2] = time


def log(w: Wire, i: int, k: int, end: int) -> int:
    """Add the frame at hand, of message i, which ends at a time, to the log; return DONE or RAISED."""
    if not w.messages[i, T.LOGGED]:
        return T.DONE
    if w.state[T.LOG_ROWS] == len(w.log) and ask(w, T.FLUSH, i, k) != T.DONE:
        return T.RAISED
    row = w.state[T.LOG_ROWS]
    w.log[row, T.LOG_STEP], w.log[row, T.LOG_TIME], w.log[row, T.LOG_MESSAGE] = k, end, i
    for byte in range(8 * ((w.messages[i, T.LENGTH] + 7) // 8)):
        if byte % 8 == 0:
            w.log[row, T.LOG_PAYLOAD + byte // 8] = 0
        if byte < w.messages[i, T.LENGTH]:
            signed = w.frame[byte] - (256 if byte % 8 == 7 and w.frame[byte] > 127 else 0)
            w.log[row, T.LOG_PAYLOAD + byte // 8] |= signed << 8 * (byte % 8)
    w.state[T.LOG_ROWS] += 1
    return T.DONE


def act(w: Wire, what: int, i: int, k: int) -> int:
    """Do an action of step k: SEND message i, or let the frames of ring i ARRIVE; return DONE or RAISED."""
    if what == T.SEND:
        return send(w, i, k)
    return arrive(w, i, k)
