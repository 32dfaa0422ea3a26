"""Arithmetic on known and unknown numbers gives what Python gives."""

from __future__ import annotations

import ast
import ctypes
import itertools
import math
import operator
from collections.abc import Callable

import numpy as np
import pytest

from evcosim.master.engine.compiled.llvm_text import DOUBLE, WORD, Function
from evcosim.master.engine.compiled.straight_making import IS_OPAQUE, linked_code
from evcosim.master.engine.compiled.straight_numbers import Arithmetic, Either, Number, same
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")
WHOLE = [0, 1, -1, 2, 7, 15, 16, 255, 256, -256, 2**31, -(2**40) - 3]
REAL = [0.0, -0.0, 1.0, -1.0, 0.1, -2.5, 1e300, 5e-324]
Write = Callable[[Arithmetic, Either, Either], Either]
PYTHON: dict[type[ast.AST], Callable[..., int | float | bool]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.BitAnd: operator.and_, ast.BitOr: operator.or_, ast.BitXor: operator.xor,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod,
    ast.LShift: operator.lshift, ast.RShift: operator.rshift,
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip # one table


def results(write: Write, pairs: list[tuple[int | float, int | float]], kind: str, known: int) -> list[bytes]:
    """The bits of what code gives for pairs of numbers, of which those of a mask are known."""
    groups: dict[object, list[tuple[int | float, int | float]]] = {}
    for pair in pairs:
        groups.setdefault(tuple(repr(v) for i, v in enumerate(pair) if known >> i & 1), []).append(pair)
    answers: dict[tuple[str, str], bytes] = {}
    for same_known in groups.values():
        f = Function("f", ["m"], IS_OPAQUE)
        numbers = Arithmetic(f)
        given: list[Either] = [
            value if known >> i & 1 else Number(f.load(kind, "%m", i), kind)
            for i, value in enumerate(same_known[0])
        ]
        result = write(numbers, *given)
        of = (
            DOUBLE
            if isinstance(result, float) or (isinstance(result, Number) and result.kind == DOUBLE)
            else WORD
        )
        f.store(of, numbers.text(result, of), "%m", 2)
        f.give(0)
        loaded = Loaded(linked_code(f.text(), "f") or b"")
        for pair in same_known:
            memory = np.array([*pair, 0], dtype=float if kind == DOUBLE else np.int64)
            ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(loaded.address)(memory.ctypes.data)
            answers[repr(pair[0]), repr(pair[1])] = memory[2:].tobytes()
    return [answers[repr(a), repr(b)] for a, b in pairs]


def bits(value: int | float) -> bytes:
    return np.array([value]).astype(float if isinstance(value, float) else np.int64).tobytes()


@pytest.mark.parametrize("known", [0, 1, 2, 3])
@pytest.mark.parametrize("kind", [ast.Add, ast.Sub, ast.Mult, ast.BitAnd, ast.BitOr, ast.BitXor])
def test_whole_numbers(kind: type[ast.operator], known: int) -> None:
    pairs = [(a, b) for a, b in itertools.product(WHOLE, WHOLE) if abs(a * b) < 2**62]
    python = PYTHON[kind]
    expected = [bits(python(a, b)) for a, b in pairs]
    assert results(lambda n, a, b: n.operate(kind(), a, b), pairs, WORD, known) == expected


@pytest.mark.parametrize("kind", [ast.FloorDiv, ast.Mod, ast.LShift, ast.RShift])
@pytest.mark.parametrize("masked", [False, True])
def test_by_a_known_number(kind: type[ast.operator], masked: bool) -> None:
    pairs = list(itertools.product([value for value in WHOLE if abs(value) < 2**32], [1, 2, 3, 15, 16]))
    python = PYTHON[kind]
    expected = [bits(python(a & 255 if masked else a, b)) for a, b in pairs]

    def write(n: Arithmetic, a: Either, b: Either) -> Either:
        return n.operate(kind(), n.operate(ast.BitAnd(), a, 255) if masked else a, b)

    assert results(write, pairs, WORD, 2) == expected


@pytest.mark.parametrize("known", [0, 1, 2, 3])
@pytest.mark.parametrize("kind", [ast.Add, ast.Sub, ast.Mult, ast.Div])
def test_real_numbers_keep_their_bits(kind: type[ast.operator], known: int) -> None:
    pairs = [(a, b) for a, b in itertools.product(REAL, REAL) if kind is not ast.Div or abs(b) > 1e-300]
    python = PYTHON[kind]
    expected = [bits(python(a, b)) for a, b in pairs]
    assert results(lambda n, a, b: n.operate(kind(), a, b), pairs, DOUBLE, known) == expected


@pytest.mark.parametrize("known", [0, 1, 2])
@pytest.mark.parametrize("order", [ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE])
def test_comparisons_and_choices(order: type[ast.cmpop], known: int) -> None:
    python = PYTHON[order]
    for kind, values in ((WORD, WHOLE), (DOUBLE, [*REAL, math.nan])):
        pairs = list(itertools.product(values, values))
        expected = [bits(a if python(a, b) else b) for a, b in pairs]
        write: Write = lambda n, a, b: n.chosen(n.compare(order(), a, b), a, b)  # noqa: E731 # one expression
        assert results(write, pairs, kind, known) == expected


def test_one_number_is_the_same_only_with_its_sign_and_type() -> None:
    assert same(0.0, 0.0) and same(3, 3)
    assert not same(0.0, -0.0) and not same(1, 1.0) and not same(True, 1)
