"""Reading the log of candump -L: `(seconds.microseconds) interface id#data`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from .blocks import FRAME, Block, Channels, set_frame
from .lines import Flags, Lines, Places, hexadecimals, lines_in_bulk, payloads, times, words
from .logged import DATA, ERROR, REMOTE, LoggedFrame, damaged, nanoseconds, resolution_of

_LINE = re.compile(
    r"\((\d{1,12})\.(\d{1,9})\)\s+(\S+)\s+([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R[0-9A-Fa-f]?|#[0-9A-Fa-f])?"
    r"((?:[0-9A-Fa-f]{2}\.?)*)(?:_[0-9A-Fa-f])?(?:\s+[RT])?"
)
_ERROR_FLAG, _ID = 0x20000000, 0x1FFFFFFF


def reading(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a log. Raises ConfigError, which names the line, for what is none."""
    channels = Channels()
    for lines in lines_in_bulk(file, path):
        rows, good = _usual(lines, channels)
        rows["place"] = np.arange(lines.first, lines.first + len(lines))
        empty = lines.ends == lines.starts
        for i in np.flatnonzero(~good & ~empty).tolist():
            if text := lines.line(i):
                set_frame(rows, i, _frame(text, lines.first + i, path), channels)
            else:
                empty[i] = True
        yield Block(rows[~empty] if empty.any() else rows, channels.names)


def _frame(line: str, number: int, path: Path) -> LoggedFrame:
    """Return the frame of any line. Raises ConfigError, which names the line, for what is none."""
    found = _LINE.fullmatch(line)
    if found is None:
        raise damaged(path, f"line {number}", "no line of candump -L, as (1700000000.000000) can0 123#0011")
    whole, fraction, channel, frame_id, mark, payload = found.groups()
    key, kind = int(frame_id, 16), DATA
    data = bytes.fromhex(payload.replace(".", ""))
    if len(frame_id) == 8 and key & _ERROR_FLAG:
        kind = ERROR
    elif mark and mark[0] == "R":
        kind = REMOTE
    if len(data) > (64 if mark and mark[0] == "#" else 8):
        raise damaged(path, f"line {number}", f"a frame of {len(data)} bytes")
    try:
        time = nanoseconds(whole, fraction)
    except ValueError as error:
        raise damaged(path, f"line {number}", f"the frame cannot be read: {error}") from error
    return LoggedFrame(
        time, channel, key & _ID, len(frame_id) == 8, data, number, kind, resolution_of(fraction)
    )


def _usual(lines: Lines, channels: Channels) -> tuple[NDArray[Any], Flags]:
    """Return the frames of lines as candump writes them, shape (n,) of FRAME, and which lines these are."""
    text, starts, ends = lines.text, lines.starts, lines.ends
    rows = np.zeros(len(lines), dtype=FRAME)
    dot, close = (lines.next(lines.places(byte), starts) for byte in ".)")
    spaces, mark = lines.places(" "), lines.next(lines.places("#"), starts)
    space = lines.next(spaces, close + 2)
    good = (text[starts] == ord("(")) & (dot < close) & (close + 1 < space) & (space < mark) & (mark < ends)
    good &= text[close + 1] == ord(" ")
    time, resolution, fine = times(lines, starts + 1, dot, close)
    names, named = words(text, close + 2, space)
    key, keyed = hexadecimals(text, space + 1, mark, 8)
    figures = mark - space - 1
    good &= fine & named & keyed & ((figures == 3) | (figures == 8))
    fd = text[mark + 1] == ord("#")
    _, flagged = hexadecimals(text, mark + 2, mark + 3, 1)
    begin = mark + 1 + 2 * fd
    digits = ends - begin
    good &= (digits >= 0) & (digits % 2 == 0) & (digits <= np.where(fd, 128, 16)) & (~fd | flagged)
    count = np.where(good, digits // 2, 0)
    good &= payloads(text, begin, count, 2, rows["data"])
    rows["time"], rows["resolution"] = time, resolution
    rows["frame_id"], rows["extended"] = key & _ID, figures == 8
    rows["kind"] = np.where((figures == 8) & (key & _ERROR_FLAG != 0), ERROR, DATA)
    rows["length"] = count
    rows["channel"] = _channels(names, good, channels)
    rows["data"][~good] = 0
    return rows, good


def _channels(names: NDArray[Any], good: Flags, channels: Channels) -> Places:
    """Return the places of names, shape (n,), of which those that are not good do not count."""
    found = np.zeros(len(names), dtype=np.int64)
    left = good.copy()
    while left.any():
        name = names[np.argmax(left)]
        same = left & (names == name)
        found[same] = channels.place(name.decode("utf-8", "replace"))
        left &= ~same
    return found
