"""Reading the log of candump -L: `(seconds.microseconds) interface id#data`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .logged import DATA, ERROR, REMOTE, LoggedFrame, damaged, lines_of, nanoseconds, resolution_of

_LINE = re.compile(
    r"\((\d{1,12})\.(\d{1,9})\)\s+(\S+)\s+([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R[0-9A-Fa-f]?|#[0-9A-Fa-f])?"
    r"((?:[0-9A-Fa-f]{2}\.?)*)(?:_[0-9A-Fa-f])?(?:\s+[RT])?"
)
_ERROR_FLAG, _ID = 0x20000000, 0x1FFFFFFF


def reading(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a log. Raises ConfigError, which names the line, for what is none."""
    for number, line in lines_of(file, path):
        if not line:
            continue
        found = _LINE.fullmatch(line)
        if found is None:
            raise damaged(
                path, f"line {number}", "no line of candump -L, as (1700000000.000000) can0 123#0011"
            )
        whole, fraction, channel, frame_id, mark, payload = found.groups()
        key, kind = int(frame_id, 16), DATA
        data = bytes.fromhex(payload.replace(".", ""))
        if len(frame_id) == 8 and key & _ERROR_FLAG:
            kind = ERROR
        elif mark and mark[0] == "R":
            kind = REMOTE
        if len(data) > (64 if mark and mark[0] == "#" else 8):
            raise damaged(path, f"line {number}", f"a frame of {len(data)} bytes")
        yield LoggedFrame(
            nanoseconds(whole, fraction), channel, key & _ID, len(frame_id) == 8, data, number, kind,
            resolution_of(fraction),
        )  # fmt: skip # the fields of a frame
