"""Reading Vector's binary logs (BLF): objects, most of them in containers that are compressed by zlib.

The layout is that which python-can reads and writes. An object may begin in one container and end in the
next. Only frames of CAN are read; objects of other kinds are passed over.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from .blocks import FRAME, Block, Channels, set_frame
from .logged import DATA, ERROR, LATEST, MOST_BYTES, REMOTE, LoggedFrame, damaged

_FILE = struct.Struct("<4sL8xQ")  # mark, length of the header, length of the file
_OBJECT = struct.Struct("<4sHHLL")  # mark, length of the header and its version, length, kind
_TIME = struct.Struct("<LHHQ")  # flags and, behind two more, the time; the same place in both versions
_CONTAINER = struct.Struct("<H6xL4x")
_CLASSIC = struct.Struct("<HBBL8s")
_FD = struct.Struct("<HBBLLBBB5x64s")
_FD_64 = struct.Struct("<BBBBLLLLLLLHBBL")
_MARK, _HEADER = b"LOBJ", 16
_IN_CONTAINER, _ERRORS = 10, (2, 73, 104)
_CLASSICS, _FD_MESSAGE, _FD_MESSAGE_64 = (1, 86), 100, 101
_PLAIN, _DEFLATED = 0, 2
_LARGEST = 16 << 20  # bytes of an object, and that a container unpacks to; Vector's have 128 kB
_TEN_MICROSECONDS = 1  # of the flags: the unit of the time; else it is 1 ns
_EXTENDED, _ID = 0x80000000, 0x1FFFFFFF
_REMOTE, _FD_REMOTE = 0x80, 0x10
_FEW = 4  # objects that are read one by one
_LEAST = _HEADER + _TIME.size  # where the frame of an object begins at the earliest
_TIMES = np.dtype([("flags", "<u4"), ("more", "<u4"), ("time", "<u8")])
_CLASSIC_ROWS = np.dtype(
    [("channel", "<u2"), ("flags", "u1"), ("count", "u1"), ("id", "<u4"), ("data", "u1", (8,))]
)


def reading(file: BinaryIO, path: Path) -> Iterator[Block]:
    """Yield the frames of a log. Raises ConfigError, which names the byte, where the file is cut off."""
    size = os.fstat(file.fileno()).st_size
    head = file.read(_FILE.size)
    if len(head) < _FILE.size or head[:4] != b"LOGG":
        raise damaged(path, "byte 0", "the file does not begin as a BLF log does, with LOGG")
    _, begin, told = _FILE.unpack(head)
    if told > size:
        raise _cut(path, size, f"the file has {size} of the {told} bytes that its header tells")
    place, rest, channels = begin, b"", Channels()
    while place < size:
        file.seek(place)
        place += max(0, file.read(8 + len(_MARK)).find(_MARK))  # padding is before it
        file.seek(place)
        head = file.read(_HEADER)
        if len(head) < _HEADER:
            if not head.strip(b"\0"):
                break  # padding at the end
            raise _cut(path, place, f"{len(head)} bytes are left, and an object has {_HEADER} at least")
        mark, _, _, length, kind = _OBJECT.unpack(head)
        if mark != _MARK or length < _HEADER:
            raise damaged(path, f"byte {place}", "there is no object of a BLF log: the file is damaged")
        if place + length > size:
            raise _cut(path, place, f"{size - place} bytes are left of an object of {length}")
        if kind == _IN_CONTAINER:
            rest += _unpacked(file.read(length - _HEADER), path, place)
            objects = _Objects(rest, path, place, channels)
            yield objects.block()
            rest = objects.left
        elif length <= _LARGEST:
            yield _Objects(head + file.read(length - _HEADER), path, place, channels).block()
        place += length
    if len(rest) >= _HEADER and rest.find(_MARK) >= 0:
        raise _cut(path, size, f"the last object has {len(rest)} bytes, and is longer")


def _cut(path: Path, place: int, problem: str) -> Exception:
    return damaged(path, f"byte {place}", f"the BLF log is cut off: {problem}")


def _unpacked(data: bytes, path: Path, place: int) -> bytes:
    """Return the bytes of a container. Raises ConfigError where they are none, or too many."""
    if len(data) < _CONTAINER.size:
        raise damaged(path, f"byte {place}", "a container is shorter than its header")
    method, _ = _CONTAINER.unpack_from(data)
    packed = data[_CONTAINER.size :]
    if method == _PLAIN:
        return packed
    if method != _DEFLATED:
        raise damaged(path, f"byte {place}", f"a container is compressed by method {method}, not by zlib")
    unpacker = zlib.decompressobj()
    try:
        found = unpacker.decompress(packed, _LARGEST)
    except zlib.error as error:
        raise damaged(path, f"byte {place}", f"a container cannot be unpacked: {error}") from error
    if unpacker.unconsumed_tail:
        raise damaged(path, f"byte {place}", f"a container unpacks to more than {_LARGEST} bytes")
    if not unpacker.eof:
        raise damaged(path, f"byte {place}", "a container ends within its compressed bytes")
    return found


class _Objects:
    """The objects in the bytes of a container and what was left of the one before; `left` are those after."""

    def __init__(self, data: bytes, path: Path, place: int, channels: Channels) -> None:
        self._data, self._path, self._place, self._channels = data, path, place, channels
        self.left = b""

    def block(self) -> Block:
        """Return the frames in the order of the objects. Raises ConfigError where one is damaged."""
        data, at, parts = self._data, 0, [np.zeros(0, dtype=FRAME)]
        single: list[LoggedFrame] = []
        while len(data) - at >= 8:
            found = data.find(_MARK, at, at + 8)  # padding is before it
            if found < 0:
                raise damaged(
                    self._path, f"byte {self._place}", f"no object at byte {at} of a container's content"
                )
            at = found
            if len(data) - at < _HEADER:
                break
            _, header, version, length, kind = _OBJECT.unpack_from(data, at)
            if length < _HEADER or length > _LARGEST:
                raise damaged(self._path, f"byte {self._place}", f"an object has {length} bytes")
            if at + length > len(data):
                break  # it goes on in the next container
            if kind in _CLASSICS and (rows := self._alike(at, header, version, length)) is not None:
                parts += [self._rows(single), rows]
                single, at = [], at + length * len(rows)
                continue
            single += self._frame(data[at : at + length], header, version, kind)
            at += length
        self.left = data[at:]
        return Block(np.concatenate([*parts, self._rows(single)]), self._channels.names)

    def _rows(self, frames: list[LoggedFrame]) -> NDArray[Any]:
        rows = np.zeros(len(frames), dtype=FRAME)
        for i, frame in enumerate(frames):
            set_frame(rows, i, frame, self._channels)
        return rows

    def _alike(self, at: int, header: int, version: int, length: int) -> NDArray[Any] | None:
        """Return the frames of this object and of those behind it that begin with the same numbers.

        None where there are few, or one of them needs a closer look.
        """
        most = (len(self._data) - at) // length
        if version not in (1, 2) or length % 4 or length < (begin := max(header, _LEAST)) + _CLASSIC.size:
            return None
        if most < _FEW or self._data[at + length : at + length + _HEADER] != self._data[at : at + _HEADER]:
            return None
        whole = np.frombuffer(self._data, dtype=np.uint8, count=most * length, offset=at)
        table = whole.reshape(most, length)
        other = np.flatnonzero((table[:, :_HEADER] != table[0, :_HEADER]).any(axis=1))
        table = table[: int(other[0]) if len(other) else most]
        times = np.ascontiguousarray(table[:, _HEADER : _HEADER + _TIME.size]).view(_TIMES)[:, 0]
        frames = np.ascontiguousarray(table[:, begin : begin + _CLASSIC.size]).view(_CLASSIC_ROWS)[:, 0]
        rows = np.zeros(len(table), dtype=FRAME)
        rows["resolution"] = np.where(times["flags"] == _TEN_MICROSECONDS, 10_000, 1)
        if (times["time"] >= LATEST).any() or (frames["flags"] & _REMOTE).any():
            return None
        rows["time"] = times["time"]
        if (rows["time"] >= LATEST // rows["resolution"]).any() or (frames["count"] > MOST_BYTES).any():
            return None
        rows["time"] *= rows["resolution"]
        rows["place"], rows["kind"] = self._place, DATA
        rows["frame_id"], rows["extended"] = frames["id"] & _ID, frames["id"] & _EXTENDED != 0
        rows["length"] = np.minimum(frames["count"], 8)
        rows["data"][:, :8] = np.where(np.arange(8) < rows["length"][:, None], frames["data"], 0)
        for number in np.unique(frames["channel"]).tolist():
            rows["channel"][frames["channel"] == number] = self._channels.place(str(number))
        return rows

    def _frame(self, one: bytes, header: int, version: int, kind: int) -> Iterator[LoggedFrame]:
        known = kind in _CLASSICS or kind in _ERRORS or kind in (_FD_MESSAGE, _FD_MESSAGE_64)
        if not known or version not in (1, 2):
            return
        try:
            flags, _, _, time = _TIME.unpack_from(one, _HEADER)
            resolution = 10_000 if flags == _TEN_MICROSECONDS else 1
            time *= resolution
            if not time < LATEST:
                raise struct.error(f"a time of {time} ns")
            yield LoggedFrame(*self._of_kind(one, header, kind, time)[:-1], resolution)
        except struct.error as error:
            raise damaged(
                self._path, f"byte {self._place}", f"a frame (object {kind}) is damaged: {error}"
            ) from error

    def _of_kind(self, one: bytes, at: int, kind: int, time: int) -> LoggedFrame:
        at = max(at, _LEAST)
        if kind in _ERRORS:
            (channel,) = struct.unpack_from("<H", one, at)
            return LoggedFrame(time, str(channel), 0, False, b"", self._place, ERROR)
        if kind == _FD_MESSAGE_64:
            channel, _, count, _, key, _, flags, *_, beyond, _ = _FD_64.unpack_from(one, at)
            begin = at + _FD_64.size
            data = one[begin : min(begin + count, beyond or len(one))].ljust(count, b"\0")
            remote = flags & _FD_REMOTE
        elif kind == _FD_MESSAGE:
            channel, flags, _, key, _, _, _, count, data = _FD.unpack_from(one, at)
            remote, data = flags & _REMOTE, data[:count]
        else:
            channel, flags, count, key, data = _CLASSIC.unpack_from(one, at)
            remote, data = flags & _REMOTE, data[: min(count, 8)]
        if count > MOST_BYTES:
            raise struct.error(f"it has {count} bytes")
        if remote:
            data = b""
        frame_id, extended = key & _ID, bool(key & _EXTENDED)
        return LoggedFrame(
            time, str(channel), frame_id, extended, data, self._place, REMOTE if remote else DATA
        )
