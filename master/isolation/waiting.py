"""Whether the master waits for a unit in a process of its own, so that Ctrl-C may break the wait off.

Anywhere else Ctrl-C is noted and looked at between steps: in a unit of this process an exception would end in
the unit's library.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator


class _Waiting:
    now = False


def waits() -> bool:
    """Whether the main thread waits for such a unit at this moment."""
    return _Waiting.now


@contextlib.contextmanager
def waiting() -> Iterator[None]:
    """The time in which `waits` is true."""
    _Waiting.now = True
    try:
        yield
    finally:
        _Waiting.now = False
