"""Whatever the bits of a native FMU depend on besides sources and compiler: Python and the C library."""

from __future__ import annotations

import functools
import hashlib
import platform
import sys
from pathlib import Path

MINORS = range(11, 15)
"""The minor versions of Python 3 whose rules and words the runtime knows."""


def python_minor() -> int:
    """Return the minor version of Python 3 that generated C follows: this one's, or the nearest known."""
    return min(max(sys.version_info.minor, MINORS[0]), MINORS[-1])


@functools.cache
def mathematical_library() -> tuple[str, ...]:
    """Return the C library's name and version, the machine, and the digest of the mathematical library.

    The digest is that of the files which this process has loaded; "" where they are not found.
    """
    digest = hashlib.sha256()
    files = _loaded()
    for file in files:
        digest.update(file.read_bytes())
    return (*platform.libc_ver(), platform.machine(), digest.hexdigest() if files else "")


def _loaded() -> list[Path]:
    maps = Path("/proc/self/maps")  # of Linux
    if not maps.is_file():
        return []
    places = {line.split(maxsplit=5)[-1].strip() for line in maps.read_text(errors="replace").splitlines()}
    names = ("libm.so", "libm-", "ld-musl-")
    files = sorted(Path(place) for place in places if place.rpartition("/")[2].startswith(names))
    return [file for file in files if file.is_file()]
