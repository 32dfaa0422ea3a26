"""Cells of the tables of the frame path: read and written, and known after that."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ....cosim.can.wire.tables import Wire
from .known_frames import Frames
from .llvm_text import DOUBLE, INT, WORD
from .straight_numbers import BIT, Arithmetic, Either, Number

_NARROW = {"single": ("float", 4), "single_bits": (INT, 4)}
_REAL = ("reals", "maps", "chances", "fallback", "memory", "odds", "double")
_SHARED = ("single", "single_bits", "double", "double_bits", "memory")
"""Tables that are other tables too, or that others write."""


class Cells:
    """Writes reading and writing. `known` is what stands in tables, by name and place, as far as it is known.

    `wire` is the name of the address of the tables' addresses.
    """

    def __init__(self, numbers: Arithmetic, frames: Frames, wire: str) -> None:
        self._n, self._f, self._frames, self._wire = numbers, numbers.f, frames, wire
        self.known: dict[tuple[str, int], Either] = {}

    def read(self, table: str, place: Sequence[Either]) -> Either:
        """Return the number at a place: row and column, or one number."""
        at = self._at(table, place)
        if not isinstance(at, Number):
            if (known := self._frames.known(table, int(at))) is not None:
                return known
            if (table, int(at)) in self.known:
                return self.known[table, int(at)]
        kind, size = _form(table)
        text = f"load {kind}, {self._f.pointer(kind)} {self._pointer(table, at)}, align {size}"
        if self._frames.is_fixed(table, at):
            return self._n.pure(f"{text}, !invariant.load !0", kind)
        value = Number(self._f.let(text), kind)
        if kind == "float":
            return Number(self._f.let(f"fpext float {value.name} to double"), DOUBLE)
        if kind == INT:
            return Number(self._f.let(f"sext {INT} {value.name} to {WORD}"), WORD)
        if not isinstance(at, Number) and table not in _SHARED:
            self.known[table, int(at)] = value
        return value

    def write(self, table: str, place: Sequence[Either], value: Either) -> None:
        """Write a number to a place, as the type of the table."""
        at, (kind, size) = self._at(table, place), _form(table)
        pointer = self._pointer(table, at)
        if kind == "float":
            text = self._f.let(f"fptrunc double {self._n.text(value, DOUBLE)} to float")
        elif kind == INT:
            text = self._f.let(f"trunc {WORD} {self._n.text(value, WORD)} to {INT}")
        else:
            text = self._n.text(value, kind)
        self._f.do(f"store {kind} {text}, {self._f.pointer(kind)} {pointer}, align {size}")
        if isinstance(at, Number):
            self.known = {key: each for key, each in self.known.items() if key[0] != table}
        elif table not in _SHARED:
            is_bit = isinstance(value, Number) and value.kind == BIT
            self.known[table, int(at)] = Number(text, kind, 0, 1) if is_bit else value

    def _at(self, table: str, place: Sequence[Either]) -> Either:
        """Return a place in words from the begin of the table."""
        if len(place) == 1:
            return place[0]
        first = self._n.operate(ast.Mult(), place[0], self._frames.shapes[table][1])
        return self._n.operate(ast.Add(), first, place[1])

    def _pointer(self, table: str, at: Either) -> str:
        """Return the pointer to a place."""
        kind, size = _form(table)
        words = 3 * Wire._fields.index(table)  # address, rows, columns of each
        entry = self._n.pure(f"add {WORD} {self._wire}, {8 * words}", WORD).name
        cell = self._as_pointer(entry, WORD)
        loaded = f"load {WORD}, {self._f.pointer(WORD)} {cell}, align 8, !invariant.load !0"
        moved = self._n.operate(ast.Mult(), at, size)
        place = f"add {WORD} {self._n.pure(loaded, WORD).name}, {self._n.text(moved, WORD)}"
        return self._as_pointer(self._n.pure(place, WORD).name, kind)

    def _as_pointer(self, address: str, kind: str) -> str:
        pointer = self._f.pointer(kind)
        return self._n.pure(f"inttoptr {WORD} {address} to {pointer}", pointer).name


def _form(table: str) -> tuple[str, int]:
    """Return the type of a table's numbers, and its bytes."""
    return _NARROW.get(table, (DOUBLE if table in _REAL else WORD, 8))
