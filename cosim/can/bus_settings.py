"""The settings of a bus: one record, from a system file or a variation through the plan to the channel.

A new setting is a key of BusSettings; what acts on it finds it in `MessagePlan.settings`. If a run may vary
it for all buses, BusVariation has it too.
"""

from __future__ import annotations

import dataclasses
from numbers import Integral, Real
from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, WithJsonSchema

from ..errors import ConfigError, short
from .message_settings import SLOWEST, MessageSettings

_SLOWEST, _MOST_STEPS = 10**6, 10**6
_SEEDS = 2**63
LONGEST_DELAY = 3600.0
"""The longest delay of a bus [s] that a file or an option gives."""

Rounding = Literal["nearest", "half_even", "truncate"]
Timing = Literal["instant", "frame"]
Overflow = Literal["saturate", "wrap", "error"]
Resolution = float | Literal["ideal"]


def checked_resolution(value: Any) -> Resolution:
    """Return the factor by which signals are coarser than their DBC says, or "ideal". Raises ValueError."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if value != "ideal" and not (number and 1.0 <= value <= 1e9):
        raise ValueError('a resolution is a factor from 1 to 1e9, or "ideal"')
    return "ideal" if value == "ideal" else float(value)


_RESOLUTION_SCHEMA = {"anyOf": [{"type": "number", "minimum": 1, "maximum": 1e9}, {"const": "ideal"}]}


class BusSettings(BaseModel):
    """Settings of a CAN bus: how its senders turn values into raw values, and how it differs from its DBC."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    bitrate: int = Field(default=500_000, gt=0, le=10**9)
    """Bits a second."""

    rounding: Rounding = "nearest"
    """Rounding to a raw value: to the nearest, a half away from zero (nearest) or to the even one (half_even,
    as cantools), or toward zero (truncate, as C code that casts)."""

    overflow: Overflow = "saturate"
    """A value out of range is sent as the nearest limit (saturate), by its low bits as C code without a range
    check does (wrap), or is an error (error)."""

    delay: float = Field(default=0.0, ge=0.0, le=LONGEST_DELAY)
    """Time from sampling to the receivers' mailboxes in s: a multiple of the communication step. With `timing
    = "frame"` any time, from the end of the frame on."""

    resolution: Annotated[
        Resolution, PlainValidator(checked_resolution), WithJsonSchema(_RESOLUTION_SCHEMA)
    ] = 1.0
    """Factor from 1 on by which signals are coarser than the DBC says, or "ideal": not quantized at all."""

    cycle: int = Field(default=1, ge=1, le=_SLOWEST)
    """Factor by which messages are sent less often than the DBC says."""

    timing: Timing = "instant"
    """Frames arrive at the moment at which they are sent (instant), or wait for the bus, contend with others
    and take their bits' time (frame), so that receivers see them at the first communication point after."""

    data_bitrate: int | None = Field(default=None, gt=0, le=10**9)
    """Bits a second of the payload of CAN FD frames; without it they do not switch the bit rate."""

    jitter: float = Field(default=0.0, ge=0.0, le=SLOWEST)
    """Longest time in s from the sampling of a message to its place in the queue, drawn for each frame, with
    `timing = "frame"`."""

    bit_error_rate: float = Field(default=0.0, ge=0.0, lt=1.0)
    """Probability that a bit on the wire is wrong, with `timing = "frame"`: the frame is sent again."""

    seed: int = Field(default=0, ge=0, lt=2**63)
    """Seed of the random draws of the bus: equal ones give equal runs."""

    cycle_time: float | None = Field(default=None, gt=0.0, le=SLOWEST)
    """Cycle time in s of all messages for which neither the database nor `messages` has one."""

    fd: bool | None = None
    """Send all messages as CAN FD frames (true) or as classic ones (false); without it those are CAN FD that
    the database marks or that have more than 8 bytes. A parameter group of J1939 never is."""

    messages: dict[str, MessageSettings] = {}
    """Settings of single messages by name: a table `[buses.NAME.messages.NAME]` for each."""

    def jitter_of(self, name: str) -> float:
        """Return the longest time [s] from sampling to queue of a message: its own, else that of the bus."""
        own = self.of_message(name).jitter
        return self.jitter if own is None else own

    def of_message(self, name: str) -> MessageSettings:
        """Return the settings of the message `name`: those of no file where it has none."""
        return self.messages.get(name, MessageSettings())


_Settings = TypeVar("_Settings", bound=BusSettings)


@dataclasses.dataclass(frozen=True)
class BusVariation:
    """Changes of all buses of a system, on top of the settings that its file gives each.

    `delay_steps` communication steps are added to the delay; `resolution` multiplies the factor by which
    signals are coarser than their DBC says, "ideal" leaves quantization out; `cycle` multiplies the cycle
    time of every message; `timing`, "instant" or "frame", takes the place of theirs. `jitter` [s] is added to
    that of every message, with timing = "frame"; `loss` is the probability with which each frame is lost on
    its way to the receivers; `seed` is added to the seed of the draws. Raises ConfigError for a value that is
    none of these.
    """

    delay_steps: int = 0
    resolution: Resolution = 1.0
    cycle: int = 1
    timing: Timing | None = None
    jitter: float = 0.0
    loss: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not (_whole(self.delay_steps) and 0 <= self.delay_steps <= _MOST_STEPS):
            given = f"bus variation: delay_steps = {short(self.delay_steps)}"
            raise ConfigError(f"{given}: it is 0 or more steps, {_MOST_STEPS} at most")
        if not (_whole(self.cycle) and 1 <= self.cycle <= _SLOWEST):
            given = f"bus variation: cycle = {short(self.cycle)}"
            raise ConfigError(f"{given}: it is a whole number from 1 on, {_SLOWEST} at most")
        if self.timing is not None and self.timing not in get_args(Timing):
            given = f"bus variation: timing = {short(self.timing)}"
            raise ConfigError(f"{given}: it is {' or '.join(map(repr, get_args(Timing)))}")
        for name, most in (("jitter", SLOWEST), ("loss", 1.0)):
            value = getattr(self, name)
            if not (_real(value) and 0.0 <= value <= most):
                raise ConfigError(
                    f"bus variation: {name} = {short(value)}: it is a number from 0 to {most:g}"
                )
        if not (_whole(self.seed) and 0 <= self.seed < _SEEDS):
            raise ConfigError(
                f"bus variation: seed = {short(self.seed)}: it is a whole number from 0 to {_SEEDS - 1}"
            )
        try:
            checked_resolution(self.resolution)
        except ValueError as error:
            raise ConfigError(f"bus variation: resolution = {short(self.resolution)}: {error}") from error

    def of(self, settings: _Settings, step_size: float) -> _Settings:
        """Return the settings with this variation on top; `step_size` in s."""
        ideal = "ideal" in (settings.resolution, self.resolution)
        return settings.model_copy(
            update={
                "delay": settings.delay + self.delay_steps * step_size,
                "resolution": "ideal" if ideal else float(settings.resolution) * float(self.resolution),
                "cycle": settings.cycle * self.cycle,
                "timing": self.timing or settings.timing,
                "jitter": settings.jitter + float(self.jitter),
                "seed": (settings.seed + int(self.seed)) % _SEEDS,
                "messages": {name: self._of_message(own) for name, own in settings.messages.items()},
            }
        )

    def _of_message(self, own: MessageSettings) -> MessageSettings:
        if own.jitter is None or not self.jitter:
            return own
        return own.model_copy(update={"jitter": own.jitter + float(self.jitter)})


def _real(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)
