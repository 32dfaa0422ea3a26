"""Arguments of a call: by place, by name, by default; and what of them the native function is given."""

from __future__ import annotations

import ast
import dataclasses
import functools
import types
from collections.abc import Sequence

from . import ir
from .lower_frame import Frame
from .lower_source import FunctionNode, source_of
from .lower_text import is_text
from .lower_types import Types
from .lower_values import Callable, Code, Group, Known, LocalFunction, Value

Bound = list[tuple[str, Value]]


def node_of(code: Code) -> FunctionNode:
    """Return the syntax tree of a function."""
    return code.node if isinstance(code, LocalFunction) else source_of(code)[0]


def bind(
    frame: Frame, node: ast.expr, callee: Callable, given: Sequence[Value], named: dict[str, Value]
) -> Bound:
    """Return the value of each parameter of a function."""
    code = callee.code
    if isinstance(code, types.FunctionType) and hasattr(code, "__wrapped__"):
        raise frame.refuse(node, f"the decorator of {code.__name__}", "write the function without it")
    args = node_of(code).args
    if args.kwarg is not None:
        raise frame.refuse(node, f"`**{args.kwarg.arg}` in a function", "name its parameters")
    places = [*args.posonlyargs, *args.args]
    values = [*given] if isinstance(code, LocalFunction) else [*callee.bound, *given]
    bound: Bound = [(p.arg, value) for p, value in zip(places, values, strict=False)]
    rest = values[len(places) :]
    if args.vararg is not None:
        bound.append((args.vararg.arg, _rest(rest)))
    elif rest:
        raise frame.refuse(node, f"{len(values)} values for {len(places)} parameters", "give it as many")
    defaults = _defaults(code, [p.arg for p in places])
    have = {name for name, _ in bound}
    if twice := have & set(named):
        raise frame.refuse(node, f"{', '.join(sorted(twice))} is given twice", "give it once")
    for p in [*places, *args.kwonlyargs]:
        if p.arg in have:
            continue
        value = named.get(p.arg) or defaults.get(p.arg)
        if value is None:
            raise frame.refuse(node, f"{p.arg} is missing", "give it a value")
        if p.arg not in named:
            _check_default(frame, node, p.arg, value)
        bound.append((p.arg, value))
    unknown = set(named) - {name for name, _ in bound}
    if unknown:
        raise frame.refuse(
            node, f"there is no parameter {', '.join(sorted(unknown))}", "name one that there is"
        )
    return bound


def _rest(values: Sequence[Value]) -> Value:
    if all(isinstance(v, Known) for v in values):
        return Known(tuple(v.value for v in values if isinstance(v, Known)))
    return Group(tuple(values))


def _defaults(code: Code, places: list[str]) -> dict[str, Value]:
    if isinstance(code, LocalFunction):
        return {}
    last = code.__defaults__ or ()
    found = dict(zip(places[len(places) - len(last) :], last, strict=True))
    return {name: Known(value) for name, value in {**found, **(code.__kwdefaults__ or {})}.items()}


def _check_default(frame: Frame, node: ast.expr, name: str, value: Value) -> None:
    if isinstance(value, Known) and isinstance(value.value, list | dict | set):
        raise frame.refuse(node, f"the default of {name} can change", "write a tuple")


def takes_text(bound: Bound) -> bool:
    """Return True for a call that is given a text, or several."""
    return any(
        is_text(v)
        or (isinstance(v, Known) and isinstance(v.value, tuple) and any(isinstance(x, str) for x in v.value))
        for _, v in bound
    )


def native(types_: Types, value: Value, numbers_known: bool) -> ir.Expression | None:
    """Return what of an argument the native function is given; None for what is known when it is built."""
    if isinstance(value, Known):
        if numbers_known and _is_whole(value.value):
            return None
        if has_derived(type(value.value)):  # type: ignore[arg-type] # every class is hashable
            return None
    return types_.expression(value)


@functools.cache
def counting_names(node: FunctionNode) -> frozenset[str]:
    """Return the names that a function uses in ranges, indices and lengths of lists, or hands on.

    A whole number that is known stays so in an argument of such a name: then no index needs a check.
    """
    counted: list[ast.AST] = []
    for part in ast.walk(node):
        if isinstance(part, ast.Call):
            is_range = isinstance(part.func, ast.Name) and part.func.id == "range"
            counted += [a for a in part.args if is_range or isinstance(a, ast.Name)]
        elif isinstance(part, ast.Subscript):
            counted.append(part.slice)
        elif isinstance(part, ast.BinOp) and isinstance(part.left, ast.List):
            counted.append(part.right)
    return frozenset(n.id for part in counted for n in ast.walk(part) if isinstance(n, ast.Name))


def _is_whole(value: object) -> bool:
    if isinstance(value, tuple):
        return bool(value) and all(_is_whole(item) for item in value)
    return type(value) is int


@functools.cache
def has_derived(python: type[object]) -> bool:
    """Return True for a record with cached properties."""
    return dataclasses.is_dataclass(python) and any(
        isinstance(value, functools.cached_property)
        for base in python.__mro__
        for value in vars(base).values()
    )


def has_whole_number(bound: Bound) -> bool:
    """Return True if an argument is a whole number that is known, or some of them."""
    return any(isinstance(v, Known) and _is_whole(v.value) for _, v in bound)
