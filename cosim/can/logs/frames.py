"""The frames that crossed the buses of a run, in the order of time.

A frame stands at the end of its bits where the bus has `timing = "frame"`, else at the time of the
communication point at which its message was sampled, so a receiver's value in the results is what its frame
decodes to (on a bus with a delay, that much later). Frames of one instant stand in the order in which they
would win the bus. A frame of CAN FD has one of its lengths: the bytes behind those of the message are 0.
"""

from __future__ import annotations

import dataclasses
import heapq
import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from ...clock import Clock, picoseconds
from ..database import Message, Signal
from ..transmissions import FrameLog, RawLog
from ..unfilled import raw_values


@dataclasses.dataclass(frozen=True)
class BusLog:
    """The transmissions of one bus' messages (`MessageChannel.log`), and those that were made as frames, in
    one or several logs, each in the order of time.

    `switch`: its frames of CAN FD take a data bit rate.
    """

    bus: str
    messages: Sequence[RawLog]
    frames: Sequence[FrameLog] = ()
    switch: bool = False


@dataclasses.dataclass(frozen=True)
class Frame:
    """One frame: `time` in s, `channel` the index of its bus among the logged ones.

    `data` are the bytes on the wire; `switch` tells a frame of CAN FD with the data bit rate. `sent`: a unit
    of the run sent it, else it came from outside. `error`: it is an error frame, which ended the message's.
    """

    time: float
    channel: int
    bus: str
    message: Message
    data: bytes
    switch: bool = False
    sent: bool = True
    error: bool = False

    @property
    def fd(self) -> bool:
        """True for a frame of CAN FD."""
        return self.message.fd


def frames(logs: Sequence[BusLog], clock: Clock) -> Iterator[Frame]:
    """Yield the frames of all buses in the order of time, those of one instant by arbitration; times in s.

    Signals that no connection feeds have the values of `unfilled.raw_values`.
    """
    streams = [
        _payloads(channel, log, clock) for channel, bus_log in enumerate(logs) for log in bus_log.messages
    ]
    streams += [
        _made(channel, frames, clock) for channel, bus_log in enumerate(logs) for frames in bus_log.frames
    ]
    streams += [
        _errors(channel, frames, clock) for channel, bus_log in enumerate(logs) for frames in bus_log.frames
    ]
    for time, _, channel, message, data, sent in heapq.merge(*streams, key=lambda item: item[:3]):
        log = logs[channel]
        if data is None:
            yield Frame(time, channel, log.bus, message, b"", sent=sent, error=True)
        else:
            payload = data.ljust(message.frame_length, b"\0")
            yield Frame(time, channel, log.bus, message, payload, log.switch and message.fd, sent)


_Payload = tuple[float, int, int, Message, bytes | None, bool]
"""Time [s], arbitration key, channel, message, payload (None: an error frame), True where a unit sent it."""


def _time(clock: Clock, step: int, since: int) -> float:
    return clock.at(step) + (since - step * picoseconds(clock.step)) * 1e-12


def _errors(channel: int, log: FrameLog, clock: Clock) -> Iterator[_Payload]:
    """Yield the error frames of a log, which have no payload (None)."""
    for step, since, message in log.errors():
        yield _time(clock, step, since), message.priority, channel, message, None, log.sent


def _made(channel: int, log: FrameLog, clock: Clock) -> Iterator[_Payload]:
    """Yield the frames of a log; of one instant in the order of arbitration."""
    for instant, group in itertools.groupby(log.frames(), key=lambda frame: frame[:2]):
        step, since = instant
        time = _time(clock, step, since)
        for _, _, message, data in sorted(group, key=lambda frame: frame[2].priority):
            yield time, message.priority, channel, message, data, log.sent


def _payloads(channel: int, log: RawLog, clock: Clock) -> Iterator[_Payload]:
    """Yield each transmission of one message."""
    message, order = log.message, log.message.priority
    encode = encoder(message)
    base = raw_values(message)
    before, data = None, b""
    for steps, raws in log.stretches():
        rows = zip(*(column.tolist() for column in raws.values()), strict=True)
        for k, row in zip(steps.tolist(), rows, strict=True):
            if row != before:  # a quantized value often stays
                before, data = row, encode(base | dict(zip(raws, row, strict=True)))
            yield clock.at(k), order, channel, message, data, True


def encoder(message: Message) -> Callable[[dict[str, int | float]], bytes]:
    """Return a function from the raw values of all signals to the payload, by cantools; unused bits are 0.

    Signals that no frame holds are none of them.
    """
    from cantools.database.can import Message as CodecMessage

    codec = CodecMessage(
        frame_id=message.frame_id,
        is_extended_frame=message.extended,
        name=message.name,
        length=message.length,
        signals=[_codec_signal(s) for s in map(message.signals.__getitem__, raw_values(message))],
        is_fd=message.fd,
    )

    def encode(raws: dict[str, int | float]) -> bytes:
        data: bytes = codec.encode(raws, scaling=False, strict=False)
        return data

    return encode


def _codec_signal(signal: Signal) -> Any:
    from cantools.database.can import Signal as CodecSignal
    from cantools.database.conversion import BaseConversion

    return CodecSignal(
        name=signal.name,
        start=signal.start,
        length=signal.length,
        byte_order="little_endian" if signal.little_endian else "big_endian",
        is_signed=signal.signed,
        conversion=BaseConversion.factory(is_float=signal.is_float),
    )
