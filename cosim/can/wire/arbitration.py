"""The bus: who of those that wait starts when it is idle, the bits of the frame, and what noise does to it.

A wrong bit is seen by the sender at once and by all others before the error flag ends, so that the flags of
both take 12 bits; the delimiter takes 8. The frame waits on, and contends anew. The sender's error counter
(TEC) grows by 8, and falls by 1 with each frame that is carried; those of the receivers (REC) grow and fall
by 1, from above 127 to 127. Beyond 127 in one of them a node is error passive: after a frame of its own it
lets 8 bits pass before the next. With a TEC beyond 255 it is bus-off (`off`), and begins again with counters
of 0.
"""

from __future__ import annotations

from ..timing.draws import drawn
from ..timing.lengths import INTERFRAME, classic_bits, fd_bits
from . import tables as T
from .babble import ended
from .buffers import NEVER, admit
from .off import is_off, recover, strike, switch_off
from .tables import Wire

_ERROR = 2  # what is drawn for
_ERROR_FRAME = 20  # bits of the flags of all nodes and the delimiter
_TAIL = 9  # bits behind those that may have the data bit rate
_SUSPENDED = 8
_PASSIVE, _OFF = 127, 255


def contend(w: Wire, bus: int, end: int) -> int:
    """Let the next frame have the bus that starts before a time; return its message, -1 for none.

    It is the frame at hand then, and the bus is free after it. For one that ends with a wrong bit, return
    -2 - its message: it waits on.
    """
    b = w.buses
    now = b[bus, T.FREE_AT]
    while now < end:
        if b[bus, T.NEXT_QUEUED] <= now:
            admit(w, bus, now)
        i, soonest = first_of(w, bus, now)
        if i < 0:
            now = min(soonest, b[bus, T.NEXT_QUEUED])
            continue
        if (b[bus, T.STRIKES] and strike(w, bus, now)) or ended(w, i, now):
            now = b[bus, T.FREE_AT]
            continue
        for byte in range(w.messages[i, T.LENGTH]):
            w.frame[byte] = w.waiting[i, byte]
        b[bus, T.BEGUN], b[bus, T.BEGUN_BY] = now, i
        good = carry(w, bus, i, now)
        if not good:
            return -2 - i
        w.messages[i, T.QUEUED] = 0
        b[bus, T.PENDING] -= 1
        return i
    return -1


def first_of(w: Wire, bus: int, now: int) -> tuple[int, int]:
    """Return the message that wins the bus, which is idle at `now`, and `now`; -1: none may start yet.

    With it comes the time at which one may that waits.
    """
    m, first = w.messages, w.buses[bus, T.FIRST_MESSAGE]
    soonest = NEVER
    for i in range(first, first + w.buses[bus, T.MESSAGES]):
        if m[i, T.QUEUED]:
            since = max(m[i, T.SINCE], w.nodes[m[i, T.NODE], T.READY_AT])
            if since <= now:
                return i, now
            soonest = min(soonest, since)
    return -1, soonest


def carry(w: Wire, bus: int, i: int, now: int) -> int:
    """Send the frame at hand, of message i, from `now` on; return 1 if it is carried, 0 with a wrong bit."""
    m, b = w.messages, w.buses
    nominal, fast = bits_of(w, i)
    wrong = -1
    if b[bus, T.NOISY]:
        wrong = wrong_bit(w, bus, i, nominal + fast)
        count_errors(w, bus, m[i, T.NODE], wrong >= 0, now)
    if wrong < 0:
        b[bus, T.FREE_AT] = now + nominal * b[bus, T.BIT] + fast * b[bus, T.DATA_BIT]
    else:
        m[i, T.ERRORS] += 1
        head = nominal - _TAIL if fast else nominal
        quick = min(max(wrong + 1 - head, 0), fast)
        b[bus, T.FREE_AT] = (
            now + (wrong + 1 - quick + _ERROR_FRAME) * b[bus, T.BIT] + quick * b[bus, T.DATA_BIT]
        )
    b[bus, T.FREE_AT] += INTERFRAME * b[bus, T.BIT]
    m[i, T.BUSY] += b[bus, T.FREE_AT] - now
    if b[bus, T.OFF_NODES]:
        recover(w, bus, now)
    if max(w.nodes[m[i, T.NODE], T.ERROR_COUNT], w.nodes[m[i, T.NODE], T.RECEIVE_COUNT]) > _PASSIVE:
        suspend(w, bus, m[i, T.NODE])
    return 1 if wrong < 0 else 0


def bits_of(w: Wire, i: int) -> tuple[int, int]:
    """Return the bits of the frame at hand, of message i, at the nominal and at the data bit rate."""
    m = w.messages
    if m[i, T.FD]:
        return fd_bits(m[i, T.ID], m[i, T.EXTENDED], w.frame, 0, m[i, T.LENGTH], m[i, T.SWITCHED])
    return classic_bits(m[i, T.ID], m[i, T.EXTENDED], w.frame, 0, m[i, T.LENGTH]), 0


def wrong_bit(w: Wire, bus: int, i: int, bits: int) -> int:
    """Return the first bit of so many that is wrong, from 0 on; -1: all are right."""
    b, m = w.buses, w.messages
    attempt = m[i, T.CARRIED] + m[i, T.ERRORS]
    purpose = _ERROR | m[i, T.PAGE] << 8
    draw = drawn(b[bus, T.SEED], b[bus, T.NAME], number_of(w, i), attempt, purpose)
    if draw >= w.chances[bus, bits]:
        return -1
    bit = 0
    while draw >= w.chances[bus, bit + 1]:
        bit += 1
    return bit


def number_of(w: Wire, i: int) -> int:
    """Return the number of message i in draws, which no other has: bit 29 is set in extended frames."""
    number: int = w.messages[i, T.ID] | w.messages[i, T.EXTENDED] << 29
    return number


def count_errors(w: Wire, bus: int, sender: int, wrong: int, now: int) -> None:
    """Count a frame that starts now in the error counters of all nodes that are on a bus."""
    for node in range(len(w.nodes)):
        if w.nodes[node, T.BUS_OF] == bus and not is_off(w, node, now):
            column = T.ERROR_COUNT if node == sender else T.RECEIVE_COUNT
            count = w.nodes[node, column]
            if wrong:
                count += 8 if node == sender else 1
            elif node == sender:
                count = max(0, count - 1)
            else:
                count = max(0, min(count, _PASSIVE + 1) - 1)
            w.nodes[node, column] = count


def suspend(w: Wire, bus: int, node: int) -> None:
    """Let a node that is error passive or bus-off wait after its frame."""
    free = w.buses[bus, T.FREE_AT]
    if w.nodes[node, T.ERROR_COUNT] > _OFF:
        switch_off(w, bus, node, free, free)
    else:
        w.nodes[node, T.READY_AT] = free + _SUSPENDED * w.buses[bus, T.BIT]
