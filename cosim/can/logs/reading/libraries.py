"""Reading the logs for which python-can is the reader: PEAK's TRC, and its own CSV files."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from ....errors import ConfigError
from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE, LoggedFrame, damaged


def reading_trc(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a trace of PEAK's tools. Raises ConfigError, which counts the frames before."""
    from can.io.trc import TRCReader

    return _frames(TRCReader, file, path, "a TRC trace")


def reading_csv(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a CSV file of python-can. Raises ConfigError, which counts the frames before."""
    from can.io.csv import CSVReader

    return _frames(CSVReader, file, path, "a CSV file of python-can")


def _frames(reader: Any, file: BinaryIO, path: Path, kind: str) -> Iterator[LoggedFrame]:
    number = 0
    with io.TextIOWrapper(file, encoding="utf-8", errors="replace") as text:
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
            yield _frame(message, path, number)


def _frame(message: Any, path: Path, number: int) -> LoggedFrame:
    time, data = message.timestamp, bytes(message.data)
    good = abs(time) < LATEST / 1e9 and len(data) <= MOST_BYTES
    if not good or not 0 <= message.arbitration_id <= 0x1FFFFFFF:
        raise damaged(
            path, f"frame {number}", f"time {time} s, id {message.arbitration_id:#x}, {len(data)} bytes"
        )
    kind = ERROR if message.is_error_frame else REMOTE if message.is_remote_frame else DATA
    channel = "1" if message.channel is None else str(message.channel)
    return LoggedFrame(
        round(time * 1e9), channel, message.arbitration_id, message.is_extended_id, data, number, kind
    )


def _unread(path: Path, kind: str, number: int, error: Exception) -> ConfigError:
    said = str(error).partition("\n")[0][:120]
    return damaged(
        path,
        f"after {number} frames",
        f"python-can cannot read it as {kind}: {type(error).__name__}: {said}",
    )
