"""Reading Vector's ASCII logs: lines of events, of which frames are some.

Lines of other events, comments and statistics are passed over, but what begins as a frame must be one.
Times count from the start of the measurement, also where each counts from the event before (`timestamps
relative`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from ...flaws import GREATEST
from ...timing.lengths import FD_LENGTHS
from .logged import (
    DATA,
    ERROR,
    REMOTE,
    LoggedFrame,
    damaged,
    lines_of,
    nanoseconds,
    resolution_of,
    unprintable,
)

_EVENT = re.compile(r"(\d{1,12})\.(\d{1,12})\s+(.*)")
_BASE = re.compile(r"base\s+(hex|dec)(?:\s+timestamps\s+(absolute|relative))?", re.IGNORECASE)
_ID = re.compile(r"([0-9A-Fa-f]+)(x?)", re.IGNORECASE)
_DIRECTIONS = ("rx", "tx", "txrq")


def reading(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a log. Raises ConfigError, which names the line, for one that is damaged."""
    base, relative, now = 16, False, 0
    for number, line in lines_of(file, path):
        if unprintable(line):
            raise damaged(path, f"line {number}", "bytes that no text has: the file is damaged")
        event = _EVENT.match(line)
        if event is None:
            if header := _BASE.match(line):
                base = 10 if header[1].lower() == "dec" else 16
                relative = (header[2] or "").lower() == "relative"
            continue
        time = nanoseconds(event[1], event[2])
        now = now + time if relative else time
        try:
            frame = _frame(event[3].split(), base, now, number)
        except (ValueError, IndexError) as error:
            raise damaged(path, f"line {number}", f"the frame cannot be read: {line[:80]}") from error
        if frame is not None:
            yield LoggedFrame(*frame[:-1], resolution_of(event[2]))


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
