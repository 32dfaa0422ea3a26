"""The formats of logs that are read, by suffix."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import BinaryIO, Literal

from ....errors import ConfigError
from ....reading import require_file
from ....shortage import reason
from . import asc, blf, candump, libraries, mf4, pcapng
from .blocks import Block
from .logged import LoggedFrame


@dataclasses.dataclass(frozen=True)
class Format:
    """A format: `reading` yields the frames of a file in blocks.

    `place` is what the place of a frame counts. Of the resolutions of its frames `resolution` is that of the
    log: the finest one of a text, where a number may end before its zeros, else the coarsest one.
    """

    reading: Callable[[BinaryIO, Path], Iterator[Block]]
    place: Literal["line", "byte", "frame"]
    resolution: Callable[[int, int], int] = max


FORMATS: dict[str, Format] = {
    ".log": Format(candump.reading, "line", min),
    ".asc": Format(asc.reading, "line", min),
    ".blf": Format(blf.reading, "byte"),
    ".mf4": Format(mf4.reading, "frame"),
    ".pcapng": Format(pcapng.reading, "byte"),
    ".trc": Format(libraries.reading_trc, "frame", min),
    ".csv": Format(libraries.reading_csv, "frame", min),
}


def format_of(path: Path, place: str = "") -> Format:
    """Return the format of a log. Raises ConfigError, which starts with `place`, for a suffix of none."""
    if path.suffix.lower() not in FORMATS:
        start = f"{place}: " if place else ""
        raise ConfigError(f"{start}{path}: CAN logs are read as {', '.join(FORMATS)}, not as '{path.suffix}'")
    return FORMATS[path.suffix.lower()]


@contextlib.contextmanager
def logged_blocks(path: Path) -> Iterator[Iterator[Block]]:
    """Give the frames of a log in the order of the file, in blocks that are read while they are taken.

    Raises ConfigError where it cannot be read, or is damaged, which names line or byte.
    """
    form = format_of(path)
    require_file(path)
    try:
        with path.open("rb") as file:
            yield form.reading(file, path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {reason(error)}") from error


@contextlib.contextmanager
def logged_frames(path: Path) -> Iterator[Iterator[LoggedFrame]]:
    """Give the frames of a log one by one. Raises as `logged_blocks`."""
    with logged_blocks(path) as blocks, contextlib.closing(_singly(blocks)) as frames:
        yield frames


def _singly(blocks: Iterator[Block]) -> Generator[LoggedFrame]:
    for block in blocks:
        yield from block.frames()
