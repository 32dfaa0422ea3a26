"""Wishes about a native FMU; light to import."""

from __future__ import annotations

from typing import NamedTuple


class Wanted(NamedTuple):
    """A native FMU as it is asked for.

    Without `require` a model that has no native form is built in Python. `platforms` are names of
    `toolchain.PLATFORMS`, this machine's alone if there are none; `fmi` is 2 or 3.
    """

    require: bool = False
    platforms: tuple[str, ...] = ()
    fmi: int = 2


DEFAULT = Wanted()
