"""The log of candump -L: a line of text for each frame."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime
from typing import BinaryIO

from .frames import Frame

ERROR = 0x20000088
"""The identifier of an error frame in SocketCAN, of the classes protocol and bus error; it has 8 bytes."""
_SWITCH = 1  # the flag of a CAN FD frame with the data bit rate (CANFD_BRS)


@contextlib.contextmanager
def writing(file: BinaryIO, buses: Sequence[str], start: datetime) -> Iterator[Callable[[Frame], None]]:
    """Give a function that writes a frame. Lines have no direction, which tshark would refuse."""
    seconds = int(start.timestamp())
    fraction = start.microsecond
    with io.TextIOWrapper(file, encoding="ascii", newline="\n") as lines:

        def write(frame: Frame) -> None:
            whole, microseconds = divmod(fraction + round(frame.time * 1e6), 1_000_000)
            if frame.error:
                lines.write(
                    f"({seconds + whole}.{microseconds:06d}) {frame.bus} {ERROR:08X}#{bytes(8).hex()}\n"
                )
                return
            m = frame.message
            frame_id = f"{m.frame_id:08X}" if m.extended else f"{m.frame_id:03X}"
            separator = f"##{_SWITCH * frame.switch:X}" if frame.fd else "#"
            payload = frame.data.hex().upper()
            lines.write(
                f"({seconds + whole}.{microseconds:06d}) {frame.bus} {frame_id}{separator}{payload}\n"
            )

        yield write
