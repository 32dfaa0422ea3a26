"""The log of frames, as rows of a table that Python empties when it is full."""

from __future__ import annotations

from . import tables as T
from .tables import Wire
from .values import ask


def log(w: Wire, i: int, k: int, end: int) -> int:
    """Add the frame at hand, of message i, which ends at a time, to the log; return DONE or RAISED."""
    if not w.messages[i, T.LOGGED]:
        return T.DONE
    if w.state[T.LOG_ROWS] == len(w.log) and ask(w, T.FLUSH, i, k) != T.DONE:
        return T.RAISED
    row, length = w.state[T.LOG_ROWS], w.messages[i, T.LENGTH]
    w.log[row, T.LOG_STEP], w.log[row, T.LOG_TIME], w.log[row, T.LOG_MESSAGE] = k, end, i
    for first in range(0, length, 8):
        word = 0
        for byte in range(first, min(first + 8, length)):
            top = 256 if byte - first == 7 and w.frame[byte] > 127 else 0  # the sign of 64 bits
            word |= (w.frame[byte] - top) << 8 * (byte - first)
        w.log[row, T.LOG_PAYLOAD + first // 8] = word
    w.state[T.LOG_ROWS] += 1
    return T.DONE


def log_error(w: Wire, i: int, k: int, end: int) -> int:
    """Add the error frame to the log that ends a frame of message i; return DONE or RAISED."""
    if not w.messages[i, T.LOGGED]:
        return T.DONE
    if log(w, i, k, end) != T.DONE:
        return T.RAISED
    w.log[w.state[T.LOG_ROWS] - 1, T.LOG_MESSAGE] = -1 - i
    return T.DONE
