"""Reading files that somebody else wrote: no device or pipe, which has no end, and none that is too large."""

from __future__ import annotations

import codecs
import os
import stat
from pathlib import Path

from .errors import ConfigError
from .file_names import check_name, flaw_of_name, near_file
from .shortage import reason

LARGEST = 64 << 20
"""Bytes of a file that is read whole: a system, a scenario, a swap or a CAN database."""


def require_file(path: Path, about: str = "") -> os.stat_result:
    """Return the status of a file. Raises ConfigError naming the path, and `about`, for anything else.

    A pipe or a device would be read without an end, or waited for.
    """
    check_name(path, f"{about}cannot be read: ")
    start = f"{path}: {about}"
    try:
        found = path.stat()
    except FileNotFoundError as error:
        raise ConfigError(f"{start}cannot be read: {error.strerror}{near_file(path)}") from error
    except OSError as error:
        raise ConfigError(f"{start}cannot be read: {reason(error)}") from error
    if stat.S_ISDIR(found.st_mode):
        raise ConfigError(f"{start}cannot be read: it is a folder, not a file")
    if not stat.S_ISREG(found.st_mode):
        raise ConfigError(f"{start}cannot be read: it is no file, but a pipe or a device")
    return found


def is_file(path: Path) -> bool:
    """Return True for a file; False for what is none, and for a name that no file can have."""
    return not flaw_of_name(path) and path.is_file()


def content(path: Path, about: str = "") -> bytes:
    """Return the bytes of a file of at most LARGEST. Raises ConfigError as `require_file` does."""
    size = require_file(path, about).st_size
    if size > LARGEST:
        raise ConfigError(f"{path}: {about}has {size} bytes; at most {LARGEST} are read")
    try:
        with path.open("rb") as file:
            return file.read(min(size + 1, LARGEST))  # as much as it asks for, Python takes at once
    except OSError as error:
        raise ConfigError(f"{path}: {about}cannot be read: {reason(error)}") from error


def text_of(data: bytes) -> str:
    """Return the text of a file in UTF-16 that says so, in UTF-8 or, where it is neither, in cp1252."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")  # five bytes have no meaning
