"""The lines of a large text as an array of bytes, and the numbers that stand in them, read in bulk.

A reader finds the lines that have the usual form of its format by arrays of places, and reads all others one
by one, which also says what is wrong in them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from .logged import LATEST, LONGEST_LINE, too_long

Places = NDArray[np.int64]
"""Places of bytes in a text, one for each of n lines, shape (n,)."""
Flags = NDArray[np.bool_]

_ROOM = 1 << 21  # bytes that are read at a time
_BEHIND = 256  # zeros behind the lines, so that a few more bytes can be looked at
NO_DIGIT = 255
_HEX = np.full(256, NO_DIGIT, dtype=np.uint8)
for _digit in "0123456789abcdefABCDEF":
    _HEX[ord(_digit)] = int(_digit, 16)
_DECIMAL = np.where(_HEX < 10, _HEX, NO_DIGIT).astype(np.uint8)


@dataclasses.dataclass(frozen=True)
class Lines:
    """Some whole lines of a text: `text` are their bytes, behind which some zeros stand.

    Line i is from `starts[i]` to before `ends[i]`, without what ends it; `first` is the number of the first.
    """

    text: NDArray[np.uint8]
    starts: Places
    ends: Places
    first: int

    def __len__(self) -> int:
        return len(self.starts)

    def line(self, i: int) -> str:
        """Return line i without spaces at its ends."""
        return self.text[self.starts[i] : self.ends[i]].tobytes().decode("utf-8", "replace").strip()

    def places(self, byte: str) -> Places:
        """Return where a character stands, in the order of the text, and at last a place behind all lines."""
        found = np.flatnonzero(self.text == ord(byte))
        return np.append(found, len(self.text) - _BEHIND)

    def next(self, places: Places, at: Places) -> Places:
        """Return of places in their order the first from `at` on, for each line."""
        found: Places = places[np.minimum(np.searchsorted(places, at), len(places) - 1)]
        return found


def lines_in_bulk(file: BinaryIO, path: Path) -> Iterator[Lines]:
    """Yield the lines of a file, many at a time. Raises ConfigError for one that is too long for a log."""
    rest, first = b"", 1
    while data := file.read(_ROOM):
        data = rest + data
        end = data.rfind(b"\n") + 1
        rest = data[end:]
        if end:
            lines = _lines(data[:end], first, path)
            first += len(lines)
            yield lines
        if len(rest) >= LONGEST_LINE:
            raise too_long(path, first)
    if rest:
        yield _lines(rest + b"\n", first, path)


def _lines(data: bytes, first: int, path: Path) -> Lines:
    text = np.frombuffer(data + bytes(_BEHIND), dtype=np.uint8)
    ends = np.flatnonzero(text == ord("\n"))
    starts = np.concatenate(([0], ends[:-1] + 1))
    long = np.flatnonzero(ends - starts >= LONGEST_LINE - 1)
    if len(long):
        raise too_long(path, first + int(long[0]))
    returns = (ends > starts) & (text[ends - 1] == ord("\r"))
    return Lines(text, starts, ends - returns, first)


def decimals(text: NDArray[np.uint8], starts: Places, ends: Places, most: int) -> tuple[Places, Flags]:
    """Return the whole numbers that stand from `starts` to before `ends`, and which of them are good.

    Those have 1 to `most` digits, 18 at most, and nothing else.
    """
    length = ends - starts
    good = (length >= 1) & (length <= most)
    value = np.zeros(len(starts), dtype=np.int64)
    width = int(length[good].max(initial=0))
    for k in range(width):
        there = good & (k < length)
        digit = _DECIMAL[text[np.where(there, starts + k, 0)]]
        good &= ~there | (digit != NO_DIGIT)
        value = np.where(there, value * 10 + digit, value)
    return value, good


def hexadecimals(text: NDArray[np.uint8], starts: Places, ends: Places, most: int) -> tuple[Places, Flags]:
    """Return the numbers to base 16 that stand from `starts` to before `ends`, and which are good."""
    length = ends - starts
    good = (length >= 1) & (length <= most)
    value = np.zeros(len(starts), dtype=np.int64)
    for k in range(int(length[good].max(initial=0))):
        there = good & (k < length)
        digit = _HEX[text[np.where(there, starts + k, 0)]]
        good &= ~there | (digit != NO_DIGIT)
        value = np.where(there, value << 4 | digit, value)
    return value, good


def payloads(
    text: NDArray[np.uint8], starts: Places, counts: Places, apart: int, into: NDArray[Any]
) -> Flags:
    """Write bytes of two digits each, `apart` places from each other, into rows; return which are good.

    Row i of `into`, shape (n, 64), takes `counts[i]` of them.
    """
    good = np.ones(len(starts), dtype=np.bool_)
    for k in range(int(counts.max(initial=0))):
        there = k < counts
        at = np.where(there, starts + apart * k, 0)
        high, low = _HEX[text[at]], _HEX[text[at + 1]]
        good &= ~there | ((high != NO_DIGIT) & (low != NO_DIGIT))
        into[:, k] = np.where(there, high << 4 | low, 0)
    return good


def times(lines: Lines, starts: Places, dots: Places, ends: Places) -> tuple[Places, Places, Flags]:
    """Return times [ns] and their resolutions [ns] of numbers with a dot, and which of them are good.

    Those have up to nine digits behind the dot, and are before the year 2115.
    """
    whole, good = decimals(lines.text, starts, dots, 10)
    shown = ends - dots - 1
    fraction, fine = decimals(lines.text, dots + 1, ends, 9)
    power = 10 ** np.clip(9 - shown, 0, 9)
    good &= fine & (whole < LATEST // 10**9)
    return np.where(good, whole, 0) * 10**9 + fraction * power, power, good


def words(text: NDArray[np.uint8], starts: Places, ends: Places) -> tuple[NDArray[Any], Flags]:
    """Return the words from `starts` to before `ends` as bytes, and which have 1 to 16 letters."""
    length = ends - starts
    good = (length >= 1) & (length <= 16)
    letters = np.zeros((len(starts), 16), dtype=np.uint8)
    for k in range(int(length[good].max(initial=0))):
        there = good & (k < length)
        letters[:, k] = np.where(there, text[np.where(there, starts + k, 0)], 0)
        good &= ~there | (letters[:, k] > ord(" "))
    return letters.view("S16")[:, 0], good
