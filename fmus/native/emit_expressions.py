"""Expressions of a program as C."""

from __future__ import annotations

import dataclasses
import math

from . import ir
from .emit_types import c_name, type_name
from .values import (
    BOOLEAN,
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    EnumType,
    ListType,
    ParametersType,
    StructType,
    Type,
)

_C = {"and": "&&", "or": "||"}
_LEVELS = {
    "or": 1,
    "and": 2,
    "==": 3,
    "!=": 3,
    "<": 4,
    "<=": 4,
    ">": 4,
    ">=": 4,
    "+": 5,
    "-": 5,
    "*": 6,
    "/": 6,
}
_SELECT, _UNARY, _ATOM = 0, 7, 8


@dataclasses.dataclass(frozen=True)
class Scope:
    """Names that mean something else than a plain variable within one function.

    `addresses` are arguments that are handed on by address; `with_memory` are the functions of the program
    that are also given the memory of the remembered calls.
    """

    addresses: frozenset[str]
    with_memory: frozenset[str]


def expression(e: ir.Expression, scope: Scope) -> str:
    """Return an expression in C, without parentheses around it."""
    return _written(e, scope)[0]


def argument_list(function: str, arguments: tuple[ir.Expression, ...], scope: Scope, *more: str) -> str:
    """Return the arguments of a call of a function of the program, then `more`."""
    given = [handed(a, scope) for a in arguments]
    memory = ["memory"] if function in scope.with_memory else []
    return ", ".join([*given, *more[:-1], *memory, *more[-1:]] if more else [*given, *memory])


def handed(e: ir.Expression, scope: Scope) -> str:
    """Return an expression as an argument: a list and parameters by their address."""
    if isinstance(e, ir.Local) and isinstance(e.type, ListType | ParametersType):
        name = c_name(e.name)
        return name if e.name in scope.addresses else f"&{name}"
    return expression(e, scope)


def literal(type_: Type, value: float | int | bool | complex) -> str:
    """Return a number as a constant of C, the same to the last bit."""
    if type_ is COMPLEX:
        value = complex(value)
        return f"{{{_real(value.real)}, {_real(value.imag)}}}"
    assert not isinstance(value, complex)
    if type_ is REAL:
        return _real(float(value))
    if type_ is BOOLEAN:
        return "true" if value else "false"
    number = int(value)
    if number == -(2**63):
        return "INT64_MIN"
    return str(number) if abs(number) < 2**31 else f"INT64_C({number})"


def constant(e: ir.Expression) -> str:
    """Return the initializer of a table: literals, and arrays and structs of them."""
    if isinstance(e, ir.Literal):
        return literal(e.type, e.value)
    assert isinstance(e, ir.Make)
    inner = ", ".join(constant(item) for item in e.items)
    return f"{{{{{inner}}}}}" if isinstance(e.type, ArrayType) else f"{{{inner}}}"


def _real(value: float) -> str:
    if math.isnan(value):
        return "NAN"
    text = "INFINITY" if math.isinf(value) else repr(abs(value))
    return f"-{text}" if math.copysign(1.0, value) < 0.0 else text


def _written(e: ir.Expression, scope: Scope) -> tuple[str, int]:
    """Return an expression and how tightly it binds."""
    match e:
        case ir.Literal():
            text = literal(e.type, e.value)
            return (f"({type_name(e.type)}){text}" if e.type is COMPLEX else text), (
                _UNARY if text.startswith("-") else _ATOM
            )
        case ir.Local() | ir.TableItem():
            name = c_name(e.name)
            return (f"*{name}", _UNARY) if e.name in scope.addresses else (name, _ATOM)
        case ir.Field():
            return f"{_owner(e.of, scope)}{c_name(e.name)}", _ATOM
        case ir.Item():
            return f"{_owner(e.of, scope)}at[{expression(e.index, scope)}]", _ATOM
        case ir.Length():
            return f"{_owner(e.of, scope)}length", _ATOM
        case ir.Operation():
            return _operation(e, scope)
        case ir.Apply():
            return f"{e.function}({', '.join(expression(a, scope) for a in e.arguments)})", _ATOM
        case ir.Invoke():
            return f"{c_name(e.function)}({argument_list(e.function, e.arguments, scope)})", _ATOM
        case ir.Select():
            parts = (_inside(part, _SELECT + 1, scope) for part in (e.test, e.then, e.otherwise))
            return "{} ? {} : {}".format(*parts), _SELECT
        case ir.Convert():
            return _converted(e, scope)
        case ir.Make():
            return f"({type_name(e.type)}){_made(e, scope)}", _ATOM


def _owner(of: ir.Expression, scope: Scope) -> str:
    """Return what stands before the name of a field."""
    if isinstance(of, ir.Local) and of.name in scope.addresses:
        return f"{c_name(of.name)}->"
    text, level = _written(of, scope)
    return f"{text}." if level == _ATOM else f"({text})."


def _inside(e: ir.Expression, least: int, scope: Scope) -> str:
    text, level = _written(e, scope)
    return text if level >= least else f"({text})"


def _operation(e: ir.Operation, scope: Scope) -> tuple[str, int]:
    if len(e.operands) == 1:
        sign = "!" if e.operator == "not" else "-"
        inner = _inside(e.operands[0], _ATOM, scope)
        return f"{sign}{inner}", _UNARY
    level = _LEVELS[e.operator]
    left, right = (_inside(x, _least(x, e.operator, level, k), scope) for k, x in enumerate(e.operands))
    return f"{left} {_C.get(e.operator, e.operator)} {right}", level


def _least(operand: ir.Expression, operator: str, level: int, place: int) -> int:
    """Return how tightly an operand must bind to stand without parentheses.

    Sums and products are computed from the left, in C as in Python. Compilers warn of `a && b || c` and of
    `a < b == c`, so these get parentheses that C does not need.
    """
    if operator in ("and", "or"):
        return level if _same_operator(operand, operator) else _LEVELS["=="]
    if operator in ("+", "-", "*", "/"):
        return level + place
    return _LEVELS["+"]


def _same_operator(e: ir.Expression, operator: str) -> bool:
    return isinstance(e, ir.Operation) and e.operator == operator and len(e.operands) == 2


def _converted(e: ir.Convert, scope: Scope) -> tuple[str, int]:
    if e.type is COMPLEX:
        return f"(py_complex){{{expression(e.value, scope)}, 0.0}}", _ATOM
    if isinstance(e.type, EnumType) or (e.type is INTEGER and isinstance(e.value.type, EnumType)):
        return _written(e.value, scope)
    return f"({type_name(e.type)}){_inside(e.value, _ATOM, scope)}", _UNARY


def _made(e: ir.Make, scope: Scope) -> str:
    inner = ", ".join(expression(item, scope) for item in e.items)
    if isinstance(e.type, ArrayType):
        return f"{{{{{inner}}}}}"
    if isinstance(e.type, ListType):
        return f"{{{len(e.items)}, {{{inner or '0'}}}}}"
    assert isinstance(e.type, StructType)
    return f"{{{inner or '0'}}}"
