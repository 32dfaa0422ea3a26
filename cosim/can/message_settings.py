"""The settings of one message of a bus: one record, from a system file through the plan to what sends it.

A new setting of a message is a key of MessageSettings; what acts on it asks `BusSettings.of_message`.
"""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

SLOWEST = 3600.0
"""The longest cycle time and start delay [s] that a system file gives a message."""


class MessageSettings(BaseModel):
    """Settings of one message, in place of those that its database has."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    cycle_time: float | None = Field(default=None, gt=0.0, le=SLOWEST)
    """Time from one transmission to the next in s, a multiple of the communication step; without it that of
    the database, else the bus' `cycle_time`."""

    jitter: float | None = Field(default=None, ge=0.0, le=SLOWEST)
    """Longest time in s from the sampling to the queue, with `timing = "frame"`; without it the bus' own."""

    start_delay: float | None = Field(default=None, ge=0.0, le=SLOWEST)
    """Time of the first transmission after the start in s; without it that of the database, else 0."""

    fd: bool | None = None
    """Send it as a CAN FD frame (true) or as a classic one (false); without it as the bus' `fd` says."""
