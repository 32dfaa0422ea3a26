"""Values of the run's memory in straight-line code: moved, mapped, checked and quantized.

The arithmetic is that of the kernel and of the channel, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence

from ....cosim.can.wire import tables as T
from ...machine import tables as L
from .llvm_text import DOUBLE, Function, number
from .structure import Move

LARGEST = 1.7976931348623157e308
_HALF = 0.49999999999999994  # the greatest double below 0.5, which would round itself up
_WHOLE = 6755399441055744.0  # doubles from 2**52 on are whole, so a sum is rounded, a half to the even one
_WIDTHS = (8, 4, 2, 1)  # numbers that are moved at once


class Memory:
    """Writes reading and writing of slots; `base` is the name of the memory's address."""

    def __init__(self, f: Function, base: str) -> None:
        self._f, self._base = f, base

    def get(self, slot: int) -> str:
        """Return the value of a slot."""
        return self._f.load(DOUBLE, self._base, slot)

    def put(self, slot: int, value: str) -> None:
        """Write a value to a slot."""
        self._f.store(DOUBLE, value, self._base, slot)

    def mapped(
        self,
        value: str,
        move: Move,
        table: str,
        width: int,
        columns: tuple[int, int] = (L.SCALE, L.ADD),
    ) -> str:
        """Return a value mapped by the numbers in a row of a table of so many columns."""
        return value if move.plain else self.affine(value, table, width * move.row, columns)

    def affine(self, value: str, table: str, first: int, columns: tuple[int, int]) -> str:
        """Return scale * value + add, whose numbers stand in two columns of a row."""
        f = self._f
        scale, add = (f.load(DOUBLE, table, first + column, fixed=True) for column in columns)
        return f.let(f"fadd double {f.let(f'fmul double {scale}, {value}')}, {add}")

    def copy(self, slots: Sequence[int], base: str, first: int | str = 0) -> None:
        """Copy slots to places behind an address that follow each other from the first on.

        All slots are read before the places that they could be.
        """
        f = self._f
        place = 0
        start = base if first == 0 else f.let(f"add i64 {base}, {f.let(f'shl i64 {first}, 3')}")
        for run in _runs(slots):
            for begin, count in _pieces(run.start, len(run)):
                kind = _kind(count)
                f.store(kind, f.load(kind, self._base, begin), start, place)
                place += count

    def are_finite(self, first: int, count: int) -> str:
        """Return the bit that says that `count` values from a slot on are finite."""
        f, whole = self._f, "true"
        for begin, width in _pieces(first, count):
            kind = _kind(width)
            value = f.load(kind, self._base, begin)
            if width == 1:
                size = f.known(DOUBLE, "llvm.fabs.f64", [(DOUBLE, value)])
                good = f.let(f"fcmp ole double {size}, {number(LARGEST)}")
            else:
                size = f.known(kind, f"llvm.fabs.v{width}f64", [(kind, value)])
                most = "<" + ", ".join([f"double {number(LARGEST)}"] * width) + ">"
                bits = f.let(f"fcmp ole {kind} {size}, {most}")
                packed = f.let(f"bitcast <{width} x i1> {bits} to i{width}")
                good = f.let(f"icmp eq i{width} {packed}, -1")
            whole = good if whole == "true" else f.let(f"and i1 {whole}, {good}")
        return whole

    def rounded(self, q: str, mode: int) -> str:
        """Return a raw value in range, rounded by a signal's mode."""
        f = self._f
        if mode in (T.NEAREST, T.TRUNCATE):
            half = number(_HALF if mode == T.NEAREST else 0.0)
            above = f.known(DOUBLE, "llvm.floor.f64", [(DOUBLE, f.let(f"fadd double {q}, {half}"))])
            below = f.known(DOUBLE, "llvm.floor.f64", [(DOUBLE, f.let(f"fsub double {half}, {q}"))])
            turned = f.let(f"fsub double {number(0.0)}, {below}")
            positive = f.let(f"fcmp oge double {q}, {number(0.0)}")
            return f.let(f"select i1 {positive}, double {above}, double {turned}")
        if mode == T.HALF_EVEN:
            sum_ = f.let(f"fadd double {q}, {number(_WHOLE)}")
            return f.let(f"fsub double {sum_}, {number(_WHOLE)}")
        if mode == T.FLOAT32:
            return f.let(f"fpext float {f.let(f'fptrunc double {q} to float')} to double")
        return q


def _kind(count: int) -> str:
    return DOUBLE if count == 1 else f"<{count} x double>"


def _runs(slots: Sequence[int]) -> list[range]:
    """Return slots as ranges of those that follow each other."""
    runs: list[range] = []
    for slot in slots:
        if runs and runs[-1].stop == slot:
            runs[-1] = range(runs[-1].start, slot + 1)
        else:
            runs.append(range(slot, slot + 1))
    return runs


def _pieces(first: int, count: int) -> list[tuple[int, int]]:
    """Return first and number of pieces that machine code moves at once."""
    pieces = []
    for width in _WIDTHS:
        while count >= width:
            pieces.append((first, width))
            first, count = first + width, count - width
    return pieces
