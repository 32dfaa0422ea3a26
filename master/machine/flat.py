"""Machine code as plain bytes, which any process can map and run: numba's function without numba.

What LLVM emits for a function that calls others by address alone needs nothing of its surroundings but its
own constants. They are put behind it, and the distances between the two are written in; whatever needs more
than that is refused.
"""

# llvmlite and numba have no types
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable

import llvmlite.binding as llvm

_ALLOCATED, _PROGBITS, _SYMBOLS, _RELOCATIONS = 2, 1, 2, 4  # elf.h
_PC32, _PLT32 = 2, 4
_KEPT = (".text", ".rodata")
_ALIGNMENT = 64
_ENTRY = "evcosim_entry"
_HEADER = struct.Struct("<16sHHIQQQIHHHHHH")
_SECTION = struct.Struct("<IIQQQQIIQQ")
_SYMBOL = struct.Struct("<IBBHQQ")
_RELOCATION = struct.Struct("<QQq")


class NotFlatError(Exception):
    """The code needs more than its own bytes."""


def flat(function: Callable[..., int], signature: str = "int64(int64)") -> bytes:
    """Return machine code that begins with a C function of numba's types in `signature`, compiled now.

    Raises NotFlatError.
    """
    import numba  # half a second; code in LLVM's language needs none of it

    compiling = numba.njit(signature, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
    made = compiling(function)
    (compiled,) = made.overloads.values()
    text, name = compiled.library.get_llvm_str(), compiled.fndesc.llvm_func_name
    parameters = llvm.parse_assembly(text).get_function(name).arguments
    kinds = [str(parameter.type) for parameter in parameters]
    entry = _entry(name, f"i{compiled.signature.return_type.bitwidth}", kinds)
    return linked(object_of(text.replace("\ndefine ", f"\n{entry}\ndefine ", 1)), _ENTRY)


def object_of(text: str) -> bytes:
    """Return the object file of a module in LLVM's language, for this processor."""
    module = llvm.parse_assembly(text)
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="pic",
        codemodel="small",
    )
    content: bytes = target.emit_object(module)
    return content


def _entry(called: str, kind: str, kinds: list[str]) -> str:
    """Return a C function in LLVM's language that calls one of numba's convention, for a type of the answer.

    That one has parameters of these `kinds`: the first receives the answer, and the second an exception, of
    which there is none here; what it returns says if there was one.
    """
    answer, exception, *rest = kinds
    given = [f"{each} %a{i}" for i, each in enumerate(rest)]
    passed = ", ".join([f"{answer} %answer", f"{exception} null", *given])
    return f"""define {kind} @{_ENTRY}({", ".join(given)}) {{
  %answer = alloca {kind}
  %status = call i32 @"{called}"({passed})
  %value = load {kind}, {answer} %answer
  ret {kind} %value
}}
"""


@dataclasses.dataclass
class _Section:
    """A section of an object file; `place` is where its content begins in the result (-1: not there)."""

    name: str
    kind: int
    flags: int
    content: bytes
    link: int
    info: int
    place: int = -1


def linked(content: bytes, entry: str) -> bytes:
    """Return the code and constants of an x86-64 object file, from the function `entry` on.

    Raises NotFlatError.
    """
    sections = _sections(content)
    symbols = _symbols(sections)
    result = bytearray()
    for section in sections:
        if section.kind == _PROGBITS and section.flags & _ALLOCATED and section.name.startswith(_KEPT):
            result += bytes(-len(result) % _ALIGNMENT)
            section.place = len(result)
            result += section.content
    for section in sections:
        if section.kind == _RELOCATIONS and sections[section.info].place >= 0:
            _relocate(result, section, sections, symbols)
    for name, of, value in symbols:
        if name == entry and 0 < of < len(sections) and sections[of].place + value == 0:
            return bytes(result)
    raise NotFlatError(f"{entry} is not where the code begins")


def _sections(content: bytes) -> list[_Section]:
    header = _HEADER.unpack_from(content)
    first, size, count, named = header[6], header[11], header[12], header[13]
    rows = [_SECTION.unpack_from(content, first + i * size) for i in range(count)]
    texts = content[rows[named][4] :]
    return [
        _Section(_text(texts, name), kind, flags, content[place : place + length], link, info)
        for name, kind, flags, _, place, length, link, info, _, _ in rows
    ]


def _symbols(sections: list[_Section]) -> list[tuple[str, int, int]]:
    """Return name, section and value of each symbol."""
    table = next(section for section in sections if section.kind == _SYMBOLS)
    texts = sections[table.link].content
    return [
        (_text(texts, name), of, value) for name, _, _, of, value, _ in _SYMBOL.iter_unpack(table.content)
    ]


def _text(texts: bytes, place: int) -> str:
    return texts[place : texts.index(b"\0", place)].decode()


def _relocate(
    result: bytearray, relocations: _Section, sections: list[_Section], symbols: list[tuple[str, int, int]]
) -> None:
    """Write the distances that a section of relocations asks for. Raises NotFlatError."""
    base = sections[relocations.info].place
    for offset, info, addend in _RELOCATION.iter_unpack(relocations.content):
        name, of, value = symbols[info >> 32]
        kind = info & 0xFFFFFFFF
        if kind not in (_PC32, _PLT32) or not 0 < of < len(sections) or sections[of].place < 0:
            raise NotFlatError(f"it refers to {name or 'a section'} in a way (type {kind}) that is not flat")
        at = base + offset
        struct.pack_into("<i", result, at, sections[of].place + value + addend - at)
