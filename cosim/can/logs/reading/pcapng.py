"""Reading SocketCAN frames from captures in pcapng, as tshark and Wireshark write them."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

from .blocks import Block, blocks_of
from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE, LoggedFrame, damaged

_SECTION, _INTERFACE, _PACKET = 0x0A0D0D0A, 1, 6
_ORDER = 0x1A2B3C4D
_SOCKETCAN = 227
_NAME, _RESOLUTION, _OFFSET = 2, 9, 14  # options of an interface
_EXTENDED, _REMOTE, _ERROR = 0x80000000, 0x40000000, 0x20000000
_ID = 0x1FFFFFFF
_LARGEST = 16 << 20  # bytes of a block


class _Interface(NamedTuple):
    """An interface: its name, link type, units of time in a second, and what is added to times [s]."""

    name: str
    link: int
    parts: int
    offset: int


def reading(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a capture. Raises ConfigError, which names the byte, where it is damaged."""
    return blocks_of(_frames(file, path))


def _frames(file: BinaryIO, path: Path) -> Iterator[LoggedFrame]:
    """Yield the frames of a capture. Raises ConfigError, which names the byte, where it is damaged."""
    size, place, order = os.fstat(file.fileno()).st_size, 0, "<"
    interfaces: list[_Interface] = []
    while place < size:
        file.seek(place)
        head = file.read(12)
        where = f"byte {place}"
        if len(head) < 12:
            raise damaged(path, where, f"the capture is cut off: {len(head)} bytes are left of a block")
        (kind,) = struct.unpack(order + "I", head[:4])
        if kind == _SECTION:
            order = _order(head[8:], path, where)
            interfaces = []
        elif place == 0:
            raise damaged(path, where, "the file does not begin as a pcapng capture does")
        (length,) = struct.unpack(order + "I", head[4:8])
        if length < 12 or length % 4 or length > _LARGEST:
            raise damaged(path, where, f"a block has {length} bytes: the capture is damaged")
        if place + length > size:
            raise damaged(path, where, f"the capture is cut off: {size - place} bytes are left of {length}")
        body = head[8:] + file.read(length - 12)
        try:
            if kind == _INTERFACE:
                interfaces.append(_interface(body[:-4], order, len(interfaces)))
            elif kind == _PACKET and (frame := _frame(body[:-4], order, interfaces, place)):
                yield frame
        except (struct.error, IndexError, OverflowError, ValueError) as error:
            raise damaged(path, where, f"the block is damaged: {error}") from error
        place += length


def _order(mark: bytes, path: Path, where: str) -> str:
    for order in "<>":
        if struct.unpack(order + "I", mark)[0] == _ORDER:
            return order
    raise damaged(path, where, "a section of the capture has no byte order")


def _interface(body: bytes, order: str, number: int) -> _Interface:
    (link,) = struct.unpack_from(order + "H", body)
    name, parts, offset, at = str(number + 1), 10**6, 0, 8
    while at + 4 <= len(body):
        code, length = struct.unpack_from(order + "HH", body, at)
        value = body[at + 4 : at + 4 + length]
        if code == _NAME:
            name = value.decode("utf-8", errors="replace")
        elif code == _RESOLUTION:
            parts = 2 ** (value[0] & 127) if value[0] & 128 else 10 ** min(value[0], 30)
        elif code == _OFFSET:
            (offset,) = struct.unpack(order + "q", value)
        at += 4 + length + -length % 4
    return _Interface(name, link, parts, offset)


def _frame(body: bytes, order: str, interfaces: list[_Interface], place: int) -> LoggedFrame | None:
    """Return the frame of a packet; None where it is of no CAN interface."""
    number, high, low, captured, _ = struct.unpack_from(order + "IIIII", body)
    interface = interfaces[number]
    if interface.link != _SOCKETCAN:
        return None
    packet = body[20 : 20 + captured]
    key, length = struct.unpack_from(">IB", packet)
    time = (high << 32 | low) * 10**9 // interface.parts + interface.offset * 10**9
    if not -LATEST < time < LATEST:
        raise ValueError(f"a time of {time} ns")
    kind = ERROR if key & _ERROR else REMOTE if key & _REMOTE else DATA
    data = packet[8 : 8 + length] if kind == DATA else b""
    if kind == DATA and (length > MOST_BYTES or len(data) < length):
        raise ValueError(f"a frame of {length} bytes, of which {len(data)} are there")
    resolution = max(1, 10**9 // interface.parts)
    return LoggedFrame(time, interface.name, key & _ID, bool(key & _EXTENDED), data, place, kind, resolution)
