"""Numbers of which some are known when the code is written: arithmetic on the others becomes instructions.

A number is one of Python, or a `Number` that the code will have. What two known ones give is computed at
once; what an instruction gave is not computed again where it is known to be there.
"""

from __future__ import annotations

import ast
import dataclasses
import math
from collections.abc import Callable

from .llvm_text import DOUBLE, WORD, Function, number

BIT = "i1"


@dataclasses.dataclass(frozen=True)
class Number:
    """A number of the code: its name, its type, and for whole ones the least and the greatest if known."""

    name: str
    kind: str
    low: int | None = None
    high: int | None = None


Known = int | float | bool
Either = Known | Number


class UnknownForm(Exception):
    """Something that is not written out; the kernel's function does it."""


_INTEGERS: dict[type[ast.operator], str] = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor",
    ast.LShift: "shl", ast.RShift: "ashr",
}  # fmt: skip # one table
_REALS: dict[type[ast.operator], str] = {
    ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"
}  # fmt: skip # one table
_EXACTLY: dict[type[ast.operator], Callable[[Known, Known], Known]] = {
    ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b, ast.FloorDiv: lambda a, b: a // b, ast.Mod: lambda a, b: a % b,
    ast.BitAnd: lambda a, b: int(a) & int(b), ast.BitOr: lambda a, b: int(a) | int(b),
    ast.BitXor: lambda a, b: int(a) ^ int(b), ast.LShift: lambda a, b: int(a) << int(b),
    ast.RShift: lambda a, b: int(a) >> int(b),
}  # fmt: skip # one table
_ORDERS: dict[type[ast.cmpop], tuple[str, str, Callable[[Known, Known], bool]]] = {
    ast.Eq: ("eq", "oeq", lambda a, b: a == b), ast.NotEq: ("ne", "une", lambda a, b: a != b),
    ast.Lt: ("slt", "olt", lambda a, b: a < b), ast.LtE: ("sle", "ole", lambda a, b: a <= b),
    ast.Gt: ("sgt", "ogt", lambda a, b: a > b), ast.GtE: ("sge", "oge", lambda a, b: a >= b),
}  # fmt: skip # one table


class Arithmetic:
    """Writes arithmetic; `computed` are the instructions whose values are there, by their texts."""

    def __init__(self, f: Function) -> None:
        self.f = f
        self.computed: dict[str, Number] = {}

    def pure(self, text: str, kind: str, low: int | None = None, high: int | None = None) -> Number:
        """Return the value of an instruction that depends on nothing but its operands."""
        if text not in self.computed:
            self.computed[text] = Number(self.f.let(text), kind, low, high)
        return self.computed[text]

    # ---- types

    def text(self, value: Either, kind: str) -> str:
        """Return a number as an operand of a type."""
        if not isinstance(value, Number):
            return number(float(value)) if kind == DOUBLE else str(int(value))
        if value.kind == kind:
            return value.name
        if kind == DOUBLE:
            return self.to_real(value).name  # type: ignore[union-attr] # it is one of the code
        if value.kind == BIT and kind == WORD:
            return self.pure(f"zext i1 {value.name} to {WORD}", WORD, 0, 1).name
        if kind == BIT and value.kind == WORD:
            return self.pure(f"icmp ne {WORD} {value.name}, 0", BIT).name
        raise UnknownForm(f"{value.kind} as {kind}")

    def to_real(self, value: Either) -> Either:
        """Return a number as a double."""
        if not isinstance(value, Number):
            return float(value)
        if value.kind == DOUBLE:
            return value
        return self.pure(f"sitofp {WORD} {self.text(value, WORD)} to double", DOUBLE)

    def to_whole(self, value: Either) -> Either:
        """Return a number without its fraction, as a whole one."""
        if not isinstance(value, Number):
            return int(value)
        if value.kind != DOUBLE:
            return Number(self.text(value, WORD), WORD, *_bounds(value))
        return self.pure(f"fptosi double {value.name} to {WORD}", WORD)

    def floor(self, value: Either) -> Either:
        """Return the greatest whole number that is not greater."""
        if not isinstance(value, Number):
            return math.floor(value)
        text = self.text(value, DOUBLE)
        found = self.f.known(DOUBLE, "llvm.floor.f64", [(DOUBLE, text)])
        return self.to_whole(Number(found, DOUBLE))

    # ---- operators

    def operate(self, operator: ast.operator, a: Either, b: Either) -> Either:
        """Return what an operator of Python gives."""
        kind = type(operator)
        if not isinstance(a, Number) and not isinstance(b, Number):
            return _EXACTLY[kind](a, b)
        if any(
            value.kind == DOUBLE if isinstance(value, Number) else isinstance(value, float)
            for value in (a, b)
        ):
            return self._real(kind, a, b)
        if kind in (ast.FloorDiv, ast.Mod):
            return self._divided(kind, a, b)
        if kind not in _INTEGERS:
            raise UnknownForm(kind.__name__)
        if (simple := _simpler(kind, a, b)) is not None:
            return simple
        low, high = _range(kind, _bounds(a), _bounds(b))
        if low is not None and low == high:
            return low
        text = f"{_INTEGERS[kind]} {WORD} {self.text(a, WORD)}, {self.text(b, WORD)}"
        return self.pure(text, WORD, low, high)

    def _real(self, kind: type[ast.operator], a: Either, b: Either) -> Either:
        """Return a double; what changes no double at all is left out: 1.0 * x, x / 1.0, x + -0.0, x - 0.0."""
        if kind not in _REALS:
            raise UnknownForm(kind.__name__)
        for one, other in ((a, b), (b, a)):
            if (kind is ast.Mult and _is(one, 1.0)) or (kind is ast.Add and _is(one, -0.0)):
                return self.to_real(other)
        if (kind is ast.Div and _is(b, 1.0)) or (kind is ast.Sub and _is(b, 0.0)):
            return self.to_real(a)
        return self.pure(f"{_REALS[kind]} double {self.text(a, DOUBLE)}, {self.text(b, DOUBLE)}", DOUBLE)

    def _divided(self, kind: type[ast.operator], a: Either, b: Either) -> Either:
        """Return quotient or rest of a division by a known number, rounded down as in Python."""
        if not isinstance(b, int) or b <= 0:
            raise UnknownForm("a division by what is not known")
        if b == 1:
            return a if kind is ast.FloorDiv else 0
        name, (low, high) = self.text(a, WORD), _bounds(a)
        if low is not None and low >= 0:
            if kind is ast.Mod:
                if high is not None and high < b:
                    return a
                return self.pure(f"urem {WORD} {name}, {b}", WORD, 0, b - 1)
            return self.pure(f"udiv {WORD} {name}, {b}", WORD, 0, None if high is None else high // b)
        rest = self.pure(f"srem {WORD} {name}, {b}", WORD).name
        below = self.pure(f"icmp slt {WORD} {rest}, 0", BIT).name
        if kind is ast.Mod:
            more = self.pure(f"add {WORD} {rest}, {b}", WORD).name
            return self.pure(f"select i1 {below}, {WORD} {more}, {WORD} {rest}", WORD, 0, b - 1)
        quotient = self.pure(f"sdiv {WORD} {name}, {b}", WORD).name
        less = self.pure(f"sub {WORD} {quotient}, 1", WORD).name
        return self.pure(f"select i1 {below}, {WORD} {less}, {WORD} {quotient}", WORD)

    def compare(self, operator: ast.cmpop, a: Either, b: Either) -> Either:
        """Return the truth of a comparison."""
        whole, real, exactly = _ORDERS[type(operator)]
        if not isinstance(a, Number) and not isinstance(b, Number):
            return exactly(a, b)
        if any(
            value.kind == DOUBLE if isinstance(value, Number) else isinstance(value, float)
            for value in (a, b)
        ):
            return self.pure(f"fcmp {real} double {self.text(a, DOUBLE)}, {self.text(b, DOUBLE)}", BIT)
        if a == b:
            return exactly(0, 0)
        (least, most), (low, high) = _bounds(a), _bounds(b)
        if most is not None and low is not None and most < low:
            return exactly(0, 1)
        if least is not None and high is not None and least > high:
            return exactly(1, 0)
        return self.pure(f"icmp {whole} {WORD} {self.text(a, WORD)}, {self.text(b, WORD)}", BIT)

    def both(self, a: Either, b: Either, either: bool = False) -> Either:
        """Return the truth of a and b, or of `either` of them."""
        for one, other in ((a, b), (b, a)):
            if not isinstance(one, Number):
                return one if bool(one) == either else other
        return self.pure(f"{'or' if either else 'and'} i1 {self.text(a, BIT)}, {self.text(b, BIT)}", BIT)

    def inverted(self, a: Either) -> Either:
        """Return the truth of not a."""
        return self.pure(f"xor i1 {self.text(a, BIT)}, true", BIT) if isinstance(a, Number) else not a

    def chosen(self, condition: Either, a: Either, b: Either) -> Either:
        """Return a where the condition holds, else b."""
        if not isinstance(condition, Number):
            return a if condition else b
        if same(a, b):
            return a
        kind = common_kind(a, b)
        low, high = _union(a, b)
        texts = [f"{kind} {self.text(value, kind)}" for value in (a, b)]
        return self.pure(f"select i1 {self.text(condition, BIT)}, {texts[0]}, {texts[1]}", kind, low, high)


def common_kind(a: Either, b: Either) -> str:
    """Return the type that both numbers become where either may come."""
    kinds = {
        value.kind if isinstance(value, Number) else DOUBLE if isinstance(value, float) else WORD
        for value in (a, b)
    }
    return DOUBLE if DOUBLE in kinds else WORD if len(kinds) > 1 else kinds.pop()


def same(a: Either, b: Either) -> bool:
    """Return True for one and the same number: 0.0 is not -0.0, nor 0."""
    if isinstance(a, Number) or isinstance(b, Number):
        return a == b
    return type(a) is type(b) and repr(a) == repr(b)


def _is(value: Either, expected: float) -> bool:
    return not isinstance(value, Number) and same(float(value), expected)


def _bounds(value: Either) -> tuple[int | None, int | None]:
    if not isinstance(value, Number):
        return int(value), int(value)
    return (0, 1) if value.kind == BIT else (value.low, value.high)


def _union(a: Either, b: Either) -> tuple[int | None, int | None]:
    if common_kind(a, b) == DOUBLE:
        return None, None
    (low, high), (least, most) = _bounds(a), _bounds(b)
    return (
        None if low is None or least is None else min(low, least),
        None if high is None or most is None else max(high, most),
    )


union = _union


def _simpler(kind: type[ast.operator], a: Either, b: Either) -> Either | None:
    """Return what an operation with 0, or with a mask that takes nothing away, leaves as it is."""
    if (
        b == 0
        and not isinstance(b, Number)
        and kind in (ast.Add, ast.Sub, ast.BitOr, ast.BitXor, ast.LShift, ast.RShift)
    ):
        return a
    if a == 0 and not isinstance(a, Number) and kind in (ast.Add, ast.BitOr, ast.BitXor):
        return b
    if kind is ast.BitAnd:
        for value, mask in ((a, b), (b, a)):
            low, high = _bounds(value)
            if isinstance(mask, Number) or low is None or high is None or low < 0:
                continue
            if mask >= 0 and (int(mask) & (int(mask) + 1)) == 0 and high <= mask:
                return value
    return None


def _range(
    kind: type[ast.operator], a: tuple[int | None, int | None], b: tuple[int | None, int | None]
) -> tuple[int | None, int | None]:
    """Return the bounds of a result, as far as they are known."""
    (low, high), (least, most) = a, b
    if kind is ast.BitAnd:
        tops = [top for bottom, top in (a, b) if bottom is not None and bottom >= 0 and top is not None]
        return (0, min(tops)) if tops else (None, None)
    if low is None or high is None or least is None or most is None or low < 0 or least < 0:
        return None, None
    if kind in (ast.BitOr, ast.BitXor):
        return 0, (1 << max(high, most).bit_length()) - 1
    if kind is ast.LShift and most < 62 and high << most < 2**62:
        return low << least, high << most
    if kind is ast.RShift:
        return low >> most, high >> least
    if kind is ast.Add and high + most < 2**62:
        return low + least, high + most
    return None, None
