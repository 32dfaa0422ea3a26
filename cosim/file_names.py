"""Names that no file can have, refused before they are used: the system's words for them name no rule."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import ConfigError, nearest, short

_LONGEST_NAME, _LONGEST_PATH = 255, 4095
"""Bytes of a file's or a folder's name, and of a path, on Linux; those of other systems are near."""


def flaw_of_name(path: str | os.PathLike[str]) -> str:
    """Return why there can be no file or folder of a name, with rule and value; "" where there can."""
    text = os.fspath(path)
    if not text:
        return "it is empty, where a file or a folder is named"
    if "\0" in text:
        return "it has a NUL, which the name of no file has"
    lengths = {part: len(_bytes(part)) for part in Path(text).parts}
    for part, length in lengths.items():
        if length > _LONGEST_NAME:
            return f"the name {_begin(part)} in it has {length} bytes; {_LONGEST_NAME} are possible"
    if len(_bytes(text)) > _LONGEST_PATH:
        return f"it has {len(_bytes(text))} bytes; a path of {_LONGEST_PATH} is possible"
    return ""


def check_name(path: str | os.PathLike[str], about: str = "") -> None:
    """Raise ConfigError for a name that no file can have; it starts with the path, shortened, and `about`."""
    if flaw := flaw_of_name(path):
        raise ConfigError(f"{short_path(path)}: {about}{flaw}")


def short_path(path: str | os.PathLike[str]) -> str:
    """Return a path, cut where it is too long to be read."""
    text = os.fspath(path)
    return text if len(text) <= _LONGEST_NAME else short(text)


def _begin(name: str) -> str:
    return repr(f"{name[:16]}...")


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def near_file(path: str | os.PathLike[str]) -> str:
    """Return ` (did you mean 'x'?)` for the most similar name in the folder of a file that is not there."""
    missing = Path(path)
    try:
        there = [found.name for found in missing.parent.iterdir()]
    except OSError:  # there is no such folder either
        return ""
    close = nearest(missing.name, there)
    return close.replace("'", f"'{missing.parent}{os.sep}", 1) if close and missing.parent.parts else close
