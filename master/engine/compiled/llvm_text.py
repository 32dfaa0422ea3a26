"""A function in LLVM's language, written line by line. Addresses are 64-bit numbers, as in the tables."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterator, Sequence

WORD, DOUBLE, INT = "i64", "double", "i32"
_FIXED = ", !invariant.load !0"
_SELDOM = ", !prof !1"
_METADATA = """
!0 = !{}
!1 = !{!"branch_weights", i32 1, i32 100000}
"""


class Function:
    """A C function `name` of words that returns a word; `opaque`: LLVM's pointers have no types."""

    def __init__(self, name: str, parameters: Sequence[str], opaque: bool) -> None:
        self._opaque = opaque
        given = ", ".join(f"{WORD} %{parameter}" for parameter in parameters)
        self._head = f"define {WORD} @{name}({given}) {{\n"
        self._lines: list[str] = ["entry:"]
        self._seldom: list[str] = []
        self._declared: set[str] = set()
        self._constants: dict[tuple[int, ...], str] = {}
        self._count = 0
        self.block = "entry"

    def text(self) -> str:
        """Return the module that holds the function."""
        lines = "\n".join([*self._lines, *self._seldom])
        return "\n".join(sorted(self._declared)) + f"\n{self._head}{lines}\n}}\n{_METADATA}"

    # ---- lines and blocks

    def do(self, text: str) -> None:
        """Add an instruction without a value."""
        self._lines.append(f"  {text}")

    def let(self, text: str) -> str:
        """Add an instruction, and return the name of its value."""
        self._count += 1
        self._lines.append(f"  %v{self._count} = {text}")
        return f"%v{self._count}"

    def label(self) -> str:
        """Return a new name of a block."""
        self._count += 1
        return f"b{self._count}"

    def place(self, label: str) -> None:
        """Begin a block: the one before it goes on there, unless it has ended."""
        if not self._lines[-1].startswith(("  br ", "  ret ")):
            self.do(f"br label %{label}")
        self._lines.append(f"{label}:")
        self.block = label

    def split(self, condition: str, then: str, other: str, seldom: bool = False) -> None:
        """Go on in one of two blocks; `seldom`: the first is cold."""
        self.do(f"br i1 {condition}, label %{then}, label %{other}{_SELDOM if seldom else ''}")

    @contextlib.contextmanager
    def seldom(self, condition: str) -> Iterator[str]:
        """Write what is done where a condition holds, far from the rest, which goes on behind it.

        Gives the label behind it. A block that does not end goes on there.
        """
        cold, behind = self.label(), self.label()
        self.split(condition, cold, behind, seldom=True)
        lines = self._lines
        self._lines = [f"{cold}:"]
        self.block = cold
        yield behind
        if not self._lines[-1].startswith(("  br ", "  ret ")):
            self.do(f"br label %{behind}")
        self._seldom += self._lines
        self._lines = lines
        self._lines.append(f"{behind}:")
        self.block = behind

    def give(self, value: str | int) -> None:
        """Return a word."""
        self.do(f"ret {WORD} {value}")

    def mark(self) -> tuple[int, int, str]:
        """Return the place at which the text is, for `undo`."""
        return len(self._lines), len(self._seldom), self.block

    def undo(self, mark: tuple[int, int, str]) -> None:
        """Take back all that was written since."""
        lines, seldom, self.block = mark
        del self._lines[lines:], self._seldom[seldom:]

    # ---- memory

    def pointer(self, kind: str) -> str:
        """Return the type of an address of something."""
        return "ptr" if self._opaque else f"{kind}*"

    def at(self, base: str, place: int | str, kind: str) -> str:
        """Return the pointer to a place, in words, behind an address."""
        if place != 0:
            bytes_ = str(8 * place) if isinstance(place, int) else self.let(f"shl {WORD} {place}, 3")
            base = self.let(f"add {WORD} {base}, {bytes_}")
        return self.let(f"inttoptr {WORD} {base} to {self.pointer(kind)}")

    def load(self, kind: str, base: str, place: int | str, fixed: bool = False, align: int = 8) -> str:
        """Return what stands at a place, in words, behind an address; `fixed`: it does not change."""
        pointer = self.at(base, place, kind)
        return self.let(
            f"load {kind}, {self.pointer(kind)} {pointer}, align {align}{_FIXED if fixed else ''}"
        )

    def store(self, kind: str, value: str | int, base: str, place: int | str, align: int = 8) -> None:
        """Write a value to a place, in words, behind an address."""
        pointer = self.at(base, place, kind)
        self.do(f"store {kind} {value}, {self.pointer(kind)} {pointer}, align {align}")

    def constant(self, values: Sequence[int]) -> str:
        """Return the name of words that stand beside the code."""
        name = self._constants.setdefault(tuple(values), f"@constant{len(self._constants)}")
        words = ", ".join(f"{WORD} {value}" for value in values)
        self._declared.add(f"{name} = internal constant [{len(values)} x {WORD}] [{words}], align 8")
        return name

    # ---- calls

    def call(self, answer: str, address: str, arguments: Sequence[tuple[str, str | int]]) -> str:
        """Return what the C function at an address returns for arguments, each with its type."""
        kinds = ", ".join(kind for kind, _ in arguments)
        kind = f"{answer} ({kinds})"
        function = self.let(f"inttoptr {WORD} {address} to {self.pointer(kind)}")
        return self.let(f"call {answer} {function}({_listed(arguments)})")

    def known(self, answer: str, name: str, arguments: Sequence[tuple[str, str]]) -> str:
        """Return what an instruction of LLVM that is written as a function gives."""
        kinds = ", ".join(kind for kind, _ in arguments)
        self._declared.add(f"declare {answer} @{name}({kinds})")
        return self.let(f"call {answer} @{name}({_listed(arguments)})")


def _listed(arguments: Sequence[tuple[str, str | int]]) -> str:
    return ", ".join(f"{kind} {value}" for kind, value in arguments)


def number(value: float) -> str:
    """Return a double as LLVM writes it, with all its bits."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"
