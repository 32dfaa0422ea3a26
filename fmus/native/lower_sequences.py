"""Tuples, lists and tables: their items, their parts, comprehensions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

from . import ir
from .lower_frame import Frame
from .lower_intervals import interval
from .lower_text import is_text
from .lower_types import is_enumeration, is_named_tuple
from .lower_values import Group, Known, Run, Value, as_integer, described, literal, reads_list
from .values import BOOLEAN, INTEGER, ArrayType, EnumType, ListType, StructType, is_integral

LONGEST = 256  # items that are written one by one


def items(frame: Frame, node: ast.AST, value: Value) -> list[Value]:
    """Return the items of a value whose length is known."""
    if isinstance(value, Group):
        return list(value.items)
    if isinstance(value, Known):
        return _known_items(frame, node, value.value)
    if isinstance(value, Run):
        type_ = value.type
        if isinstance(value.expr, ir.Make) and isinstance(type_, ListType):
            return [Run(item) for item in value.expr.items]
        if isinstance(type_, ArrayType | ListType):
            of = frame.simple(node, value).expr if isinstance(type_, ArrayType) else value.expr
            length = type_.length if isinstance(type_, ArrayType) else type_.capacity
            if length > LONGEST:
                raise frame.refuse(node, f"{length} items one by one are too many", "write a loop over range")
            return [Run(ir.Item(type_.item, of, literal(k))) for k in range(length)]
        if isinstance(type_, StructType) and is_tuple(frame, type_):
            of = frame.simple(node, value).expr
            return [Run(ir.Field(field, of, name)) for name, field in type_.fields]
    raise frame.refuse(
        node, f"{described(value)} is no tuple or list of a known length", "write out its items"
    )


def _known_items(frame: Frame, node: ast.AST, value: object) -> list[Value]:
    if isinstance(value, tuple | list | range | dict | str) or is_enumeration(value):
        found: list[Value] = [Known(item) for item in iter(value)]  # type: ignore[call-overload] # a class too
        if len(found) <= LONGEST:
            return found
        raise frame.refuse(node, f"{len(found)} items one by one are too many", "write a loop over range")
    if isinstance(value, set | frozenset):
        raise frame.refuse(node, "the order of a set is not known", "write a tuple")
    raise frame.refuse(node, f"{described(Known(value))} has no known length", "write a tuple")


def is_tuple(frame: Frame, type_: StructType) -> bool:
    """Return True for the struct of a tuple or of a NamedTuple."""
    return (type_.python is None and type_ not in frame.types.callables) or is_named_tuple(type_.python)


def length_of(frame: Frame, node: ast.AST, value: Value) -> int:
    """Return how many items a value has."""
    if isinstance(value, Run) and isinstance(value.type, ListType):
        return value.type.capacity
    if isinstance(value, Run) and isinstance(value.type, ArrayType):
        return value.type.length
    if isinstance(value, Known) and hasattr(value.value, "__len__"):
        return len(value.value)
    return len(items(frame, node, value))


# -- parts ---------------------------------------------------------------------------------------------------


def subscript(frame: Frame, node: ast.Subscript) -> Value:
    """Return `value[index]`."""
    if isinstance(node.slice, ast.Slice):
        return _slice(frame, node, frame.value(node.value), node.slice)
    value, index = frame.values([node.value, node.slice])
    return item_of(frame, node, value, index)


def item_of(frame: Frame, node: ast.Subscript, value: Value, index: Value) -> Value:
    """Return an item of a value by its index."""
    if isinstance(value, Known) and isinstance(value.value, dict):
        return _looked_up(frame, node, value.value, index)
    if isinstance(index, Known) and not isinstance(index.value, int):
        raise frame.refuse(node, f"{described(index)} is no index", "write a whole number")
    if isinstance(index, Known) and not (
        isinstance(value, Run) and isinstance(value.type, ArrayType | ListType)
    ):
        found = items(frame, node, value)
        assert isinstance(index.value, int)
        if not -len(found) <= index.value < len(found):
            raise frame.refuse(node, f"there are {len(found)} items", "write an index within them")
        return found[index.value]
    of = _indexable(frame, node, value)
    if not isinstance(of.type, ArrayType | ListType):
        raise frame.refuse(
            node,
            "items of different types, or fields, have no index that is known only when it runs",
            "write their names",
        )
    return Run(ir.Item(of.type.item, of, checked_index(frame, node, of, index)))


def _indexable(frame: Frame, node: ast.Subscript, value: Value) -> ir.Expression:
    e = frame.expr(node, value)
    if isinstance(value, Known) and isinstance(e, ir.Make):
        name = node.value.id if isinstance(node.value, ast.Name) else "TABLE"
        return frame.types.table(name, e)
    if isinstance(e, ir.Make):
        return frame.keep(e).expr
    return e


def checked_index(
    frame: Frame, node: ast.AST, of: ir.Expression, index: Value, check: str = ""
) -> ir.Expression:
    """Return an index within the length of an array or a list, counted from the front.

    `check` is the function that fails for another one, by default that for reading.
    """
    e = frame.expr(node, index)
    if not is_integral(e.type):
        raise frame.refuse(node, f"{described(index)} is no index", "write a whole number")
    e = as_integer(e)
    assert isinstance(of.type, ArrayType | ListType)
    is_array = isinstance(of.type, ArrayType)
    length = of.type.length if isinstance(of.type, ArrayType) else of.type.capacity
    low, high = interval(e, frame.ranges)
    if low >= 0 and high < length:
        return e
    if isinstance(e, ir.Literal) and -length <= low < 0:
        return literal(low + length)
    check = check or ("py_tuple_index" if is_array else "py_list_index")
    return frame.checked(node, INTEGER, check, (e, literal(length))).expr


def _slice(frame: Frame, node: ast.AST, value: Value, part: ast.Slice) -> Value:
    bounds: list[Any] = []
    for bound in (part.lower, part.upper, part.step):
        found = Known(None) if bound is None else frame.value(bound)
        if not isinstance(found, Known):
            raise frame.needs_number(node, "the length of this part is not known", "write numbers, or a loop")
        bounds.append(found.value)
    chosen = items(frame, node, value)[slice(*bounds)]
    if isinstance(value, Run) and isinstance(value.type, ListType):
        return listed(frame, node, chosen)
    if isinstance(value, Known) and all(isinstance(item, Known) for item in chosen):
        return Known(value.value[slice(*bounds)])  # type: ignore[index] # it has items
    return Group(tuple(chosen))


def _looked_up(frame: Frame, node: ast.AST, table: dict[object, object], key: Value) -> Value:
    """Return the value of a dictionary of constants for a key."""
    if isinstance(key, Known):
        if key.value not in table:
            raise frame.refuse(node, f"the dictionary has no {key.value!r}", "write one of its keys")
        return Known(table[key.value])
    k = frame.simple(node, key).expr
    values = [frame.expr(node, Known(value)) for value in table.values()]
    if not is_integral(k.type) or not all(isinstance(known, int) for known in table) or not values:
        raise frame.refuse(
            node, f"{described(key)} as a key", "write a dictionary with items of an IntEnum as keys"
        )
    if any(value.type != values[0].type for value in values):
        raise frame.refuse(
            node, "the values of the dictionary have different types", "write values of one type"
        )
    _refuse_others(frame, node, table, k)
    order = sorted(range(len(values)), key=lambda i: int(list(table)[i]))  # type: ignore[call-overload] # a dict by integers
    numbers = [int(key) for key in sorted(table)]  # type: ignore[type-var, call-overload] # they are integers
    made = ir.Make(ArrayType(values[0].type, len(values)), tuple(values[i] for i in order))
    where = node.value if isinstance(node, ast.Subscript) else node
    name = where.id if isinstance(where, ast.Name) else "TABLE"
    return Run(ir.Item(values[0].type, frame.types.table(name, made), _position(as_integer(k), numbers)))


def _position(k: ir.Expression, numbers: list[int]) -> ir.Expression:
    """Return the place of a number in a list of numbers."""
    if numbers == list(range(len(numbers))):
        return k
    found: ir.Expression = literal(len(numbers) - 1)
    for place in reversed(range(len(numbers) - 1)):
        test = ir.Operation(BOOLEAN, "==", (k, literal(numbers[place])))
        found = ir.Select(INTEGER, test, literal(place), found)
    return found


def _refuse_others(frame: Frame, node: ast.AST, table: dict[object, object], k: ir.Expression) -> None:
    """Fail as Python does for a key that the dictionary does not have."""
    place = frame.module.place(node)
    if isinstance(k.type, EnumType):
        for item in k.type.enumeration:
            if item not in table:
                test = ir.Operation(BOOLEAN, "==", (k, ir.Literal(k.type, int(item))))
                frame.emit(ir.If(test, (ir.Raise("KeyError", (repr(item),), place),)))
        return
    tests = [ir.Operation(BOOLEAN, "!=", (as_integer(k), literal(int(key)))) for key in table]  # type: ignore[call-overload] # the same
    missing: ir.Expression = tests[0]
    for test in tests[1:]:
        missing = ir.Operation(BOOLEAN, "and", (missing, test))
    frame.emit(ir.If(missing, (ir.Raise("KeyError", (ir.Shown(as_integer(k)),), place),)))


# -- displays and comprehensions -----------------------------------------------------------------------------


def listed(frame: Frame, node: ast.AST, values: list[Value]) -> Value:
    """Return a new list of these items."""
    if not values:
        raise frame.refuse(
            node, "a list without items never has any", "write [0.0] * N, the most that it holds"
        )
    if all(is_text(value) for value in values):
        return Group(tuple(values))  # it is joined where it is shown
    made = [frame.expr(node, value) for value in values]
    if any(e.type != made[0].type for e in made):
        raise frame.refuse(node, "items of different types", "write 0.0 where an item is a float")
    if isinstance(made[0].type, ListType):
        raise frame.refuse(node, "a list of lists", "write one list, and m[n * i + j] for its items")
    return Run(ir.Make(ListType(made[0].type, len(made)), tuple(made)))


def repeated(frame: Frame, node: ast.BinOp) -> Value | None:
    """Return `[x] * N`; None for another product."""
    display, count = node.left, node.right
    if isinstance(count, ast.List):
        display, count = count, display
    if not isinstance(display, ast.List):
        return None
    values, n = frame.values(display.elts), frame.value(count)
    if not isinstance(n, Known) or not isinstance(n.value, int):
        raise frame.needs_number(
            node, "the length of the list is not known", "write a number that is constant"
        )
    if n.value * len(values) > 4096:
        raise frame.refuse(node, f"a list of {n.value * len(values)} items is too long", "write at most 4096")
    items_of: list[Value] = [frame.simple(node, v) for v in values]
    return listed(frame, node, items_of * n.value)


def elements(frame: Frame, nodes: list[ast.expr]) -> list[Value]:
    """Return the values of a display or of arguments, with those behind a star one by one."""
    found: list[Value] = []
    marks = []
    for node in nodes:
        if isinstance(node, ast.Starred):
            found.append(Group(tuple(items(frame, node, frame.value(node.value)))))
        else:
            found.append(frame.value(node))
        marks.append(len(frame.block))
    held = [frame.held(marks[k], found[k]) for k in reversed(range(len(nodes)))][::-1]
    parts = (
        value.items if isinstance(node, ast.Starred) and isinstance(value, Group) else (value,)
        for node, value in zip(nodes, held, strict=True)
    )
    return [value for part in parts for value in part]


def comprehension(frame: Frame, node: ast.ListComp | ast.GeneratorExp) -> list[Value]:
    """Return the values of a comprehension over what has a known length."""
    names = {n.id for g in node.generators for n in ast.walk(g.target) if isinstance(n, ast.Name)}
    hidden = {name: frame.env.get(name) for name in names}
    found: list[Value] = []
    marks: list[int] = []
    for value in _turns(frame, node, 0):
        found.append(value)
        marks.append(len(frame.block))
    found = [frame.held(marks[k], found[k]) for k in reversed(range(len(found)))][::-1]
    for name, before in hidden.items():
        frame.env.pop(name, None)
        if before is not None:
            frame.env[name] = before
    return found


def _turns(frame: Frame, node: ast.ListComp | ast.GeneratorExp, depth: int) -> Iterator[Value]:
    if depth == len(node.generators):
        yield frame.value(node.elt)
        return
    clause = node.generators[depth]
    for item in items(frame, clause.iter, frame.value(clause.iter)):
        _bind(frame, clause.target, item)
        tests = [frame.truth(test) for test in clause.ifs]
        if not all(isinstance(test, Known) for test in tests):
            raise frame.refuse(node, "how many items there are is not known", "write a loop")
        if all(isinstance(test, Known) and test.value for test in tests):
            yield from _turns(frame, node, depth + 1)


def _bind(frame: Frame, target: ast.expr, value: Value) -> None:
    """Give the variable of a comprehension its value, which needs no variable of its own."""
    if isinstance(target, ast.Name):
        reads = isinstance(value, Run) and reads_list(value.expr)
        frame.env[target.id] = frame.keep(value.expr) if reads and isinstance(value, Run) else value
        return
    if not isinstance(target, ast.Tuple | ast.List):
        raise frame.refuse(target, "this target in a comprehension", "write a name")
    found = items(frame, target, value)
    if len(found) != len(target.elts):
        raise frame.refuse(target, f"{len(found)} values for {len(target.elts)} names", "write as many names")
    for part, item in zip(target.elts, found, strict=True):
        _bind(frame, part, item)
