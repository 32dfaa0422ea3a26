"""Reading logs of ASAM MDF 4 with its bus logging, by asammdf in a process of its own (`mf4_frames`)."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO, BinaryIO

import numpy as np

from ....errors import ConfigError
from ..mf4 import NEEDS_LIBRARY
from .blocks import FRAME, Block, Channels
from .mf4_frames import END, UNREAD

LONGEST = 300.0
"""Seconds that the process may take for its first frames, and for some more."""
_READ = 20_000  # records that are taken at a time


def reading(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a log. Raises ConfigError for what asammdf cannot read, and where it is missing.

    That is also where it goes on for `LONGEST` seconds without a frame.
    """
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
        _Watch(process) as watch,
    ):
        try:
            assert process.stdout is not None  # it is a pipe
            yield from _blocks(process.stdout, watch)
            watch.let(LONGEST)
            code = process.wait()
            if watch.struck:
                raise _endless(path)
            if code != 0:
                said.seek(0)
                raise _unread(path, code, said.read(1000).decode("utf-8", "replace"))
        finally:
            process.kill()  # where not all frames were taken


class _Watch:
    """Kills a process that gives nothing for some time; `struck` where it did.

    The time counts while somebody waits for the process, not while its frames are worked on.
    """

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process = process
        self._timer: threading.Timer | None = None
        self.struck = False

    def __enter__(self) -> _Watch:
        return self

    def __exit__(self, *error: object) -> None:
        self.let(None)

    def let(self, seconds: float | None) -> None:
        """Let the process take these seconds from now on; None: nobody waits for it."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if seconds is not None:
            self._timer = threading.Timer(seconds, self._strike)
            self._timer.daemon = True
            self._timer.start()

    def _strike(self) -> None:
        self.struck = True
        self._process.kill()


def _blocks(records: IO[bytes], watch: _Watch) -> Iterator[Block]:
    channels, end = Channels(), False
    while not end:
        watch.let(LONGEST)
        data = records.read(_READ * FRAME.itemsize)
        watch.let(None)
        if not data:
            return
        rows = np.frombuffer(data, dtype=FRAME, count=len(data) // FRAME.itemsize).copy()
        last = np.flatnonzero(rows["kind"] == END)
        end = len(last) > 0
        rows = rows[: int(last[0])] if end else rows
        numbers = rows["channel"].copy()
        for number in np.unique(numbers).tolist():
            rows["channel"][numbers == number] = channels.place(str(number))
        yield Block(rows, channels.names)


def _endless(path: Path) -> ConfigError:
    return ConfigError(
        f"{path}: asammdf gave no frame for {LONGEST:g} s and was ended: the log is damaged, or this machine "
        "is far too busy"
    )


def _unread(path: Path, code: int, said: str) -> ConfigError:
    """Return the error for the end of the process: its own words, or that it crashed."""
    if code == UNREAD:
        return ConfigError(f"{path}: asammdf cannot read it: {said.strip()}")
    return ConfigError(f"{path}: asammdf ended with exit code {code} on it: the log is damaged")
