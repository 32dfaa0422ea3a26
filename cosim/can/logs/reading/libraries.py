"""Reading the logs for which python-can is the reader: PEAK's TRC, and its own CSV files."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from ....errors import ConfigError
from .blocks import Block, blocks_of
from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE, LoggedFrame, damaged, resolution_of

_SECONDS = re.compile(r"\s*\d*\.?(\d*)\s*,")
_MILLISECONDS = re.compile(r"\s*\d+\)?\s+\d+\.?(\d*)")


def reading_trc(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a trace of PEAK's tools. Raises ConfigError, which counts the frames before."""
    from can.io.trc import TRCReader

    return blocks_of(_frames(TRCReader, _Stamped(file, _MILLISECONDS, 3), path, "a TRC trace"))


def reading_csv(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a CSV file of python-can. Raises ConfigError, which counts the frames before."""
    from can.io.csv import CSVReader

    return blocks_of(_frames(CSVReader, _Stamped(file, _SECONDS, 0), path, "a CSV file of python-can"))


class _Stamped(io.TextIOWrapper):
    """A text whose lines begin with a time, of which python-can returns a double without its digits.

    `resolution` is that [ns] of the line that was read last; `power` is that of the unit, 3 for ms.
    """

    def __init__(self, file: BinaryIO, stamp: re.Pattern[str], power: int) -> None:
        super().__init__(file, encoding="utf-8", errors="replace")
        self._stamp, self._power = stamp, power
        self.resolution = 1

    def __next__(self) -> str:  # type: ignore[override] # so is that of the base, of a text
        line = super().__next__()
        if found := self._stamp.match(line):
            self.resolution = resolution_of("0" * self._power + found[1])
        return line


def _frames(reader: Any, lines: _Stamped, path: Path, kind: str) -> Iterator[LoggedFrame]:
    number = 0
    with lines as text:
        try:
            messages = iter(reader(text))
        except Exception as error:  # a stranger's bytes: the library raises whatever its parsing comes across
            raise _unread(path, kind, number, error) from error
        while True:
            try:
                message = next(messages)
            except StopIteration:
                return
            except Exception as error:  # as above
                raise _unread(path, kind, number, error) from error
            number += 1
            yield _frame(message, path, number, lines.resolution)


def _frame(message: Any, path: Path, number: int, resolution: int) -> LoggedFrame:
    time, data = message.timestamp, bytes(message.data)
    good = abs(time) < LATEST / 1e9 and len(data) <= MOST_BYTES
    if not good or not 0 <= message.arbitration_id <= 0x1FFFFFFF:
        raise damaged(
            path, f"frame {number}", f"time {time} s, id {message.arbitration_id:#x}, {len(data)} bytes"
        )
    kind = ERROR if message.is_error_frame else REMOTE if message.is_remote_frame else DATA
    channel = "1" if message.channel is None else str(message.channel)
    resolution = max(resolution, round(math.ulp(time) * 1e9))  # that of the double, of a time since 1970
    return LoggedFrame(
        round(time * 1e9), channel, message.arbitration_id, message.is_extended_id, data, number, kind,
        resolution,
    )  # fmt: skip # the fields of a frame


def _unread(path: Path, kind: str, number: int, error: Exception) -> ConfigError:
    said = str(error).partition("\n")[0][:120]
    return damaged(
        path,
        f"after {number} frames",
        f"python-can cannot read it as {kind}: {type(error).__name__}: {said}",
    )
