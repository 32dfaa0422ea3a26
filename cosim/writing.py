"""Writing result files so that the name they end under never stands for half a file."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .errors import ConfigError


@contextlib.contextmanager
def in_place_of(path: Path) -> Iterator[Path]:
    """The name of a file to write, which takes the place of `path` once it is whole, or leaves no trace.

    Raises ConfigError naming the path and the reason when the folder or the disk refuses.
    """
    # beside it: a rename must not cross disks
    partial = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield partial
            partial.replace(path)
        finally:
            with contextlib.suppress(OSError):  # renamed, or a first error is on its way
                partial.unlink()
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror or error}") from error


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """The same, as a binary file that is open."""
    with in_place_of(path) as partial, partial.open("wb") as file:
        yield file
