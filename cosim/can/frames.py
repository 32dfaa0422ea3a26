"""The frames that crossed a bus, as a log file that other tools read: candump, BLF or ASC.

A frame stands at the time of the communication point at which its message was sampled, so a receiver's
value in the results is what its frame decodes to (on a bus with a delay, that much later). Frames of one
instant stand in the order in which they would win the bus: by frame id.

The same run writes the same bytes: times count from the start of the run's clock, and no file holds the
date at which it was written. ASC, which needs a date, has a fixed one; BLF has none.
"""

from __future__ import annotations

import contextlib
import dataclasses
import heapq
import io
import itertools
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from ..clock import Clock, picoseconds
from ..errors import ConfigError
from ..writing import replacing
from .database import Message, Signal
from .timing.arbitration import arbitration_key
from .transmissions import FrameLog, RawLog

_ASC_DATE = "Thu Jan 01 00:00:00.000 1970"


@dataclasses.dataclass(frozen=True)
class BusLog:
    """The transmissions of one bus' messages (`MessageChannel.log`), and those that were made as frames."""

    bus: str
    messages: Sequence[RawLog]
    frames: FrameLog | None = None


@dataclasses.dataclass(frozen=True)
class Frame:
    """One frame: `time` in s, `channel` the index of its bus among the logged ones."""

    time: float
    channel: int
    bus: str
    message: Message
    data: bytes


def write_can_log(path: str | Path, logs: Sequence[BusLog], clock: Clock) -> int:
    """Write the frames of `logs` in the format that the file's suffix names; return how many there were.

    `.log` is candump's, `.blf` and `.asc` are Vector's. `clock` is the run's.
    Signals that no connection feeds are sent with their start value. Written frame by frame. Raises
    ConfigError for another suffix or where the file cannot be written.
    """
    path = Path(path)
    check_suffix(path)
    count = 0
    with replacing(path) as file, _FORMATS[path.suffix.lower()](file) as write:
        for frame in frames(logs, clock):
            write(frame)
            count += 1
    return count


def check_suffix(path: str | Path) -> None:
    """Raise ConfigError when no log format has this file's suffix."""
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise ConfigError(f"{path}: CAN logs are written as {', '.join(_FORMATS)}, not as '{suffix}'")


def frames(logs: Sequence[BusLog], clock: Clock) -> Iterator[Frame]:
    """Yield the frames of all buses in the order of time, those of one instant by frame id; times in s."""
    streams = [
        _payloads(channel, log, clock) for channel, bus_log in enumerate(logs) for log in bus_log.messages
    ]
    streams += [
        _made(channel, bus_log.frames, clock)
        for channel, bus_log in enumerate(logs)
        if bus_log.frames is not None
    ]
    for time, _, channel, message, data in heapq.merge(*streams, key=lambda item: item[:3]):
        yield Frame(time, channel, logs[channel].bus, message, data)


_Payload = tuple[float, int, int, Message, bytes]


def _key(message: Message) -> int:
    return arbitration_key(message.frame_id, message.extended)


def _made(channel: int, log: FrameLog, clock: Clock) -> Iterator[_Payload]:
    """Yield time [s], arbitration key, channel, message and payload of the frames of a log."""
    for instant, group in itertools.groupby(log.frames(), key=lambda frame: frame[:2]):
        step, since = instant
        time = clock.at(step) + (since - step * picoseconds(clock.step)) * 1e-12
        for _, _, message, data in sorted(group, key=lambda frame: _key(frame[2])):
            yield time, _key(message), channel, message, data


def _payloads(channel: int, log: RawLog, clock: Clock) -> Iterator[_Payload]:
    """Yield time [s], arbitration key, channel, message and payload of each transmission of one message."""
    message, order = log.message, _key(log.message)
    encode = encoder(message)
    start = {s.name: s.start_raw for s in message.signals.values()}
    before, data = None, b""
    for steps, raws in log.stretches():
        rows = zip(*(column.tolist() for column in raws.values()), strict=True)
        for k, row in zip(steps.tolist(), rows, strict=True):
            if row != before:  # a quantized value often stays
                before, data = row, encode(start | dict(zip(raws, row, strict=True)))
            yield clock.at(k), order, channel, message, data


def encoder(message: Message) -> Callable[[dict[str, int | float]], bytes]:
    """Return a function from the raw values of all signals to the payload, by cantools; unused bits are 0."""
    from cantools.database.can import Message as CodecMessage

    codec = CodecMessage(
        frame_id=message.frame_id,
        is_extended_frame=message.extended,
        name=message.name,
        length=message.length,
        signals=[_codec_signal(s) for s in message.signals.values()],
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


# ---- formats ----


@contextlib.contextmanager
def _candump(file: BinaryIO) -> Iterator[Callable[[Frame], None]]:
    """Write as candump -L does. Lines of python-can's writer end in the direction, which tshark refuses."""
    with _text(file) as lines:

        def write(frame: Frame) -> None:
            m = frame.message
            frame_id = f"{m.frame_id:08X}" if m.extended else f"{m.frame_id:03X}"
            separator = "##0" if m.fd else "#"  # CAN FD: no bit rate switch
            payload = frame.data.hex().upper()
            lines.write(f"({frame.time:.6f}) {frame.bus} {frame_id}{separator}{payload}\n")

        yield write


@contextlib.contextmanager
def _blf(file: BinaryIO) -> Iterator[Callable[[Frame], None]]:
    import can

    with contextlib.closing(_Stopped(can.BLFWriter(file))) as log:
        log.writer.start_timestamp = 0.0  # else times count from the first frame

        def write(frame: Frame) -> None:
            # the writer cuts times to whole nanoseconds; half of one more makes it round
            log.writer.on_message_received(_can_message(frame, frame.time + 0.5e-9))

        yield write


@contextlib.contextmanager
def _asc(file: BinaryIO) -> Iterator[Callable[[Frame], None]]:
    import can

    class FixedDateWriter(can.ASCWriter):  # type: ignore[misc] # python-can is not followed by mypy
        """Writes _ASC_DATE where python-can writes the date of today, in the local time zone and language."""

        def _format_header_datetime(self, dt: object) -> str:
            return _ASC_DATE

    with _text(file) as lines, contextlib.closing(_Stopped(FixedDateWriter(lines))) as log:
        lines.write(f"Begin Triggerblock {_ASC_DATE}\n")
        log.writer.header_written = True  # else times count from the first frame
        log.writer.log_event("Start of measurement", 0.0)

        def write(frame: Frame) -> None:
            log.writer.on_message_received(_can_message(frame, frame.time))

        yield write


def _text(file: BinaryIO) -> io.TextIOWrapper:
    return io.TextIOWrapper(file, encoding="ascii", newline="\n")


@dataclasses.dataclass(frozen=True)
class _Stopped:
    """A python-can writer to be closed: its `stop` writes the end of the file."""

    writer: Any

    def close(self) -> None:
        self.writer.stop()


def _can_message(frame: Frame, timestamp: float) -> Any:
    import can

    return can.Message(
        timestamp=timestamp,
        arbitration_id=frame.message.frame_id,
        is_extended_id=frame.message.extended,
        is_fd=frame.message.fd,
        channel=frame.channel,
        data=frame.data,
    )


_FORMATS: dict[str, Callable[[BinaryIO], contextlib.AbstractContextManager[Callable[[Frame], None]]]] = {
    ".log": _candump,
    ".blf": _blf,
    ".asc": _asc,
}
