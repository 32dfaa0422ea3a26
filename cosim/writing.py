"""Writing result files so that the name they end under never stands for half a file."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .errors import ConfigError


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """A binary file that takes the place of `path` once everything is written, or leaves no trace.

    Raises ConfigError naming the path and the reason when the folder or the disk refuses.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.part")  # beside it: a rename must not cross disks
    try:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with partial.open("wb") as file:
                yield file
            partial.replace(path)
        finally:
            with contextlib.suppress(OSError):  # renamed, or a first error is on its way
                partial.unlink()
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror or error}") from error
