"""Writing the frames of a run as a log file; its suffix names the format.

    .log     candump -L of can-utils: text, microseconds
    .asc     Vector ASCII: text, microseconds
    .blf     Vector binary logging format: nanoseconds
    .mf4     ASAM MDF 4 with its bus logging, by asammdf (the extra `mf4`): nanoseconds
    .pcapng  the frames of SocketCAN, as tshark captures them: nanoseconds

The same run writes the same bytes: no file holds the date at which it was written. Dates count from `START`,
or the start that is given: 0 s of the run's clock is that moment. The beginning of 1970, where clocks of
computers start, would do for no tool of can-utils, which takes it as "not set".
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

from ...clock import Clock
from ...errors import ConfigError
from ...writing import replacing
from . import candump, mf4, pcapng, vector
from .frames import BusLog, Frame, frames

START = datetime(2000, 1, 1, tzinfo=UTC)
"""The moment at which a run's clock shows 0 s, unless it is given."""

Write = Callable[[Frame], None]
_Format = Callable[[BinaryIO, Sequence[str], datetime], contextlib.AbstractContextManager[Write]]

FORMATS: dict[str, _Format] = {
    ".log": candump.writing,
    ".asc": vector.writing_asc,
    ".blf": vector.writing_blf,
    ".mf4": mf4.writing,
    ".pcapng": pcapng.writing,
}
"""The formats by suffix: each opens a file for the named buses, and gives a function that writes a frame."""


def write_can_log(
    path: str | Path, logs: Sequence[BusLog], clock: Clock, start: datetime | None = None
) -> int:
    """Write the frames of `logs` in the format that the file's suffix names; return how many there were.

    `clock` is the run's, `start` the moment at which it shows 0 s, with a time zone. Written frame by frame.
    Raises ConfigError for another suffix, where the file cannot be written, where the library for its format
    is missing, and for times before the start or a start without a time zone.
    """
    path = Path(path)
    check_format(path)
    check_start(path, clock.start)
    start = START if start is None else start
    if start.tzinfo is None:
        raise ConfigError(f"{path}: the start {start.isoformat()} needs a time zone, as in 2000-01-01T00:00Z")
    count = 0
    form = FORMATS[path.suffix.lower()]
    with replacing(path) as file, form(file, [log.bus for log in logs], start) as write:
        for frame in frames(logs, clock):
            write(frame)
            count += 1
    return count


def check_format(path: str | Path) -> None:
    """Raise ConfigError when no log format has this file's suffix, or the library for it is missing."""
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise ConfigError(f"{path}: CAN logs are written as {', '.join(FORMATS)}, not as '{suffix}'")
    if suffix == ".mf4":
        mf4.check_library()


def check_start(path: str | Path, start: float) -> None:
    """Raise ConfigError for a run that begins at a time [s] before the start of a log."""
    if start < 0.0:
        raise ConfigError(f"{path}: a CAN log has no times before its start, and the run begins at {start} s")
