"""The steps at which units take what messages bring, by message and unit (a reader)."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from .plan import Plan


@dataclasses.dataclass(frozen=True)
class Reader:
    """A unit that takes what a message brings at the steps k >= first with (k - first) % every == 0.

    `later`: what arrives in such a step comes behind its turn, and is taken in the next one. `mailbox` is the
    first of those that it takes.
    """

    unit: str
    every: int
    first: int
    later: bool
    mailbox: int = dataclasses.field(default=-1, compare=False)

    def turns(self, steps: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the steps in which it takes what arrives in these steps, shape (n,)."""
        since = np.maximum(steps + self.later - self.first, 0)
        return self.first - -since // self.every * self.every


def readers(plan: Plan) -> tuple[tuple[Reader, ...], ...]:
    """Return the receivers of each message, in the order of the messages and of the units."""
    owners = {route.source: i for i, unit in enumerate(plan.units) for route in unit.routes}
    found = []
    for message in plan.messages:
        mailboxes = dict(message.arrivals)
        sinks = [mailboxes.get(slot, slot) for route in message.routes for slot, _ in route.sinks]
        units = {owners[slot]: slot for slot in reversed(sinks) if slot in owners}
        behind = -1 if message.after is None or message.timed else message.after
        found.append(
            tuple(
                Reader(plan.units[i].name, plan.units[i].every, plan.units[i].first, i <= behind, slot)
                for i, slot in sorted(units.items())
            )
        )
    return tuple(found)
