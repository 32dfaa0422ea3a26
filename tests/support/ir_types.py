"""The rules of a program of typed functions, which C does not check or checks too late."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from evcosim.fmus.native import ir
from evcosim.fmus.native.values import (
    BOOLEAN,
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    ListType,
    ParametersType,
    StructType,
    is_integral,
)

COMPARISONS = {"<", "<=", ">", ">=", "==", "!="}


def check(program: ir.Program) -> None:
    """Check types, names and the order of what is defined."""
    names = [f.name for f in program.functions] + [t.name for t in program.types + program.tables]
    assert len(set(names)) == len(names), "two things of one name"
    defined: set[str] = set()
    for struct in program.types:
        parts = {t.name for _, t in struct.fields if isinstance(t, StructType)}
        assert parts <= defined, f"{struct.name} stands before {parts - defined}"
        defined.add(struct.name)
    done: dict[str, ir.Function] = {}
    for function in program.functions:
        _function(function, program, done, set(names))
        done[function.name] = function


def _function(f: ir.Function, program: ir.Program, done: dict[str, ir.Function], names: set[str]) -> None:
    own = {x.name: x.type for x in (*f.arguments, *f.locals)}
    assert len(own) == len(f.arguments) + len(f.locals), f"{f.name}: two variables of one name"
    assert not set(own) & names, f"{f.name}: {set(own) & names} are names of functions, types or tables"
    fails = False
    for node in parts(f.body):
        if isinstance(node, ir.Local):
            assert own[node.name] == node.type, (f.name, node)
        elif isinstance(node, ir.Call | ir.Invoke):
            callee = done[node.function]
            assert [a.type for a in node.arguments] == [a.type for a in callee.arguments], (f.name, node)
            fails |= callee.can_fail
            if isinstance(node, ir.Invoke):
                assert not callee.can_fail and node.type == callee.returns, (f.name, node)
            elif node.target is not None:
                assert node.target.type == callee.returns, (f.name, node)
        elif isinstance(node, ir.Derive):
            type_, function = program.parameters.derived[node.name]
            assert node.target.type == type_ == done[function].returns
            fails |= done[function].can_fail
        elif isinstance(node, ir.Return):
            assert (None if node.value is None else node.value.type) == f.returns, (f.name, node)
        fails |= isinstance(node, ir.Checked | ir.Raise)
        _node(node)
    assert fails == f.can_fail, f.name


def _node(node: Any) -> None:
    match node:
        case ir.Assign():
            assert node.target.type == node.value.type, node
        case ir.SetItem():
            assert isinstance(node.list.type, ListType) and node.list.type.item == node.value.type, node
        case ir.If() | ir.While() | ir.Select():
            assert node.test.type is BOOLEAN, node
        case ir.For():
            assert {node.local.type, node.start.type, node.stop.type} == {INTEGER} and node.step, node
        case ir.Operation():
            _operation(node)
        case ir.Field():
            if node.of.type is COMPLEX:
                assert node.name in ("re", "im") and node.type is REAL
            else:
                assert isinstance(node.of.type, StructType | ParametersType)
                assert dict(node.of.type.fields)[node.name] == node.type, node
        case ir.Item():
            assert isinstance(node.of.type, ArrayType | ListType) and node.index.type is INTEGER, node
            assert node.of.type.item == node.type
        case ir.Make():
            _make(node)
        case ir.Shown():
            assert node.value.type in (REAL, INTEGER, BOOLEAN), node
    if isinstance(node, ir.Select):
        assert node.then.type == node.otherwise.type == node.type, node


def _operation(node: ir.Operation) -> None:
    types = {operand.type for operand in node.operands}
    assert len(types) == 1, node
    (of,) = types
    if node.operator in ("and", "or", "not"):
        assert of is BOOLEAN and node.type is BOOLEAN, node
    elif node.operator in COMPARISONS:
        assert (of is REAL or is_integral(of)) and node.type is BOOLEAN, node
    else:
        assert of in (REAL, INTEGER) and node.type == of, node


def _make(node: ir.Make) -> None:
    given = [item.type for item in node.items]
    if isinstance(node.type, StructType):
        assert given == [t for _, t in node.type.fields], node
    elif isinstance(node.type, ArrayType):
        assert given == [node.type.item] * node.type.length, node
    else:
        assert isinstance(node.type, ListType) and given == [node.type.item] * node.type.capacity, node


def parts(node: Any) -> Iterator[Any]:
    """Return all expressions and statements within a block."""
    if isinstance(node, tuple):
        for part in node:
            yield from parts(part)
    elif (
        dataclasses.is_dataclass(node)
        and not isinstance(node, ir.Place)
        and type(node).__module__ == ir.__name__
    ):
        yield node
        for f in dataclasses.fields(node):
            if f.name != "type":
                yield from parts(getattr(node, f.name))
