"""Reading logs of ASAM MDF 4 with its bus logging, by asammdf in a process of its own (`mf4_frames`)."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, BinaryIO

import numpy as np

from ....errors import ConfigError
from ..mf4 import NEEDS_LIBRARY
from .logged import LoggedFrame
from .mf4_frames import RECORD, UNREAD

_READ = 1000  # records that are taken at a time


def reading(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a log. Raises ConfigError for what asammdf cannot read, and where it is missing."""
    if importlib.util.find_spec("asammdf") is None:
        raise ConfigError(f"{path}: {NEEDS_LIBRARY}")
    with (
        tempfile.TemporaryFile(prefix="evcosim-") as said,
        subprocess.Popen(
            [sys.executable, "-P", "-m", "evcosim.cosim.can.logs.reading.mf4_frames", str(path.absolute())],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=said,
        ) as process,
    ):
        try:
            assert process.stdout is not None  # it is a pipe
            yield from _frames(process.stdout)
            if process.wait() != 0:
                said.seek(0)
                raise _unread(path, process.returncode, said.read(1000).decode("utf-8", "replace"))
        finally:
            process.kill()  # where not all frames were taken


def _frames(records: IO[bytes]) -> Iterator[LoggedFrame]:
    while data := records.read(_READ * RECORD.itemsize):
        whole = len(data) // RECORD.itemsize
        rows = np.frombuffer(data, dtype=RECORD, count=whole)
        payloads = rows["data"].tobytes()
        fields = [rows[name].tolist() for name in RECORD.names[:-1]]  # type: ignore[index] # they have names
        for i, (time, place, key, channel, resolution, extended, kind, length, end) in enumerate(
            zip(*fields, strict=True)
        ):
            if end:
                return
            payload = payloads[64 * i : 64 * i + length]
            yield LoggedFrame(time, str(channel), key, bool(extended), payload, place, kind, resolution)


def _unread(path: Path, code: int, said: str) -> ConfigError:
    """Return the error for the end of the process: what it said, or that it crashed."""
    if code == UNREAD:
        return ConfigError(f"{path}: asammdf cannot read it: {said.strip()}")
    return ConfigError(f"{path}: asammdf ended with exit code {code} on it: the log is damaged")
