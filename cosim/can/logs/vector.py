"""The logs of Vector's tools, ASC and BLF, by python-can."""

from __future__ import annotations

import contextlib
import dataclasses
import io
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any, BinaryIO

from .frames import Frame

_DAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


@contextlib.contextmanager
def writing_blf(file: BinaryIO, buses: Sequence[str], start: datetime) -> Iterator[Callable[[Frame], None]]:
    """Give a function that writes a frame to a BLF file, whose header has the start in UTC."""
    import can

    with contextlib.closing(_Stopped(can.BLFWriter(file))) as log:
        log.writer.start_timestamp = 0.0  # else times count from the first frame
        last = 0.0

        def write(frame: Frame) -> None:
            nonlocal last
            last = frame.time
            # the writer cuts times to whole nanoseconds; half of one more makes it round
            log.writer.on_message_received(_message(frame, frame.time + 0.5e-9))

        yield write
        # the header is written last: times that were counted from there would have lost their nanoseconds
        log.writer.start_timestamp = start.timestamp()
        log.writer.stop_timestamp = start.timestamp() + last


@contextlib.contextmanager
def writing_asc(file: BinaryIO, buses: Sequence[str], start: datetime) -> Iterator[Callable[[Frame], None]]:
    """Give a function that writes a frame to an ASC file, whose date is the start in UTC."""
    import can

    date = _date(start)

    class FixedDateWriter(can.ASCWriter):  # type: ignore[misc] # python-can is not followed by mypy
        """Writes the start where python-can writes today, in the local time zone and language."""

        def _format_header_datetime(self, dt: object) -> str:
            return date

    lines = io.TextIOWrapper(file, encoding="ascii", newline="\n")
    with lines, contextlib.closing(_Stopped(FixedDateWriter(lines))) as log:
        for number, bus in enumerate(buses, 1):
            lines.write(f"// channel {number}: {bus.encode('ascii', 'backslashreplace').decode()}\n")
        lines.write(f"Begin Triggerblock {date}\n")
        log.writer.header_written = True  # else times count from the first frame
        log.writer.log_event("Start of measurement", 0.0)

        def write(frame: Frame) -> None:
            log.writer.on_message_received(_message(frame, frame.time))

        yield write


def _date(start: datetime) -> str:
    """Return the start in UTC as ASC writes dates, in English wherever the program runs."""
    utc = start.astimezone(UTC)
    day, month = _DAYS[utc.weekday()], _MONTHS[utc.month - 1]
    return f"{day} {month} {utc:%d %H:%M:%S}.{utc.microsecond // 1000:03d} {utc.year}"


@dataclasses.dataclass(frozen=True)
class _Stopped:
    """A python-can writer to be closed: its `stop` writes the end of the file."""

    writer: Any

    def close(self) -> None:
        self.writer.stop()


def _message(frame: Frame, timestamp: float) -> Any:
    import can

    if frame.error:
        return can.Message(
            timestamp=timestamp, is_error_frame=True, is_rx=not frame.sent, channel=frame.channel
        )
    return can.Message(
        timestamp=timestamp,
        arbitration_id=frame.message.frame_id,
        is_extended_id=frame.message.extended,
        is_fd=frame.fd,
        bitrate_switch=frame.switch,
        is_rx=not frame.sent,
        channel=frame.channel,
        data=frame.data,
        dlc=len(frame.data),
    )
