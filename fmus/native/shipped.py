"""Libraries of built-in models that a wheel brings, so that native FMUs need no compiler here.

A library is the one of exactly these C files, for this platform: the record names it by their digest. The C
follows from the models' sources, the translator, the version of Python and the constants that this machine
computes; where any of it is another, there is no such library, and a compiler is asked. The record is a part
of the installed package, as its code is; a file whose digest is not the recorded one is not used.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path

from ..recipes import digest_of
from .toolchain import Platform

FOLDER = Path(__file__).with_name("shipped")
"""The folder of the libraries and of their record; a checkout has none."""

RECORD = "record.json"
"""By platform (its name in FMI 2.0) and digest of the C files: the file of a library, and its SHA-256."""


def key(files: Mapping[str, bytes]) -> str:
    """Return the digest of C files and headers by name: that of what a compiler is given."""
    return digest_of(part for name in sorted(files) for part in (name.encode(), files[name]))


def library(files: Mapping[str, bytes], target: Platform) -> bytes | None:
    """Return the shipped library of these C files for a platform; None where there is none, or a damaged one.

    Who names a compiler in the environment variable CC is given what that one compiles.
    """
    found = _offered(target).get(key(files))
    if found is None:
        return None
    file, digest = FOLDER / found[0], found[1]
    try:
        content = file.read_bytes()
    except OSError as error:
        _not_used(file, error.strerror or str(error))
        return None
    if hashlib.sha256(content).hexdigest() != digest:
        _not_used(file, "is damaged: its digest is not the recorded one")
        return None
    return content


def _not_used(file: Path, reason: str) -> None:
    print(f"evcosim: {file}: {reason}; it is not used", file=sys.stderr)


def offers(target: Platform) -> bool:
    """Return True if libraries for a platform are shipped."""
    return bool(_offered(target))


def _offered(target: Platform) -> dict[str, tuple[str, str]]:
    return {} if os.environ.get("CC") else _record(FOLDER / RECORD).get(target.fmi2, {})


@functools.cache
def _record(file: Path) -> dict[str, dict[str, tuple[str, str]]]:
    """Return what a record says by platform and digest; nothing where there is none."""
    try:
        said = json.loads(file.read_bytes())
        return {
            target: {key: (_plain(name), str(digest)) for key, (name, digest) in libraries.items()}
            for target, libraries in said.items()
        }
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        _not_used(file, f"is damaged: {error}")
        return {}


def _plain(name: str) -> str:
    """Return the name of a file of this folder. Raises ValueError for any other."""
    if not re.fullmatch(r"\w+\.\w+", name):
        raise ValueError(f"{name!r} is no name of a library")
    return name
