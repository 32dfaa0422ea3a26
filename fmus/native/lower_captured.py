"""Functions in functions: what they capture, and the parameters that they need where they are called."""

from __future__ import annotations

import ast

from . import ir
from .lower_binding import Bound, node_of
from .lower_frame import Frame
from .lower_source import parameters, read_names, statements, stored
from .lower_types import Names
from .lower_values import Callable, Known, LocalFunction, Missing, Run, Value, described, is_parameters
from .values import ListType, Type


def captured(frame: Frame, node: ast.FunctionDef | ast.Lambda, name: str) -> Value:
    """Return a function in this function, with the values that it captures."""
    a = node.args
    if a.defaults or a.kw_defaults or a.vararg or a.kwarg:
        raise frame.refuse(
            node, "defaults or `*` in a function in a function", "name all parameters, without"
        )
    inside = {*parameters(node), *stored(statements(node))}
    known: list[tuple[str, Value]] = []
    fields: list[tuple[str, ir.Expression]] = []
    for free in read_names(node):
        if free in inside or not (free in frame.env or free in frame.stores):
            continue
        value = _captured_value(frame, node, free, name)
        e = None if isinstance(value, Known) or is_parameters(value) else frame.types.expression(value)
        if e is not None:
            fields.append((free, e))
        elif isinstance(value, Known | Callable) or is_parameters(value):
            known.append((free, value))
        else:
            raise frame.refuse(
                node, f"{described(value)} is captured as {free}", "capture numbers and tuples"
            )
    code = LocalFunction(name, node, frame.module, tuple(known))
    if not fields:
        return Callable(code)
    struct = frame.types.captured(name, code.key(), [(n, e.type) for n, e in fields])
    made = ir.Make(struct, tuple(e for _, e in fields))
    frame.types.callables.setdefault(struct, Callable(code, (Run(made),)))
    return Run(made)


def _captured_value(frame: Frame, node: ast.AST, free: str, own: str) -> Value:
    if free == own and isinstance(node, ast.FunctionDef):
        raise frame.refuse(node, "a function that calls itself", "write a loop")
    value = frame.env.get(free)
    if value is None or isinstance(value, Missing):
        raise frame.refuse(node, f"{free} is captured before it has a value", "define the function after it")
    last = getattr(node, "end_lineno", 0)
    if any(line > last for line in frame.stores.get(free, ())):
        raise frame.refuse(
            node, f"{free} is captured and changes afterwards", "give what changes another name"
        )
    if isinstance(value, Run) and isinstance(value.type, ListType):
        raise frame.refuse(node, f"the list {free} is captured", "hand it in as an argument")
    return value


def handed_on(frame: Frame, node: ast.expr, callee: Callable, given: Bound) -> Bound:
    """Return the parameters as one more argument, if a function that is called or given needs them."""
    held = [callee, *(value for _, value in given)]
    needed = next((n for n in map(frame.types.needed_parameters, held) if n is not None), None)
    if needed is None or any(is_parameters(value) for _, value in given):
        return []
    body = node_of(callee.code)
    name = Names([*parameters(body), *stored(statements(body)), *read_names(body)]).new("parameters")
    return [(name, own_parameters(frame, node, needed))]


def own_parameters(frame: Frame, node: ast.expr, needed: Type) -> Run:
    """Return the parameters as this function has them; there is one object of them."""
    for value in frame.env.values():
        if isinstance(value, Run) and value.type == needed:
            return value
    raise frame.refuse(node, "the parameters are not here", "hand them on as an argument")
