"""Ways to damage the library of an FMU, byte by byte."""

from __future__ import annotations

from collections.abc import Callable

from support.hostile.case import Entries
from support.hostile.units import binary

Change = Callable[[bytes], bytes]


def library(change: Change) -> Callable[[Entries, int], Entries]:
    """The entries with the library changed."""

    def mutate(entries: Entries, fmi: int) -> Entries:
        return entries | {binary(fmi): change(entries[binary(fmi)])}

    return mutate


def without(function: str) -> Callable[[Entries, int], Entries]:
    """The library without a C function, named as in FMI 2.0 behind its prefix."""

    def mutate(entries: Entries, fmi: int) -> Entries:
        name = f"fmi{fmi}{function}".encode() + b"\0"
        before = entries[binary(fmi)]
        assert name in before
        return entries | {binary(fmi): before.replace(name, name[:-2] + b"_\0")}

    return mutate


def for_another_machine(content: bytes) -> bytes:
    """An ELF library for AArch64."""
    return content[:18] + (183).to_bytes(2, "little") + content[20:]


def without_its_dependency(content: bytes) -> bytes:
    """It needs a library that nobody has."""
    assert b"libc.so.6\0" in content
    return content.replace(b"libc.so.6\0", b"libq.so.6\0")


def nothing(content: bytes) -> bytes:
    """No bytes."""
    return b""


def for_windows(content: bytes) -> bytes:
    """What a DLL begins with."""
    return b"MZ\x90\x00" + bytes(4096)


def cut(content: bytes) -> bytes:
    """The first half."""
    return content[: len(content) // 2]
