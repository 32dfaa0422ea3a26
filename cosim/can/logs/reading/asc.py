"""Reading Vector's ASCII logs: lines of events, of which frames are some.

Lines of other events, comments and statistics are passed over, but what begins as a frame must be one.
Times count from the start of the measurement, also where each counts from the event before (`timestamps
relative`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ...flaws import GREATEST
from ...timing.lengths import FD_LENGTHS
from .blocks import FRAME, Block, Channels, set_frame
from .lines import Flags, Lines, decimals, hexadecimals, lines_in_bulk, payloads, times
from .logged import DATA, ERROR, REMOTE, LoggedFrame, damaged, nanoseconds, resolution_of, unprintable

_EVENT = re.compile(r"(\d{1,12})\.(\d{1,12})\s+(.*)")
_BASE = re.compile(r"base\s+(hex|dec)(?:\s+timestamps\s+(absolute|relative))?", re.IGNORECASE)
_BLOCK = re.compile(r"(begin|end)\s+triggerblock\b", re.IGNORECASE)
_ID = re.compile(r"([0-9A-Fa-f]+)(x?)", re.IGNORECASE)
_DIRECTIONS = ("rx", "tx", "txrq")


def reading(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a log. Raises ConfigError, which names the line, for one that is damaged."""
    events, channels = _Events(path), Channels()
    for lines in lines_in_bulk(file, path):
        rows, good = _usual(lines, channels)
        if events.special or b"base" in lines.text.tobytes().lower():
            good[:] = False  # a header, or numbers and times that the usual form does not have
        rows["place"] = np.arange(lines.first, lines.first + len(lines))
        kept = good.copy()
        for i in np.flatnonzero(~good).tolist():
            frame = events.frame(lines.line(i), lines.first + i)
            if frame is not None:
                set_frame(rows, i, frame, channels)
                kept[i] = True
        yield Block(rows[kept], channels.names)
    yield Block(np.zeros(0, dtype=FRAME), channels.names, events.cut_off)


class _Events:
    """The lines of a log in their order, of which the last header of numbers and times counts."""

    def __init__(self, path: Path) -> None:
        self._path, self._base, self._relative, self._now = path, 16, False, 0
        self._begun = 0  # the line of a block of events that has no end up to now

    @property
    def special(self) -> bool:
        """True where numbers are decimal, or times count from the event before."""
        return self._base != 16 or self._relative

    @property
    def cut_off(self) -> str:
        """A sentence on a log that ends within a block of events; "" for any other."""
        if not self._begun:
            return ""
        return (
            f'the "Begin Triggerblock" in line {self._begun} has no "End TriggerBlock": the log was cut off, '
            "or not written to its end"
        )

    def frame(self, line: str, number: int) -> LoggedFrame | None:
        """Return the frame of a line; None for another one. Raises ConfigError for one that is damaged."""
        if unprintable(line):
            raise damaged(self._path, f"line {number}", "bytes that no text has: the file is damaged")
        event = _EVENT.match(line)
        if event is None:
            if header := _BASE.match(line):
                self._base = 10 if header[1].lower() == "dec" else 16
                self._relative = (header[2] or "").lower() == "relative"
            elif block := _BLOCK.match(line):
                self._begun = number if block[1].lower() == "begin" else 0
            return None
        try:
            time = nanoseconds(event[1], event[2])
            self._now = self._now + time if self._relative else time
            frame = _frame(event[3].split(), self._base, self._now, number)
        except (ValueError, IndexError) as error:
            raise damaged(self._path, f"line {number}", f"the frame cannot be read: {line[:80]}") from error
        return frame if frame is None else LoggedFrame(*frame[:-1], resolution_of(event[2]))


def _usual(lines: Lines, channels: Channels) -> tuple[NDArray[Any], Flags]:
    """Return the frames of lines of classic frames with data in base 16, and which lines these are.

    The frames have shape (n,) of FRAME. A line is `time channel id[x] Rx|Tx d length data ...`.
    """
    text, rows = lines.text, np.zeros(len(lines), dtype=FRAME)
    blank = (text == ord(" ")) | (text == ord("\t")) | (text == ord("\n")) | (text == ord("\r"))
    begins = np.flatnonzero(~blank & np.concatenate(([True], blank[:-1])))
    stops = np.flatnonzero(blank & np.concatenate(([False], ~blank[:-1])))  # the last line has its end
    begins = begins[: len(stops)]  # not those of the zeros behind the text
    first = np.searchsorted(begins, lines.starts)
    count = np.searchsorted(begins, lines.ends) - first
    good = count >= 6

    def word(k: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return begin and end of word k of each line, of the first word of the text where it has none."""
        at = np.where(good & (k < count), first + k, 0)
        return begins[at], stops[at]

    if not good.any():
        return rows, good
    begin, end = word(0)
    time, resolution, fine = times(lines, begin, lines.next(lines.places("."), begin), end)
    good &= fine
    begin, end = word(1)
    channel, fine = decimals(text, begin, end, 4)
    good &= fine & ((text[begin] != ord("0")) | (end - begin == 1))
    begin, end = word(2)
    extended = text[end - 1] == ord("x")
    key, fine = hexadecimals(text, begin, end - extended, 8)
    good &= fine & (key <= np.where(extended, GREATEST[True], GREATEST[False]))
    begin, end = word(3)
    good &= (end - begin == 2) & (text[begin + 1] == ord("x"))
    good &= (text[begin] == ord("R")) | (text[begin] == ord("T"))
    begin, end = word(4)
    good &= (end - begin == 1) & (text[begin] == ord("d"))
    begin, end = word(5)
    length, fine = decimals(text, begin, end, 1)
    good &= fine & (length <= 8) & (count >= 6 + length)
    for k in range(int(length[good].max(initial=0))):
        begin, end = word(6 + k)
        there = good & (k < length)
        good &= ~there | (end - begin == 2)
        ones = np.where(there, 1, 0)
        good &= payloads(text, begin, ones, 2, rows["data"][:, k : k + 1])
    rows["time"], rows["resolution"], rows["frame_id"] = time, resolution, key
    rows["extended"], rows["length"], rows["kind"] = extended, length, DATA
    for number in np.unique(channel[good]).tolist():
        rows["channel"][good & (channel == number)] = channels.place(str(number))
    rows["data"][~good] = 0
    return rows, good & ~_unprintable(lines)


def _unprintable(lines: Lines) -> Flags:
    """Return which lines have bytes that no text has; they are read one by one."""
    text = lines.text
    bad = np.flatnonzero((text < 32) & ~np.isin(text, (9, 10, 11, 12, 13)) | (text == 127))
    found = np.zeros(len(lines), dtype=np.bool_)
    bad = bad[bad < lines.ends[-1]]
    found[np.searchsorted(lines.ends, bad)] = True
    return found


def _frame(words: Sequence[str], base: int, time: int, line: int) -> LoggedFrame | None:
    """Return the frame of an event; None for another event. Raises ValueError, IndexError where damaged."""
    fd = words[:1] == ["CANFD"]
    at = 1 if fd else 0
    if len(words) < at + 2 or not words[at].isdigit():
        return None
    channel = words[at]
    if "errorframe" in (word.lower() for word in words[at + 1 : at + 3]):
        return LoggedFrame(time, channel, 0, False, b"", line, ERROR)
    if fd:
        return _fd(words, base, time, line)
    if len(words) < 3 or words[2].lower() not in _DIRECTIONS:
        return None  # statistics, the status of a chip
    frame_id, extended = _identifier(words[1], base)
    kind = words[3].lower()
    if kind not in ("d", "r"):
        raise ValueError(kind)
    length = min(int(words[4], base), 8) if len(words) > 4 or kind == "d" else 0
    if kind == "r":
        return LoggedFrame(time, channel, frame_id, extended, b"", line, REMOTE)
    return LoggedFrame(time, channel, frame_id, extended, _bytes(words[5:], length, base), line, DATA)


def _fd(words: Sequence[str], base: int, time: int, line: int) -> LoggedFrame:
    """Return the frame of a line `CANFD channel direction id [name] brs esi dlc length data ...`."""
    if words[2].lower() not in _DIRECTIONS:
        raise ValueError(words[2])
    frame_id, extended = _identifier(words[3], base)
    at = 4 if words[4] in ("0", "1") else 5
    if words[at] not in ("0", "1") or words[at + 1] not in ("0", "1"):
        raise ValueError(words[at])
    length = int(words[at + 3])
    if length not in FD_LENGTHS:
        raise ValueError(length)
    data = _bytes(words[at + 4 :], length, base)
    return LoggedFrame(time, words[1], frame_id, extended, data, line, DATA)


def _identifier(word: str, base: int) -> tuple[int, bool]:
    found = _ID.fullmatch(word)
    if found is None:
        raise ValueError(word)
    frame_id, extended = int(found[1], base), bool(found[2])
    if frame_id > GREATEST[extended]:
        raise ValueError(word)
    return frame_id, extended


def _bytes(words: Sequence[str], length: int, base: int) -> bytes:
    data = bytes(int(word, base) for word in words[:length])
    if len(data) < length:
        raise IndexError(length)
    return data
