"""Functions of Python, math and cmath that have a native form."""

from __future__ import annotations

import ast
import builtins
import cmath
import math
from collections.abc import Callable, Hashable, Sequence
from typing import Any

from . import ir
from .lower_arithmetic import binary, truth_of
from .lower_frame import Frame
from .lower_sequences import items, length_of, listed
from .lower_values import Group, Known, Run, Value, as_integer, as_real, described, literal, number_type
from .values import BOOLEAN, COMPLEX, INTEGER, REAL, ArrayType, Type, is_integral

Builtin = Callable[[Frame, ast.Call, Sequence[Value]], Value]

# functions of reals that cannot fail
_PLAIN = {"fabs", "atan", "tanh", "copysign", "atan2", "asinh", "cbrt", "erf", "erfc", "degrees", "radians"}
_TESTS = {"isfinite", "isnan", "isinf"}
# functions of reals that fail where Python raises ValueError or OverflowError, with their number of arguments
_CHECKED = {
    **dict.fromkeys(("exp", "expm1", "sqrt", "log", "log2", "log10", "log1p"), 1),
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "sinh", "cosh", "acosh", "atanh"), 1),
    **dict.fromkeys(("pow", "fmod", "remainder"), 2),
}
_TO_INTEGER = {"floor", "ceil", "trunc"}
_COMPLEX = {"exp", "cosh", "sinh", "tanh", "cos", "sin", "tan", "sqrt", "log", "log10"}


def find(function: object) -> Builtin | None:
    """Return the lowering of a function of Python, math or cmath; None for one that has none."""
    return _BUILTINS.get(function) if isinstance(function, Hashable) else None


def _real(frame: Frame, node: ast.AST, value: Value) -> ir.Expression:
    e = frame.expr(node, value)
    if e.type is not REAL and not is_integral(e.type):
        raise frame.refuse(node, f"{described(value)} is no real number", "give it a float")
    return as_real(as_integer(e) if is_integral(e.type) and e.type is not INTEGER else e)


def _count(frame: Frame, node: ast.Call, given: Sequence[Value], *counts: int) -> None:
    if len(given) not in counts:
        raise frame.refuse(node, f"{len(given)} arguments here", "write it with plain numbers as arguments")


def _of_math(name: str) -> Builtin:
    def lowered(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
        _count(frame, node, given, _CHECKED.get(name, 2 if name in ("copysign", "atan2") else 1))
        if name == "log" and len(given) != 1:
            raise frame.refuse(node, "a logarithm to a base", "write log(x) / log(base)")
        arguments = [_real(frame, node, value) for value in given]
        if name in _TESTS:
            return Run(ir.Apply(BOOLEAN, f"py_math_{name}", tuple(arguments)))
        if name in _PLAIN:
            return Run(ir.Apply(REAL, f"py_math_{name}", tuple(arguments)))
        return frame.checked(node, INTEGER if name in _TO_INTEGER else REAL, f"py_math_{name}", arguments)

    def integral(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
        if len(given) == 1 and is_integral(frame.expr(node, given[0]).type):
            return Run(as_integer(frame.expr(node, given[0])))
        return lowered(frame, node, given)

    return integral if name in _TO_INTEGER else lowered


def _of_cmath(name: str) -> Builtin:
    def lowered(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
        _count(frame, node, given, 1)
        e = frame.expr(node, given[0])
        if e.type is not COMPLEX:
            raise frame.refuse(node, f"{described(given[0])} for a complex number", "write complex(a, 0.0)")
        if name == "sqrt":
            return Run(ir.Apply(COMPLEX, "py_cmath_sqrt", (e,)))
        return frame.checked(node, COMPLEX, f"py_cmath_{name}", (e,))

    return lowered


def _extreme(name: str) -> Builtin:
    """min or max: the first of those that are equal, and of NaN what Python's comparisons leave."""

    def lowered(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
        values = items(frame, node, given[0]) if len(given) == 1 else list(given)
        if not values:
            raise frame.refuse(node, f"{name} of nothing", "give it numbers")
        if all(isinstance(v, Known) for v in values):
            chosen = getattr(builtins, name)(v.value for v in values if isinstance(v, Known))
            if len({number_type(v.value) for v in values if isinstance(v, Known)}) == 1:
                return Known(chosen)
        numbers = [frame.expr(node, v) for v in values]
        first = numbers[0].type
        if any(n.type != first for n in numbers):
            names = " and ".join(dict.fromkeys(described(Run(n)) for n in numbers))
            raise frame.refuse(node, f"{name} of {names}: its type is not known", "write 0.0 for a float")
        if first is not REAL and not is_integral(first):
            raise frame.refuse(node, f"{name} of {described(Run(numbers[0]))}", "compare numbers")
        found = numbers[0]
        for number in numbers[1:]:
            function = f"py_float_{name}" if first is REAL else f"py_int_{name}"
            found = ir.Apply(first, function, (found, number))
        return Run(found)

    return lowered


def _abs(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    if isinstance(given[0], Known) and isinstance(given[0].value, int | float):
        return Known(abs(given[0].value))
    e = frame.expr(node, given[0])
    if e.type is REAL:
        return Run(ir.Apply(REAL, "py_float_abs", (e,)))
    if e.type is COMPLEX:
        return frame.checked(node, REAL, "py_complex_abs", (e,))
    if is_integral(e.type):
        return frame.checked(node, INTEGER, "py_int_abs", (as_integer(e),))
    raise frame.refuse(node, f"abs of {described(given[0])}", "give it a number")


def _float(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    if isinstance(given[0], Known) and given[0].value in ("inf", "-inf", "nan"):
        return Known(float(given[0].value))
    return Run(_real(frame, node, given[0]))


def _int(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    if isinstance(given[0], Known) and isinstance(given[0].value, int):
        return Known(int(given[0].value))
    e = frame.expr(node, given[0])
    return (
        Run(as_integer(e))
        if is_integral(e.type)
        else frame.checked(node, INTEGER, "py_float_int", (_real(frame, node, given[0]),))
    )


def _round(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    if len(given) != 1:
        raise frame.refuse(node, "round to digits", "write round(x * 100.0) / 100.0")
    e = frame.expr(node, given[0])
    return (
        Run(as_integer(e))
        if is_integral(e.type)
        else frame.checked(node, INTEGER, "py_float_round", (_real(frame, node, given[0]),))
    )


def _bool(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    return truth_of(frame, node, given[0])


def _complex(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1, 2)
    for value in given:
        if frame.expr(node, value).type is COMPLEX:
            raise frame.refuse(node, "complex() of a complex number", "leave it out, or use .real and .imag")
    parts = [_real(frame, node, value) for value in given]
    imaginary = parts[1] if len(parts) == 2 else literal(0.0)
    return Run(ir.Apply(COMPLEX, "py_complex_of", (parts[0], imaginary)))


def _divmod(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 2)
    a, b = (frame.simple(node, value) for value in given)
    if REAL in (a.type, b.type) and all(x.type is REAL or is_integral(x.type) for x in (a, b)):
        numbers = as_real(a.expr), as_real(b.expr)
        quotient = frame.checked(node, REAL, "py_float_divmod_floordiv", numbers)
        return Group((quotient, frame.checked(node, REAL, "py_float_mod", numbers)))
    return Group((binary(frame, node, ast.FloorDiv(), a, b), binary(frame, node, ast.Mod(), a, b)))


def _pow(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 2)
    return binary(frame, node, ast.Pow(), given[0], given[1])


def _len(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    return Known(length_of(frame, node, given[0]))


def _tuple(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    if not given:
        return Known(())
    value = given[0]
    if isinstance(value, Run) and isinstance(value.type, ArrayType):
        return value
    return Group(tuple(items(frame, node, value)))


def _list(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    return listed(frame, node, items(frame, node, given[0]) if given else [])


def _range(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    if all(isinstance(v, Known) and isinstance(v.value, int) for v in given) and given:
        bounds: list[Any] = [v.value for v in given if isinstance(v, Known)]
        return Known(range(*bounds))
    raise frame.needs_number(
        node, "how many numbers these are is not known", "write it in `for ... in range(n):`"
    )


def _zip(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    columns = [items(frame, node, value) for value in given]
    if len({len(column) for column in columns}) > 1:
        raise frame.refuse(node, "zip of different lengths", "give it tuples of one length")
    return Group(tuple(Group(tuple(row)) for row in zip(*columns, strict=True)))


def _enumerate(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    return Group(tuple(Group((Known(k), v)) for k, v in enumerate(items(frame, node, given[0]))))


def _reversed(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 1)
    return Group(tuple(reversed(items(frame, node, given[0]))))


_CLASSES: dict[Type, type] = {REAL: float, INTEGER: int, BOOLEAN: bool, COMPLEX: complex}


def _isinstance(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 2)
    value, classes = given
    assert isinstance(classes, Known)
    if isinstance(value, Known):
        return Known(isinstance(value.value, classes.value))  # type: ignore[arg-type] # the value is a class, or a tuple of them
    e = frame.expr(node, value)
    python = _CLASSES.get(e.type) or getattr(e.type, "python", getattr(e.type, "enumeration", tuple))
    return Known(issubclass(python or tuple, classes.value))  # type: ignore[arg-type] # the same


def _any_or_all(is_all: bool) -> Builtin:
    def lowered(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
        _count(frame, node, given, 1)
        if isinstance(node.args[0], ast.GeneratorExp):
            raise frame.refuse(node, "any and all end early", "write the loop, or `and` and `or`")
        found: ir.Expression = literal(is_all)
        for k, item in enumerate(items(frame, node, given[0])):
            test = frame.expr(node, truth_of(frame, node, item))
            found = test if k == 0 else ir.Operation(BOOLEAN, "and" if is_all else "or", (found, test))
        return Run(found)

    return lowered


def _hypot(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    _count(frame, node, given, 2, 3)
    parts = tuple(_real(frame, node, value) for value in given)
    return Run(ir.Apply(REAL, f"py_math_hypot{len(parts)}", parts))


def _sum(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    raise frame.refuse(node, "sum() of floats has another rule since Python 3.12", "write the loop")


def _print(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    raise frame.refuse(node, "a native model prints nothing", "return a sentence from `notice`")


def _sorted(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    raise frame.refuse(node, "sorting", "write the comparisons with min and max, or a loop that swaps")


_BUILTINS: dict[object, Builtin] = {
    **{getattr(math, name): _of_math(name) for name in (*_PLAIN, *_TESTS, *_CHECKED, *_TO_INTEGER)},
    **{getattr(cmath, name): _of_cmath(name) for name in _COMPLEX},
    min: _extreme("min"),
    max: _extreme("max"),
    abs: _abs,
    float: _float,
    int: _int,
    round: _round,
    bool: _bool,
    complex: _complex,
    divmod: _divmod,
    pow: _pow,
    len: _len,
    tuple: _tuple,
    list: _list,
    range: _range,
    zip: _zip,
    enumerate: _enumerate,
    reversed: _reversed,
    isinstance: _isinstance,
    any: _any_or_all(False),
    all: _any_or_all(True),
    math.hypot: _hypot,
    math.fsum: _sum,
    sum: _sum,
    print: _print,
    sorted: _sorted,
}
