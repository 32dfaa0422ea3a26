"""Ways to damage or arm an archive. Each takes the path to write and the entries of a good FMU."""

from __future__ import annotations

import io
import stat
import struct
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path

from support.hostile.case import Entries, Packing
from support.hostile.units import zipped


def _bytes(entries: Entries) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return packed.getvalue()


def of_bytes(change: Callable[[bytes], bytes]) -> Packing:
    """The archive with its bytes changed."""

    def pack(path: Path, entries: Entries) -> None:
        path.write_bytes(change(_bytes(entries)))

    return pack


def with_entry(name: str, content: bytes = b"x", mode: int = 0) -> Packing:
    """The archive with one entry more, of this Unix mode."""

    def pack(path: Path, entries: Entries) -> None:
        zipped(path, entries)
        with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # zipfile's, of a name that is there twice
            info = zipfile.ZipInfo(name)
            info.external_attr = mode << 16
            archive.writestr(info, content)

    return pack


def link(name: str) -> Packing:
    """The archive with a symbolic link to /etc."""
    return with_entry(name, b"/etc", stat.S_IFLNK | 0o777)


def with_entries(count: int) -> Packing:
    """The archive with so many empty entries more."""

    def pack(path: Path, entries: Entries) -> None:
        zipped(path, entries | {f"resources/{i}": b"" for i in range(count)})

    return pack


def in_a_folder(path: Path, entries: Entries) -> None:
    """Everything one folder deeper: somebody zipped the folder, not its content."""
    zipped(path, {f"Hostile/{name}": data for name, data in entries.items()})


def bomb(path: Path, entries: Entries) -> None:
    """100 MB of zeros in 100 kB."""
    zipped(path, entries | {"resources/zeros": bytes(100_000_000)})


def large_description(path: Path, entries: Entries) -> None:
    """A description of 65 MiB, stored as it is."""
    comment = b"<!--" + b"x" * (65 << 20) + b"-->"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in entries.items():
            archive.writestr(name, data + comment if name.endswith(".xml") else data)


def lying_about_size(path: Path, entries: Entries) -> None:
    """The first entry declares fewer bytes than it has, in both of its headers."""
    name = b"modelDescription.xml"
    size = len(entries[name.decode()])
    data, lie = bytearray(_bytes(entries)), struct.pack("<I", size // 2)
    data[22:26] = lie
    central = data.index(b"PK\x01\x02")
    data[central + 24 : central + 28] = lie
    path.write_bytes(bytes(data))


def overlapping(path: Path, entries: Entries) -> None:
    """A second entry in the central directory that points to the bytes of the first."""
    data = _bytes(entries)
    start = data.index(b"PK\x01\x02")
    end = data.index(b"PK\x05\x06")
    directory = bytearray(data[start:end])
    second = directory.index(b"PK\x01\x02", 4)
    directory[second + 42 : second + 46] = struct.pack("<I", 0)
    path.write_bytes(data[:start] + bytes(directory) + data[end:])


def method(number: int) -> Packing:
    """The archive with a method of compression that nobody knows."""

    def change(data: bytes) -> bytes:
        changed = bytearray(data)
        for place, signature in ((8, b"PK\x03\x04"), (10, b"PK\x01\x02")):
            at = changed.index(signature)
            changed[at + place : at + place + 2] = struct.pack("<H", number)
        return bytes(changed)

    return of_bytes(change)


def wrong_checksum(data: bytes) -> bytes:
    """The checksum of the first entry is another one, in both of its headers."""
    changed = bytearray(data)
    changed[14] ^= 0xFF
    changed[changed.index(b"PK\x01\x02") + 16] ^= 0xFF
    return bytes(changed)


def encrypted(data: bytes) -> bytes:
    """The first entry says that it is encrypted."""
    changed = bytearray(data)
    changed[6] |= 1
    changed[changed.index(b"PK\x01\x02") + 8] |= 1
    return bytes(changed)
