"""The bounds of integers, so that an index or a product needs no check in every turn of a loop."""

from __future__ import annotations

from collections.abc import Mapping

from . import ir
from .values import BOOLEAN, EnumType

LOW, HIGH = -(2**63), 2**63 - 1

Interval = tuple[int, int]


def interval(e: ir.Expression, known: Mapping[str, Interval]) -> Interval:
    """Return the least and the largest value of an integer; `known` are those of variables."""
    match e:
        case ir.Literal():
            assert not isinstance(e.value, complex)
            return int(e.value), int(e.value)
        case ir.Local():
            return known.get(e.name, _of_type(e))
        case ir.Convert():
            return interval(e.value, known)
        case ir.Operation() if len(e.operands) == 2 and e.operator in ("+", "-", "*"):
            a, b = (interval(operand, known) for operand in e.operands)
            return combined(e.operator, a, b)
    return _of_type(e)


def combined(operator: str, a: Interval, b: Interval) -> Interval:
    """Return the bounds of a sum, a difference or a product."""
    if operator == "+":
        return a[0] + b[0], a[1] + b[1]
    if operator == "-":
        return a[0] - b[1], a[1] - b[0]
    products = [x * y for x in a for y in b]
    return min(products), max(products)


def fits(bounds: Interval) -> bool:
    """Return True if no value between the bounds leaves the 64 bits."""
    return bounds[0] >= LOW and bounds[1] <= HIGH


def _of_type(e: ir.Expression) -> Interval:
    if e.type is BOOLEAN:
        return 0, 1
    if isinstance(e.type, EnumType):
        values = [int(item) for item in e.type.enumeration]
        return min(values), max(values)
    return LOW, HIGH
