"""The profile of a run: the time of its actions by unit, bus message, stimuli and recording."""

from __future__ import annotations

import time
from collections.abc import Sequence

from ...cosim.plan.plan import Plan
from .schedule import Action, Kind

Part = tuple[str, str]
"""The name of a unit, of a message, "stimuli" or "results", and its activity, as in ("vehicle", "step")."""

_WHAT: dict[Kind, str] = {
    "drive": "drive", "arrive": "channel", "contend": "channel", "replay": "channel",
    "deliver": "channel", "watch": "channel", "send": "channel", "take": "set", "begin": "set and step",
    "end": "get", "record": "record", "note": "note texts", "publish": "get",
}  # fmt: skip # a table


_APART: dict[Kind, str] = {"begin": "send", "end": "wait"}
"""The activity of the master where the unit is in a process of its own."""


def part_of(action: Action, plan: Plan, what: str = "", apart: bool = False) -> Part:
    """Return the part that an action belongs to; `what` is its activity, if the engine knows it exactly.

    `apart`: its unit is in a process of its own, so that the master waits while it steps.
    """
    if apart:
        what = _APART.get(action.kind, what)
    if action.kind == "drive":
        name = "stimuli"
    elif action.kind in ("record", "note"):
        name = "results"
    elif action.kind in ("arrive", "contend"):
        name = plan.timed_buses[action.index]
    elif action.kind == "replay":
        name = plan.replays[action.index].path.name
    elif action.kind in ("send", "deliver", "watch"):
        message = plan.messages[action.index]
        name = f"{message.bus}.{message.message.name}"
    else:
        name = plan.units[action.index].name
    return name, what or _WHAT[action.kind]


class Profile:
    """The seconds of each part, in the order of their first action."""

    def __init__(self) -> None:
        self.seconds: dict[Part, float] = {}
        self.clock = time.perf_counter

    def add(self, part: Part, seconds: float) -> None:
        """Add seconds to a part."""
        self.seconds[part] = self.seconds.get(part, 0.0) + seconds

    def rows(self, total: float, steps: int) -> Sequence[tuple[str, str, float, float, float]]:
        """Return name, what, seconds, microseconds a step and share of the `total` [s] of each part.

        The last two rows are the time between the parts, and the total.
        """
        rest = {("master", "between"): max(0.0, total - sum(self.seconds.values())), ("total", ""): total}
        return [
            (name, what, seconds, 1e6 * seconds / max(1, steps), seconds / total if total else 0.0)
            for (name, what), seconds in (self.seconds | rest).items()
        ]
