"""Values in and out of a frame: sampled, quantized and packed when sent, unpacked and decoded when received.

The arithmetic is that of `quantization`, bit for bit: see there for its steps.
"""

from __future__ import annotations

import math

from . import tables as T
from .payload import high_bits, low_bits, put, whole, words
from .tables import Wire

_HALF = 0.49999999999999994  # the greatest double below 0.5, which would round itself up
_WHOLE = 6755399441055744.0  # doubles from 2**52 on are whole, so a sum is rounded, a half to the even one


def ask(w: Wire, what: int, i: int, k: int) -> int:
    """Let Python do what no table holds; return DONE or RAISED. In machine code another function does it."""
    answer: int = w.helper(what, i, k)
    return answer


def sample(w: Wire, i: int, k: int) -> int:
    """Set the raw values of all signals of message i to those of step k; return DONE or RAISED."""
    first = w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        x = w.reals[j, T.IN_SCALE] * w.memory[w.signals[j, T.SOURCE]] + w.reals[j, T.IN_ADD]
        if w.reals[j, T.LEAST] <= x <= w.reals[j, T.GREATEST]:
            if w.signals[j, T.KIND] == T.EXACT:
                w.double[0] = x
                if ask(w, T.RAW, j, k) != T.DONE:
                    return T.RAISED
            else:
                set_raw(w, j, (x - w.reals[j, T.OFFSET]) / w.reals[j, T.SCALE])
        elif w.signals[j, T.SATURATES] and w.signals[j, T.KIND] != T.EXACT and x == x:
            if w.signals[j, T.TIMES] == 0:
                w.signals[j, T.FIRST_TIME] = k
            w.signals[j, T.TIMES] += 1
            set_raw(w, j, w.reals[j, T.ABOVE] if x > w.reals[j, T.GREATEST] else w.reals[j, T.BELOW])
        else:
            w.double[0] = x
            if ask(w, T.RAW, j, k) != T.DONE:
                return T.RAISED
    return T.DONE


def set_raw(w: Wire, j: int, q: float) -> None:
    """Round the quotient q of signal j, and set the words of its raw value."""
    kind = w.signals[j, T.KIND]
    if kind == T.FLOAT32:
        w.single[0] = q
        w.signals[j, T.LOW], w.signals[j, T.HIGH] = words(w.single_bits[0])
    elif kind == T.FLOAT64:
        w.double[0] = q
        w.signals[j, T.LOW], w.signals[j, T.HIGH] = words(w.double_bits[0])
    else:
        w.signals[j, T.LOW], w.signals[j, T.HIGH] = words(rounded(q, kind))


def rounded(q: float, kind: int) -> int:
    """Return a whole number near q, by the rounding of a kind."""
    if kind == T.HALF_EVEN:
        return int(q + _WHOLE - _WHOLE)
    half = _HALF if kind == T.NEAREST else 0.0
    if q >= 0.0:
        return math.floor(q + half)
    return -math.floor(half - q)


def pack(w: Wire, i: int) -> None:
    """Set the frame at hand to the payload of message i."""
    for byte in range(w.messages[i, T.LENGTH]):
        w.frame[byte] = w.base[i, byte]
    first = w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        put(
            w.frame, w.signals[j, T.LITTLE], w.signals[j, T.START], w.signals[j, T.BITS],
            w.signals[j, T.LOW], w.signals[j, T.HIGH],
        )  # fmt: skip # a table's columns


def unpack(w: Wire, i: int, k: int) -> int:
    """Write the values of the frame at hand, of message i, to those that take it; return DONE or RAISED."""
    alone, first = w.messages[i, T.LISTENERS] == 1, w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        if w.signals[j, T.SINKS]:
            little, start, bits = w.signals[j, T.LITTLE], w.signals[j, T.START], w.signals[j, T.BITS]
            low, high = low_bits(w.frame, little, start, bits), high_bits(w.frame, little, start, bits)
            kind = w.signals[j, T.KIND]
            if kind == T.EXACT:
                w.signals[j, T.LOW], w.signals[j, T.HIGH] = low, high
                if ask(w, T.VALUE, j, k) != T.DONE:
                    return T.RAISED
                value = w.double[0]
            else:
                raw = raw_number(w, kind, low, high, bits, w.signals[j, T.SIGNED])
                value = raw * w.reals[j, T.SCALE] + w.reals[j, T.OUT_ADD]
            receive(w, j, value, alone)
    return T.DONE


def raw_number(w: Wire, kind: int, low: int, high: int, bits: int, signed: int) -> float:
    """Return the raw value that two words stand for, by the kind of its signal."""
    if kind == T.FLOAT32:
        w.single_bits[0] = low - (low >> 31 << 32)
        return float(w.single[0])
    if kind == T.FLOAT64:
        w.double_bits[0] = low | (high - (high >> 31 << 32)) << 32
        return float(w.double[0])
    return float(whole(low, high, bits, signed))


def receive(w: Wire, j: int, value: float, alone: bool) -> None:
    """Write a value of signal j, in the bus' unit, to its receivers that take the frame at hand.

    `alone`: all of them hear and judge frames alike.
    """
    first = w.signals[j, T.FIRST_SINK]
    for s in range(first, first + w.signals[j, T.SINKS]):
        if alone or w.listeners[w.sinks[s, T.LISTENER], T.TAKES]:
            w.memory[w.sinks[s, T.SLOT]] = w.maps[s, T.FACTOR] * value + w.maps[s, T.ADDEND]
