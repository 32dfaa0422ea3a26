"""The mark that the master waits for a unit in a process of its own, so that Ctrl-C may break the wait off.

At any other time Ctrl-C is noted and looked at between steps: an exception in a unit of this process would
end in the unit's library.
"""

from __future__ import annotations


class _Waiting:
    """A `with` block in which `waits` returns True."""

    now = False

    def __enter__(self) -> None:
        self.now = True

    def __exit__(self, *_: object) -> None:
        self.now = False


WAITING = _Waiting()


def waits() -> bool:
    """Return True while the main thread waits for such a unit."""
    return WAITING.now
