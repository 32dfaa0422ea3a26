"""The signal handler of a crash report in machine code, which runs where Python cannot run any more.

It is void crashed(int signal): write two texts, then let the same signal end the process as it does by
default. For x86-64 Linux it stands here, instruction by instruction, since to import LLVM takes longer than
all else that a run of a native unit does before its first step; elsewhere LLVM compiles it.
"""

from __future__ import annotations

import mmap
import os
import platform
import struct
import sys
from typing import Any, NamedTuple

_STDERR = 2


class Addresses(NamedTuple):
    """All that the handler uses: its table of three addresses, and the C functions write, signal and raise.

    The table has the address of a table of texts, of the cell with the number of one of them, and of another
    text. A text is two int64: the address of its characters and their number.
    """

    root: int
    write: int
    signal: int
    again: int


class Handler(NamedTuple):
    """The handler's address, which holds as long as `owner` is there."""

    address: int
    owner: Any


def handler(about: Addresses) -> Handler:
    """Return the handler in the memory of this process. Raises OSError where no code can be put there."""
    if sys.platform == "linux" and platform.machine() == "x86_64":
        return _mapped(_instructions(about))
    return _compiled(about)


def _mapped(code: bytes) -> Handler:
    """Put code into memory where it can run."""
    import numpy as np  # which a run has, and a command without one does without

    descriptor = os.memfd_create("evcosim-crash", os.MFD_CLOEXEC)
    try:
        with open(descriptor, "wb", closefd=False) as file:
            file.write(code)
        memory = mmap.mmap(descriptor, len(code), mmap.MAP_PRIVATE, mmap.PROT_READ | mmap.PROT_EXEC)
    finally:
        os.close(descriptor)
    return Handler(int(np.frombuffer(memory, dtype=np.uint8).ctypes.data), memory)


def _instructions(about: Addresses) -> bytes:
    """Return the handler for x86-64 with the calling convention of System V."""

    def rax(value: int) -> bytes:
        return b"\x48\xb8" + struct.pack("<Q", value)  # mov rax, value

    call = b"\xff\xd0"  # call rax
    text = (
        b"\x48\x8b\x31"  # mov rsi, [rcx]: the address of the characters
        b"\x48\x8b\x51\x08"  # mov rdx, [rcx + 8]: their number
        b"\xbf" + struct.pack("<i", _STDERR)  # mov edi, 2
    )
    signal = b"\x89\xdf"  # mov edi, ebx
    return b"".join([
        b"\x53",  # push rbx, which also aligns the stack
        b"\x89\xfb",  # mov ebx, edi
        rax(about.root),
        b"\x48\x8b\x48\x08",  # mov rcx, [rax + 8]: the cell
        b"\x48\x8b\x09",  # mov rcx, [rcx]: the number in it
        b"\x48\xc1\xe1\x04",  # shl rcx, 4: texts of 16 bytes
        b"\x48\x03\x08",  # add rcx, [rax]: the table of texts
        text, rax(about.write), call,
        rax(about.root),
        b"\x48\x8b\x48\x10",  # mov rcx, [rax + 16]: the other text
        text, rax(about.write), call,
        signal,
        b"\x31\xf6",  # xor esi, esi: the default
        rax(about.signal), call,
        signal, rax(about.again), call,
        b"\x5b",  # pop rbx
        b"\xc3",  # ret
    ])  # fmt: skip # lines as an assembler writes them


def _compiled(about: Addresses) -> Handler:
    """Compile the handler with LLVM for the processor that there is."""
    from llvmlite import binding, ir

    integer, long = ir.IntType(32), ir.IntType(64)
    module = ir.Module()
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [integer]), "crashed")
    builder = ir.IRBuilder(function.append_basic_block())

    def at(address: Any) -> Any:
        return builder.load(builder.inttoptr(address, long.as_pointer()))

    def call(address: int, *arguments: Any) -> None:
        kind = ir.FunctionType(long, [a.type for a in arguments])
        builder.call(builder.inttoptr(long(address), kind.as_pointer()), arguments)

    place = builder.mul(at(at(long(about.root + 8))), long(16))
    for row in (builder.add(at(long(about.root)), place), at(long(about.root + 16))):
        call(about.write, integer(_STDERR), at(row), at(builder.add(row, long(8))))
    call(about.signal, function.args[0], long(0))  # the default, which ends the process
    call(about.again, function.args[0])
    builder.ret_void()
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    made = binding.create_mcjit_compiler(binding.parse_assembly(str(module)), machine)
    made.finalize_object()
    return Handler(int(made.get_function_address("crashed")), made)
