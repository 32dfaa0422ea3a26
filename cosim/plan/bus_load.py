"""The load of the buses and the longest response times, known before a run from the plan's messages."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from ..can.message_settings import SendType
from ..can.timing.lengths import INTERFRAME, bit_time, frame_times
from ..can.timing.response_times import Sent, response_times
from ..clock import picoseconds
from ..errors import ConfigError
from .plan import MessagePlan

_SECOND = 10**12  # ps


@dataclasses.dataclass(frozen=True)
class MessageLoad:
    """A message of a bus: `cycle` [s], payload `length` [bytes], and what its frames take.

    `least` and `most` are the shares of the time that frames without stuff bits and the longest ones take,
    `longest` [s] the time of the longest one with the interframe space, `response` [s] the longest time from
    sampling to the end of the frame under any phases of the others; None: it has no bound.

    By its `send_type` it may be sent less often: `cycle` then is the least time between two frames, `least`
    counts those that come in any case, and with `bounded` false no minimum interval says how soon the next
    one may come, but the communication step.
    """

    name: str
    identifier: int
    extended: bool
    length: int
    cycle: float
    least: float
    most: float
    longest: float
    response: float | None
    send_type: SendType = "cyclic"
    bounded: bool = True

    @property
    def every(self) -> str:
        """The cycle in ms as text; of a message that may be sent less often, with its send type."""
        if self.send_type == "cyclic":
            return f"{1e3 * self.cycle:g}"
        return f"{self.send_type}, {'' if self.bounded else 'no min_interval: '}>= {1e3 * self.cycle:g}"


@dataclasses.dataclass(frozen=True)
class BusLoad:
    """A bus with its messages in the order of arbitration; `least` and `most` are the sums of theirs."""

    bus: str
    bitrate: int
    messages: tuple[MessageLoad, ...]

    @property
    def least(self) -> float:
        """The share of the time that the bus is busy if no frame has a stuff bit."""
        return sum(message.least for message in self.messages)

    @property
    def most(self) -> float:
        """The share of the time that the bus is busy if each frame is the longest of its kind."""
        return sum(message.most for message in self.messages)

    def as_data(self) -> dict[str, Any]:
        """Return the loads and times [s] for JSON."""
        return {
            "bus": self.bus,
            "bitrate": self.bitrate,
            "least": self.least,
            "most": self.most,
            "messages": [dataclasses.asdict(message) for message in self.messages],
        }


def bus_loads(messages: Sequence[MessagePlan], step: float) -> dict[str, BusLoad]:
    """Return the load of each bus of a plan's messages by name; `step` [s] is the communication step.

    The pages of a multiplexed message count as one message, of which a frame follows each cycle. Those whose
    frames come from a log are not among them.
    """
    found: dict[str, dict[str, list[MessagePlan]]] = {}
    for plan in (message for message in messages if not message.replayed):
        found.setdefault(plan.bus, {}).setdefault(plan.message.name, []).append(plan)
    return {bus: _load(bus, list(plans.values()), step) for bus, plans in found.items()}


def check_load(load: BusLoad, timing: str, place: str) -> str:
    """Return a warning where the longest frames would fill the bus, else "".

    Raises ConfigError, which starts with `place`, where frames are taken to arrive at once, and not even
    frames without stuff bits would fit. With `timing = "frame"` the run shows who starves.
    """
    if load.least > 1.0 and timing == "instant":
        raise ConfigError(
            f"{place}: its messages take {load.least:.1%} of {load.bitrate} bit/s without any stuff bit: no "
            'bus carries them. A higher bitrate, longer cycles, or timing = "frame", which shows who starves'
        )
    if load.least > 1.0:
        return (
            f"{place}: its messages take {load.least:.1%} of {load.bitrate} bit/s without any stuff bit: low "
            "priorities starve"
        )
    if load.most > 1.0:
        return (
            f"{place}: its messages take {load.least:.1%} to {load.most:.1%} of {load.bitrate} bit/s: with "
            "many stuff bits low priorities starve"
        )
    return ""


def _load(bus: str, groups: Sequence[Sequence[MessagePlan]], step: float) -> BusLoad:
    settings = groups[0][0].settings
    sent, about = [], {}
    for plans in groups:
        message, one = plans[0].message, plans[0]
        apart = max(one.every // len(plans), one.sending.interval)
        cycle, regular = apart * picoseconds(step), _regular(one, len(plans)) * picoseconds(step)
        kind = message.extended, message.frame_length, message.fd
        least, most = frame_times(*kind, settings.bitrate, settings.data_bitrate)
        jitter = picoseconds(settings.jitter_of(message.name))
        sent.append(Sent(message.name, message.priority, most, cycle, jitter))
        about[message.name] = one, cycle, least / regular if regular else 0.0, most
    bit = bit_time(settings.bitrate)
    responses = response_times(sent, bit, INTERFRAME * bit)
    rows = []
    for each in sorted(sent, key=lambda s: s.key):
        one, cycle, share, most = about[each.name]
        message = one.message
        response = responses[each.name]
        rows.append(
            MessageLoad(
                each.name, message.frame_id, message.extended, message.length, cycle / _SECOND, share,
                most / cycle, most / _SECOND, None if response is None else response / _SECOND,
                one.sending.kind, one.sending.kind == "cyclic" or one.sending.interval > 0,
            )
        )  # fmt: skip # fields of a row
    return BusLoad(bus, settings.bitrate, tuple(rows))


def _regular(plan: MessagePlan, pages: int) -> int:
    """Return the cycle in steps in which a frame of a message is sent in any case; 0: there is none."""
    if plan.sending.kind == "cyclic":
        return plan.every // pages
    return plan.cycle if plan.sending.regular else 0
