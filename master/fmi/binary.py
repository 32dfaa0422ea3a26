"""Shared libraries of this machine: their names in an FMU, and the check of a header before one is loaded.

The system's loader says "No such file" of a library for another machine, and ends the process over one that
is cut off. Only ELF (Linux) is looked into; elsewhere the loader's own words must do.
"""

from __future__ import annotations

import platform
import struct
import sys
from pathlib import Path

_MACHINES = {3: "x86", 40: "arm", 62: "x86_64", 183: "aarch64", 243: "riscv64"}
_OTHERS = {
    b"MZ": "a library for Windows",
    b"\xcf\xfa\xed\xfe": "a library for macOS",
    b"\xca\xfe\xba\xbe": "a library for macOS",
    b"version https://git-lfs": "a pointer of Git LFS, not the library itself",
}
_SYSTEMS = {"win32": ("win", "windows"), "darwin": ("darwin", "darwin")}
_PROCESSORS = {"arm64": "aarch64", "amd64": "x86_64", "x86pc": "x86", "i386": "x86", "i686": "x86"}
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
"""The end of the names of shared libraries."""
_HEADER, _SEGMENT = struct.Struct("<16xHHIQQQIHHH"), struct.Struct("<II5Q")
_LOADED = 1  # the type of a segment that is mapped into memory


def folder_of_libraries(version: str) -> str:
    """Return the folder in `binaries` with the libraries for this machine, by the version of FMI."""
    short, long = _SYSTEMS.get(sys.platform, (sys.platform, sys.platform))
    if version[0] in "12":
        return f"{short}{64 if sys.maxsize > 2**32 else 32}"
    machine = platform.machine().lower()
    processor = _PROCESSORS.get(machine, machine)
    narrow = processor == "x86_64" and sys.maxsize < 2**32  # Python for 32 bits on a machine of 64
    return f"{'x86' if narrow else processor}-{long}"


def problem(path: Path) -> str:
    """Return what keeps this machine from loading a library, as a clause ("it is empty"); else ""."""
    if sys.platform != "linux":
        return ""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(_HEADER.size)
        if not size:
            return "it is empty"
        if not head.startswith(b"\x7fELF"):
            kind = next((text for magic, text in _OTHERS.items() if head.startswith(magic)), "no library")
            return f"it is {kind}"
        if len(head) < _HEADER.size:
            return "it is cut off"
        if head[4:6] != b"\x02\x01":  # what follows reads 64 bits, little endian
            return "it is for 32 bits, this machine has 64" if head[4] == 1 and sys.maxsize > 2**32 else ""
        _, machine, _, _, first, _, _, _, length, count = _HEADER.unpack(head)
        here = platform.machine()
        if machine in _MACHINES and here in _MACHINES.values() and _MACHINES[machine] != here:
            return f"it is for {_MACHINES[machine]}, this machine is {here}"
        file.seek(first)
        table = file.read(length * count)
    if len(table) < length * count or length < _SEGMENT.size:
        return "it is cut off"
    for place in range(0, length * count, length):
        segment, _, offset, _, _, stored, _ = _SEGMENT.unpack_from(table, place)
        if segment == _LOADED and offset + stored > size:
            return "it is cut off"
    return ""
