"""The settings of one message of a bus: one record, from a system file through the plan to what sends it.

A new setting of a message is a key of MessageSettings; what acts on it asks `BusSettings.of_message`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

SLOWEST = 3600.0
"""The longest cycle time and start delay [s] that a system file gives a message."""


SendType = Literal["cyclic", "on_change", "cyclic_and_on_change", "if_active", "on_write"]

_DataId = Annotated[int, Field(ge=0, le=0xFFFF)]


class E2eSettings(BaseModel):
    """End-to-end protection of a message by a profile of AUTOSAR: what fills its checksum and its counter."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    profile: Literal["1A", "1B", "1C", "2", "5"]
    """The profile; 1A, 1B and 1C are profile 1 with both bytes of the data ID in the checksum, with one by
    turns, and with the low one alone."""

    data_id: _DataId | list[_DataId]
    """Number that sender and receiver know, from 0 to 65535; profile 2 has 16 from 0 to 255."""

    crc: str
    """The signal of the checksum: 8 bits that are one byte, in profile 5 16 that are two, low byte first."""

    counter: str
    """The signal of the counter: 4 bits, in profile 5 8."""

    nibble: str | None = None
    """The signal of 4 bits that has a part of the data ID, in profile 1C."""

    max_delta: int = Field(default=1, ge=1, le=255)
    """Steps of the counter from one frame that is taken to the next, one more for each cycle without."""


class MessageSettings(BaseModel):
    """Settings of one message, in place of those that its database has."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    cycle_time: float | None = Field(default=None, gt=0.0, le=SLOWEST)
    """Time from one transmission to the next in s, a multiple of the communication step; without it that of
    the database, else the bus' `cycle_time`."""

    jitter: float | None = Field(default=None, ge=0.0, le=SLOWEST)
    """Longest time in s from the sampling to the queue, with `timing = "frame"`; without it the bus' own."""

    send_type: SendType | None = None
    """When it is sent: each cycle (cyclic), when its bits have changed since the last look (on_change), both
    (cyclic_and_on_change), each cycle while a signal is not at its inactive value (if_active), with each step
    of its sender (on_write); without it that of the database, but cyclic with a `cycle_time` here."""

    min_interval: float | None = Field(default=None, gt=0.0, le=SLOWEST)
    """Least time in s from one frame to the next where it is not cyclic, a multiple of the communication
    step; without it that of the database."""

    start_delay: float | None = Field(default=None, ge=0.0, le=SLOWEST)
    """Time of the first transmission after the start in s; without it that of the database, else 0."""

    fd: bool | None = None
    """Send it as a CAN FD frame (true) or as a classic one (false); without it as the bus' `fd` says."""

    timeout: int | None = Field(default=None, ge=1, le=10**6)
    """Cycles without a frame that is taken until the receivers get what `on_timeout` says."""

    on_timeout: Literal["hold", "initial", "sna"] = "hold"
    """Values of the receivers after a timeout: the last ones (hold), those before the first frame (initial),
    or those of the signals' "not available" codes, where they have one (sna)."""

    initial: dict[str, FiniteFloat] = Field(default={}, examples=[{"EMD_VehicleSpeed": 0.0}])
    """Values of signals at their receivers before the first frame, and after a timeout with `on_timeout =
    "initial"`, in the signals' units of measure; `initial` of a connection counts before it."""

    e2e: E2eSettings | None = None
    """Protection by counter and checksum: frames that break it are not taken."""

    checksum: str | None = Field(default=None, pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")
    """A maker's own checksum in place of `e2e`: "module:function", a function in Python of a module beside
    the system file, or of an installed one. It gets the payload, in which the checksum is 0, the identifier
    and the counter, -1 without one, and returns the number that `checksum_signal` has."""

    checksum_signal: str | None = None
    """The signal of the checksum: 32 bits at most."""

    checksum_counter: str | None = None
    """The signal of the counter, 16 bits at most, from 0 to its maximum; without it frames have none."""

    checksum_max_delta: int | None = Field(default=None, ge=1, le=2**16 - 1)
    """Steps of that counter from one frame that is taken to the next, one more for each cycle without; 1
    where it is not given."""

    status: list[str] = []
    """Inputs that receive the status of the last frame, as "unit.input": with `e2e` 0 ok, 1 no new data,
    2 wrong CRC, 4 the first one, 8 repeated, 32 some lost, 64 wrong sequence; with `timeout`
    alone 1 after one."""

    status_optional: bool = False
    """Leave an input of `status` out, with a warning, where the unit's FMU does not have it."""

    @property
    def protected(self) -> bool:
        """True where its frames have a checksum that receivers judge."""
        return self.e2e is not None or self.checksum is not None
