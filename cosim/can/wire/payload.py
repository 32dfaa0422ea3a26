"""Raw values in the bytes of a frame.

A raw value of up to 64 bits is two words: `low` has its 32 least significant bits, `high` the rest. The bits
that are written must be 0 before.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..database import Signal

_WORD = 32
_MASK = 0xFFFFFFFF


def put(frame: Any, little: int, start: int, bits: int, low: int, high: int) -> None:
    """Write a raw value of so many bits to a frame.

    `start` is the least significant bit where `little`, else the place of the most significant one counted
    from the first bit of the frame, which is bit 7 of byte 0.
    """
    if little:
        put_little(frame, start, min(bits, _WORD), low)
        if bits > _WORD:
            put_little(frame, start + _WORD, bits - _WORD, high)
    elif bits > _WORD:
        put_big(frame, start, bits - _WORD, high)
        put_big(frame, start + bits - _WORD, _WORD, low)
    else:
        put_big(frame, start, bits, low)


def put_little(frame: Any, start: int, bits: int, value: int) -> None:
    """Write the lowest bits of a value, 32 at most, from its least significant bit on (Intel)."""
    at, shift = start >> 3, start & 7
    rest = (value & ((1 << bits) - 1)) << shift
    while rest != 0:
        frame[at] |= rest & 255
        rest >>= 8
        at += 1


def put_big(frame: Any, start: int, bits: int, value: int) -> None:
    """Write the lowest bits of a value, 32 at most, from its most significant bit on (Motorola)."""
    end = start + bits
    at, shift = (end - 1) >> 3, (8 - (end & 7)) & 7
    rest = (value & ((1 << bits) - 1)) << shift
    while rest != 0:
        frame[at] |= rest & 255
        rest >>= 8
        at -= 1


def low_bits(frame: Any, little: int, start: int, bits: int) -> int:
    """Return the 32 least significant bits of a raw value, or fewer if it has no more."""
    if little:
        return take_little(frame, start, min(bits, _WORD))
    if bits > _WORD:
        return take_big(frame, start + bits - _WORD, _WORD)
    return take_big(frame, start, bits)


def high_bits(frame: Any, little: int, start: int, bits: int) -> int:
    """Return the bits of a raw value above the 32 least significant ones; 0 if it has no more."""
    if bits <= _WORD:
        return 0
    if little:
        return take_little(frame, start + _WORD, bits - _WORD)
    return take_big(frame, start, bits - _WORD)


def take_little(frame: Any, start: int, bits: int) -> int:
    """Return an unsigned value of 32 bits at most that begins with its least significant bit."""
    first, shift = start >> 3, start & 7
    value = 0
    for at in range((start + bits - 1) >> 3, first - 1, -1):
        value = value << 8 | frame[at]
    return (value >> shift) & ((1 << bits) - 1)


def take_big(frame: Any, start: int, bits: int) -> int:
    """Return an unsigned value of 32 bits at most that begins with its most significant bit."""
    end = start + bits
    value = 0
    for at in range(start >> 3, ((end - 1) >> 3) + 1):
        value = value << 8 | frame[at]
    return (value >> ((8 - (end & 7)) & 7)) & ((1 << bits) - 1)


def whole(low: int, high: int, bits: int, signed: int) -> int:
    """Return the number that a raw value stands for: in machine code one of 62 bits at most."""
    value = low | high << _WORD
    if signed and value >> (bits - 1):
        value -= 1 << bits
    return value


def words(value: int) -> tuple[int, int]:
    """Return the two words of a whole number."""
    return value & _MASK, (value >> _WORD) & _MASK


# ---- for Python alone


def place_of(signal: Signal) -> tuple[int, int]:
    """Return `start` of a signal, as `put` counts it, and 1 where it is `little`, else 0."""
    start = signal.start if signal.little_endian else 8 * (signal.start // 8) + 7 - signal.start % 8
    return start, int(signal.little_endian)


def raw_value(signal: Signal, frame: Sequence[int]) -> int:
    """Return the raw value of an integer signal in a payload."""
    (start, little), bits = place_of(signal), signal.length
    low, high = low_bits(frame, little, start, bits), high_bits(frame, little, start, bits)
    return whole(low, high, bits, signal.signed)
