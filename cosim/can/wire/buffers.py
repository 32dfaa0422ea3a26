"""The two buffers of a message: of the frame that waits for the bus, and of one that is not queued yet.

A jitter lets some time pass from the sampling of a frame to its place in the queue, and until then the frame
before it waits on, may have the bus, or contend anew after an error. It is queued before the next one is
sampled, since a jitter is less than the time between two. Without a jitter a frame waits at once.
"""

from __future__ import annotations

from . import tables as T
from .tables import Wire

NEVER = 0x7FFFFFFFFFFFFFFF


def enter(w: Wire, i: int, sampled: int, since: int) -> None:
    """Let a frame of message i wait for the bus from a time on, in place of one that waits already.

    Its payload is the caller's to write.
    """
    m = w.messages
    if m[i, T.QUEUED]:
        m[i, T.REPLACED] += 1
    else:
        if m[i, T.PAGES] > 1:
            replace_pages(w, i)
        m[i, T.QUEUED] = 1
        w.buses[m[i, T.BUS], T.PENDING] += 1
    m[i, T.SAMPLED], m[i, T.SINCE] = sampled, since


def replace_pages(w: Wire, i: int) -> None:
    """Take another page of the message that still waits out of the buffer, which message i gets."""
    m = w.messages
    for j in range(i - m[i, T.PAGE], i - m[i, T.PAGE] + m[i, T.PAGES]):
        if m[j, T.QUEUED]:
            m[j, T.QUEUED] = 0
            m[j, T.REPLACED] += 1
            w.buses[m[i, T.BUS], T.PENDING] -= 1


def stage(w: Wire, i: int, sampled: int, since: int) -> None:
    """Keep the frame at hand, of message i, until it is queued at a time."""
    m, bus = w.messages, w.messages[i, T.BUS]
    m[i, T.STAGED], m[i, T.STAGED_SAMPLED], m[i, T.STAGED_SINCE] = 1, sampled, since
    for byte in range(m[i, T.LENGTH]):
        w.staged[i, byte] = w.frame[byte]
    w.buses[bus, T.PENDING] += 1
    w.buses[bus, T.NEXT_QUEUED] = min(w.buses[bus, T.NEXT_QUEUED], since)


def admit(w: Wire, bus: int, now: int) -> None:
    """Queue the frames of a bus that are to be queued by a time, each at its own."""
    m, b, first, following = w.messages, w.buses, w.buses[bus, T.FIRST_MESSAGE], NEVER
    for i in range(first, first + b[bus, T.MESSAGES]):
        if m[i, T.STAGED]:
            if m[i, T.STAGED_SINCE] <= now:
                m[i, T.STAGED] = 0
                b[bus, T.PENDING] -= 1
                enter(w, i, m[i, T.STAGED_SAMPLED], m[i, T.STAGED_SINCE])
                for byte in range(m[i, T.LENGTH]):
                    w.waiting[i, byte] = w.staged[i, byte]
            else:
                following = min(following, m[i, T.STAGED_SINCE])
    b[bus, T.NEXT_QUEUED] = following
