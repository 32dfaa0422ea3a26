"""Captures of SocketCAN frames in pcapng (IETF draft-ietf-opsawg-pcapng, link type 227), as tshark reads."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime
from typing import BinaryIO

from .candump import ERROR
from .frames import Frame

_SECTION, _INTERFACE, _PACKET = 0x0A0D0D0A, 1, 6
_SOCKETCAN = 227
_NAME, _RESOLUTION = 2, 9  # options of an interface
_FLAGS, _INBOUND, _OUTBOUND = 2, 1, 2  # an option of a packet, and its directions
_LAST_OPTION = bytes(4)
_NANOSECONDS = 9
_EXTENDED = 0x80000000
_SWITCH, _FD = 0x01, 0x04  # of the byte of flags that CAN FD has


@contextlib.contextmanager
def writing(file: BinaryIO, buses: Sequence[str], start: datetime) -> Iterator[Callable[[Frame], None]]:
    """Give a function that writes a frame; the buses are interfaces of their names."""
    file.write(_block(_SECTION, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1)))
    for bus in buses:
        options = _option(_NAME, bus.encode()) + _option(_RESOLUTION, bytes([_NANOSECONDS])) + _LAST_OPTION
        file.write(_block(_INTERFACE, struct.pack("<HHI", _SOCKETCAN, 0, 0) + options))
    begin = int(start.timestamp()) * 10**9 + start.microsecond * 1000

    def write(frame: Frame) -> None:
        m = frame.message
        flags = _FD | _SWITCH * frame.switch if frame.fd else 0
        key, payload = m.frame_id | _EXTENDED * m.extended, frame.data
        if frame.error:
            key, payload, flags = ERROR, bytes(8), 0
        data = struct.pack(">IBBxx", key, len(payload), flags) + payload
        time = begin + round(frame.time * 1e9)
        head = struct.pack("<IIIII", frame.channel, time >> 32, time & 0xFFFFFFFF, len(data), len(data))
        options = _option(_FLAGS, struct.pack("<I", _OUTBOUND if frame.sent else _INBOUND)) + _LAST_OPTION
        file.write(_block(_PACKET, head + _padded(data) + options))

    yield write


def _block(kind: int, body: bytes) -> bytes:
    length = struct.pack("<I", len(body) + 12)
    return struct.pack("<I", kind) + length + body + length


def _option(code: int, value: bytes) -> bytes:
    return struct.pack("<HH", code, len(value)) + _padded(value)


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % 4)
