"""The archive of an FMU, opened and extracted by the rules of cosim/archive.py."""

from __future__ import annotations

import zipfile
from pathlib import Path

from ...cosim import archive
from ...cosim.archive import ArchiveKind
from ...cosim.errors import ConfigError


class FmuError(ConfigError):
    """An FMU that cannot be used. The message names the file and the reason."""


FMU = ArchiveKind("FMU", "an", FmuError, "an FMU is one file (zip its content)")


def entries_of(path: Path) -> tuple[zipfile.ZipInfo, ...]:
    """Return the entries of an FMU. Raises FmuError for one that cannot be read or breaks a rule."""
    return archive.entries_of(path, FMU)


def read_entry(path: Path, name: str) -> bytes:
    """Return the bytes of one entry of at most 64 MiB, by its name in `entries_of`. Raises FmuError."""
    return archive.read_entry(path, name, FMU)


def extract(path: Path) -> Path:
    """Extract an FMU into a new temporary folder, which the caller removes.

    Raises FmuError naming the entry, ShortageError where the disk is full or a limit reached; then no folder
    is left.
    """
    return archive.extract(path, FMU)
