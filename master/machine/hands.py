"""A handover of turns as machine code needs it: addresses of the shared memory, and the values to copy."""

from __future__ import annotations

import dataclasses
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

if TYPE_CHECKING:
    from ..fmi.transfer import Call
    from .rows import Cells

Span = tuple[int, int, int]
"""Two addresses, from and to, and the number of slots to copy."""

POSSIBLE = sys.platform == "linux" and os.uname().machine == "x86_64"
"""True where machine code can hand turns over: it needs futexes, and the order of stores of x86."""

LOOK_TIME = 100e-6
"""The time [s] that a side looks before it sleeps: a few times what sleeping and waking costs."""


@dataclasses.dataclass(frozen=True)
class Hand:
    """The row of HANDS of an isolated unit, in the master: `row` has the addresses and the descriptor.

    `inputs` are copied before a turn, `outputs` after it; so Python moves texts, where there are some.
    """

    row: Cells
    inputs: Sequence[Span]
    outputs: Sequence[Span]
    texts_in: Call | None = None
    texts_out: Call | None = None


@runtime_checkable
class HandedOver(Protocol):
    """A unit in a process of its own whose turns machine code can hand over; None: it cannot."""

    hand: Hand | None

    def quicken(self, code: bytes) -> None:
        """Let the process do its turns in this machine code."""

    def settle(self, cores: set[int], look: float) -> None:
        """Let the process run on these cores, and look for `look` [s]. Raises OSError if it has ended."""
