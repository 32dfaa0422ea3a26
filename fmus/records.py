"""Records of the FMUs that this user built on this machine: by their SHA-256, in the user's cache.

They alone say that an FMU is ours, never what a file says of itself.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from . import cache


def note(content: bytes, name: str, folder: Path | None = None, library: str = "") -> None:
    """Note an FMU of these bytes as built here, with its name and the folder of the model's files.

    `library` says where the machine code of a native one came from.
    """
    noted = f"{name}\n{folder or ''}\n{library}\n"
    cache.keep(_entry(hashlib.sha256(content).hexdigest()), noted.encode("utf-8", "surrogateescape"))


def is_own(digest: str) -> bool:
    """Return True if `build_model` made the file of this SHA-256 for this user on this machine.

    The record of it is in the user's cache, which is trusted as its docstring says. Without a cache that can
    be used there is none, and the FMU counts as anybody's.
    """
    return cache.load(_entry(digest)) is not None


def folder_of(digest: str) -> list[Path]:
    """Return the folder of the files of which `build_model` made the FMU of a SHA-256, if it is known."""
    return [Path(folder)] if (folder := _noted(digest)[1]) else []


def library_of(digest: str) -> str:
    """Return where the machine code of the native FMU of a SHA-256 came from; "" where nothing is noted.

    It is "shipped with evcosim" or "compiled by gcc".
    """
    return _noted(digest)[2]


def _noted(digest: str) -> list[str]:
    """Return name, folder and library that are noted of an FMU, each "" where nothing is."""
    noted = (cache.load(_entry(digest)) or b"").decode("utf-8", "surrogateescape").split("\n")
    return [*noted, "", "", ""][:3]


def _entry(digest: str) -> str:
    """Return the name in the cache that notes the FMU of a SHA-256 as built here."""
    return f"built-here-{digest}"
