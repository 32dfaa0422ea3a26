"""Operators of Python: the type of their result, and the functions of python_arithmetic.h that can fail."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any

from . import ir
from .lower_frame import Frame
from .lower_intervals import combined, fits, interval
from .lower_values import (
    Group,
    Known,
    Run,
    Value,
    as_integer,
    as_real,
    described,
    is_nonzero,
    literal,
    number_type,
)
from .values import BOOLEAN, COMPLEX, INTEGER, REAL, ArrayType, EnumType, is_integral

_PYTHON: dict[type[ast.operator], Callable[[object, object], object]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
}
_SIGN = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*"}
_REAL_CHECKED = {ast.Div: "py_float_div", ast.FloorDiv: "py_float_floordiv", ast.Mod: "py_float_mod"}
_INTEGER_CHECKED = {
    ast.Add: "py_int_add",
    ast.Sub: "py_int_sub",
    ast.Mult: "py_int_mul",
    ast.FloorDiv: "py_int_floordiv",
    ast.Mod: "py_int_mod",
    ast.Pow: "py_int_pow",
}
_COMPLEX = {ast.Add: "py_complex_add", ast.Sub: "py_complex_sub", ast.Mult: "py_complex_mul"}
_BITS = {ast.BitAnd: "py_int_and", ast.BitOr: "py_int_or", ast.BitXor: "py_int_xor"}
_SHIFTS = {ast.LShift: "py_int_lshift", ast.RShift: "py_int_rshift"}
_COMPARED = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
_COMPARE_KNOWN: dict[type[ast.cmpop], Callable[[Any, Any], object]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_MIXED = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "eq"}
_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
_EXACT = 2**53  # up to here an int is the same number as a float

FALSE = ir.Literal(BOOLEAN, False)


def binary(frame: Frame, node: ast.AST, op: ast.operator, left: Value, right: Value) -> Value:
    """Return the value of `left op right`."""
    if isinstance(left, Known) and isinstance(right, Known):
        folded = _folded(op, left.value, right.value)
        if folded is not None:
            return folded
    if isinstance(op, ast.MatMult):
        raise frame.refuse(node, "a product of matrices", "write the loops")
    joined = _joined(frame, node, op, left, right)
    if joined is not None:
        return joined
    a, b = frame.expr(node, left), frame.expr(node, right)
    for value in (a, b):
        if value.type not in (REAL, COMPLEX) and not is_integral(value.type):
            raise frame.refuse(
                node, f"{described(Run(value))} is no number", "write the operation item by item"
            )
    if COMPLEX in (a.type, b.type):
        return _complex(frame, node, op, a, b)
    if REAL in (a.type, b.type):
        return _real(frame, node, op, as_real(a), as_real(b), b)
    return _integer(frame, node, op, as_integer(a), as_integer(b))


def _joined(frame: Frame, node: ast.AST, op: ast.operator, left: Value, right: Value) -> Group | None:
    """Return two tuples one behind the other, or a tuple some times; None for other operands."""
    if isinstance(op, ast.Add) and _is_tuple(frame, left) and _is_tuple(frame, right):
        return Group((*frame.items(node, left), *frame.items(node, right)))
    times = right.value if isinstance(right, Known) and isinstance(op, ast.Mult) else None
    return Group(left.items * times) if isinstance(left, Group) and type(times) is int else None


def _is_tuple(frame: Frame, value: Value) -> bool:
    if isinstance(value, Run):
        return isinstance(value.type, ArrayType)
    return isinstance(value, Group) or (isinstance(value, Known) and isinstance(value.value, tuple))


def _folded(op: ast.operator, left: object, right: object) -> Known | None:
    """Return the result for two values that are known; None where it fails, or is computed by libm."""
    numbers = number_type(left) is not None and number_type(right) is not None
    if isinstance(op, ast.Pow) and not (type(left) is int and type(right) is int and right >= 0):
        return None
    if (
        not (numbers or (isinstance(left, tuple) and isinstance(right, tuple | int)))
        or type(op) not in _PYTHON
    ):
        return None
    try:
        result = _PYTHON[type(op)](left, right)
    except (ArithmeticError, TypeError, ValueError):
        return None
    return Known(result)


def _real(
    frame: Frame, node: ast.AST, op: ast.operator, a: ir.Expression, b: ir.Expression, given: ir.Expression
) -> Value:
    if type(op) in _SIGN:
        return Run(ir.Operation(REAL, _SIGN[type(op)], (a, b)))
    if isinstance(op, ast.Div) and is_nonzero(b):
        return Run(ir.Operation(REAL, "/", (a, b)))
    if type(op) in _BITS or type(op) in _SHIFTS:
        raise frame.refuse(node, "bits of a float", "compute with whole numbers")
    if isinstance(op, ast.Pow):
        return _power(frame, node, a, b, given)
    return frame.checked(node, REAL, _REAL_CHECKED[type(op)], (a, b))


def _power(frame: Frame, node: ast.AST, a: ir.Expression, b: ir.Expression, given: ir.Expression) -> Value:
    """Return a ** b of reals, where Python's result cannot be complex."""
    whole = isinstance(b, ir.Literal) and isinstance(b.value, float) and b.value.is_integer()
    positive = isinstance(a, ir.Literal) and isinstance(a.value, float) and a.value > 0.0
    if not (whole or positive or is_integral(given.type)):
        raise frame.refuse(
            node,
            "a negative number to a power that is no whole number is complex",
            "write math.pow(x, y) or math.sqrt(x)",
        )
    return frame.checked(node, REAL, "py_float_pow", (a, b))


def _integer(frame: Frame, node: ast.AST, op: ast.operator, a: ir.Expression, b: ir.Expression) -> Value:
    if isinstance(op, ast.Div):
        return frame.checked(node, REAL, "py_int_div", (a, b))
    if type(op) in _BITS:
        return Run(ir.Apply(INTEGER, _BITS[type(op)], (a, b)))
    if type(op) in _SHIFTS:
        return frame.checked(node, INTEGER, _SHIFTS[type(op)], (a, b))
    if isinstance(op, ast.Pow) and not (isinstance(b, ir.Literal) and _as_int(b) >= 0):
        raise frame.refuse(
            node,
            "the type of an int to a power that may be negative is not known",
            "write float(n) ** k, or a number that is not negative as the power",
        )
    if type(op) in _SIGN:
        sign = _SIGN[type(op)]
        if fits(combined(sign, interval(a, frame.ranges), interval(b, frame.ranges))):
            return Run(ir.Operation(INTEGER, sign, (a, b)))
    return frame.checked(node, INTEGER, _INTEGER_CHECKED[type(op)], (a, b))


def _complex(frame: Frame, node: ast.AST, op: ast.operator, a: ir.Expression, b: ir.Expression) -> Value:
    if isinstance(op, ast.Pow) and isinstance(b, ir.Literal) and is_integral(b.type):
        return frame.checked(node, COMPLEX, "py_complex_pow", (a, ir.Literal(COMPLEX, complex(_as_int(b)))))
    if type(op) not in _COMPLEX and not isinstance(op, ast.Div):
        raise frame.refuse(
            node, "of complex numbers only + - * / and ** by a known int are lowered", "use .real and .imag"
        )
    if a.type is not COMPLEX or b.type is not COMPLEX:
        raise frame.refuse(
            node,
            "complex and real mixed: the result differs between versions of Python (3.14)",
            "write complex(a, 0.0) * z",
        )
    if isinstance(op, ast.Div):
        return frame.checked(node, COMPLEX, "py_complex_div", (a, b))
    return Run(ir.Apply(COMPLEX, _COMPLEX[type(op)], (a, b)))


def _as_int(e: ir.Literal) -> int:
    assert not isinstance(e.value, complex)
    return int(e.value)


def unary(frame: Frame, node: ast.UnaryOp, value: Value) -> Value:
    """Return the value of -x or +x."""
    if isinstance(node.op, ast.Invert):
        e = frame.expr(node, value)
        if not is_integral(e.type):
            raise frame.refuse(node, f"bits of {described(value)}", "compute with whole numbers")
        return Run(ir.Apply(INTEGER, "py_int_invert", (as_integer(e),)))
    minus = isinstance(node.op, ast.USub)
    if isinstance(value, Known) and isinstance(value.value, int | float | complex):
        result = -value.value if minus else +value.value
        if number_type(result) is not None:
            return Known(result)
    e = frame.expr(node, value)
    if is_integral(e.type):
        e = as_integer(e)
        return frame.checked(node, INTEGER, "py_int_neg", (e,)) if minus else Run(e)
    if e.type not in (REAL, COMPLEX):
        raise frame.refuse(node, f"{described(value)} is no number", "write the operation item by item")
    if not minus:
        return Run(e)
    return Run(ir.Operation(REAL, "-", (e,)) if e.type is REAL else ir.Apply(COMPLEX, "py_complex_neg", (e,)))


# -- comparisons and truth -----------------------------------------------------------------------------------


def compare(frame: Frame, node: ast.AST, op: ast.cmpop, left: Value, right: Value) -> Known | Run:
    """Return the value of `left op right`; the operands are read once."""
    if isinstance(op, ast.In | ast.NotIn):
        return _contained(frame, node, isinstance(op, ast.NotIn), left, right)
    if isinstance(op, ast.Is | ast.IsNot):
        return _identical(frame, node, isinstance(op, ast.IsNot), left, right)
    if isinstance(left, Known) and isinstance(right, Known):
        return Known(bool(_COMPARE_KNOWN[type(op)](left.value, right.value)))
    a, b = frame.expr(node, left), frame.expr(node, right)
    return _compared(frame, node, _COMPARED[type(op)], a, b)


def _compared(frame: Frame, node: ast.AST, sign: str, a: ir.Expression, b: ir.Expression) -> Run:
    """Return a comparison of numbers; that of an int with a float is exact, as Python's."""
    if a.type is REAL and b.type is REAL:
        return Run(ir.Operation(BOOLEAN, sign, (a, b)))
    if is_integral(a.type) and is_integral(b.type):
        both = (a, b) if a.type == b.type and a.type is not BOOLEAN else (as_integer(a), as_integer(b))
        return Run(ir.Operation(BOOLEAN, sign, both))
    if REAL in (a.type, b.type) and (is_integral(a.type) or is_integral(b.type)):
        if a.type is REAL:
            a, b, sign = b, a, _TURNED[sign]
        low, high = interval(as_integer(a), frame.ranges)
        if low >= -_EXACT and high <= _EXACT:
            return Run(ir.Operation(BOOLEAN, sign, (as_real(as_integer(a)), b)))
        found = ir.Apply(BOOLEAN, f"py_int_{_MIXED[sign]}_float", (as_integer(a), b))
        return Run(ir.Operation(BOOLEAN, "not", (found,)) if sign == "!=" else found)
    if COMPLEX in (a.type, b.type):
        raise frame.refuse(node, "complex numbers compared", "compare their .real and .imag")
    raise frame.refuse(
        node,
        f"{described(Run(a))} and {described(Run(b))} compared",
        "compare their items, which are numbers",
    )


def _contained(frame: Frame, node: ast.AST, negated: bool, left: Value, right: Value) -> Known | Run:
    if isinstance(left, Known) and isinstance(right, Known):
        assert hasattr(right.value, "__contains__")
        return Known((left.value in right.value) is not negated)
    item = frame.simple(node, left)
    tests = []
    for other in frame.items(node, right):
        if not (_is_number(left) or _is_number(other)):
            raise frame.refuse(
                node, "`in` takes a NaN for equal to itself, `==` does not", "write x == a or x == b"
            )
        found = compare(frame, node, ast.NotEq() if negated else ast.Eq(), item, other)
        tests.append(frame.expr(node, found))
    if not tests:
        return Known(negated)
    joined = tests[0]
    for test in tests[1:]:
        joined = ir.Operation(BOOLEAN, "and" if negated else "or", (joined, test))
    return Run(joined)


def _is_number(value: Value) -> bool:
    """Return True for a value that is no NaN: a whole number, or one that is known."""
    if isinstance(value, Known):
        return value.value == value.value
    return isinstance(value, Run) and is_integral(value.type)


def _identical(frame: Frame, node: ast.AST, negated: bool, left: Value, right: Value) -> Known | Run:
    if isinstance(right, Known) and right.value is None:
        return Known((isinstance(left, Known) and left.value is None) is not negated)
    raise frame.refuse(node, "`is` asks for the same object, and native values are copies", "write ==")


def truth_of(frame: Frame, node: ast.AST, value: Value) -> Known | Run:
    """Return the truth value of a value."""
    if isinstance(value, Known):
        return Known(bool(value.value))
    e = frame.expr(node, value)
    if e.type is BOOLEAN:
        return Run(e)
    if e.type is REAL:
        return Run(ir.Operation(BOOLEAN, "!=", (e, literal(0.0))))
    if e.type is INTEGER or isinstance(e.type, EnumType):
        return Run(ir.Operation(BOOLEAN, "!=", (as_integer(e), literal(0))))
    if e.type is COMPLEX:
        raise frame.refuse(node, "the truth value of a complex number", "write abs(z) != 0.0")
    raise frame.refuse(node, f"the truth value of {described(value)}", "write a comparison of numbers")


def negated(test: Known | Run) -> Known | Run:
    """Return `not test`."""
    if isinstance(test, Known):
        return Known(not test.value)
    return Run(ir.Operation(BOOLEAN, "not", (test.expr,)))
