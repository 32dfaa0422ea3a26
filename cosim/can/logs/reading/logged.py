"""A frame of a log as it was read, whatever its format, and how a reader says what is wrong in a file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from ....errors import ConfigError

DATA, REMOTE, ERROR = range(3)
"""Kinds of frames: with data, which only are replayed; a request for some; the flags of an error."""

MOST_BYTES = 64
"""Bytes of a frame."""
LONGEST_LINE = 1 << 16
"""Bytes of a line that is none of a log."""
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f\x7f]")
LATEST = 1 << 62
"""Nanoseconds of the latest time that is read; the year 2116, counted from 1970."""


class LoggedFrame(NamedTuple):
    """One frame: `time` in whole ns as the file counts it, `channel` its interface as the file names it.

    `place` is the line of a text, else the byte of the file at which it, or what holds it, begins; where a
    library reads the file, the number of the frame, from 1 on (`files.Format.place`). The time is given to
    `resolution` ns.
    """

    time: int
    channel: str
    frame_id: int
    extended: bool
    data: bytes
    place: int
    kind: int = DATA
    resolution: int = 1


def too_long(path: Path, number: int) -> ConfigError:
    """Return the error for a line that no log has, by its length."""
    return ConfigError(f"{path}: line {number} has {LONGEST_LINE} bytes or more: no log of frames")


def unprintable(line: str) -> bool:
    """Return True for a line with control characters, which damage leaves and no tool writes."""
    return _CONTROL.search(line) is not None


def nanoseconds(whole: str, fraction: str) -> int:
    """Return seconds that are written as `whole`.`fraction` in whole nanoseconds, the rest cut off.

    Raises ValueError for a time that is too late for a log.
    """
    time = int(whole[-20:]) * 10**9 + int(fraction[:9].ljust(9, "0"))
    if not time < LATEST:
        raise ValueError(f"a time of {whole} s")
    return time


def resolution_of(fraction: str) -> int:
    """Return the nanoseconds to which seconds are given that have these digits behind the point."""
    return int(10 ** max(0, 9 - len(fraction)))


def damaged(path: Path, place: str, problem: str) -> ConfigError:
    """Return the error for a place of a file at which no frame can be read."""
    return ConfigError(f"{path}: {place}: {problem}")
