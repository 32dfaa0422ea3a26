"""Whether the master waits for a unit in a process of its own, so that Ctrl-C may break the wait off.

Anywhere else Ctrl-C is noted and looked at between steps: in a unit of this process an exception would end in
the unit's library.
"""

from __future__ import annotations


class _Waiting:
    """A `with` block in which `waits` is true."""

    now = False

    def __enter__(self) -> None:
        self.now = True

    def __exit__(self, *_: object) -> None:
        self.now = False


WAITING = _Waiting()


def waits() -> bool:
    """Whether the main thread waits for such a unit at this moment."""
    return WAITING.now
