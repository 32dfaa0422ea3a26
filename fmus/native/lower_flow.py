"""Branches and loops: what a variable is on all paths."""

from __future__ import annotations

import ast
import dataclasses
from collections.abc import Callable, Sequence

from . import ir
from .lower_arithmetic import truth_of
from .lower_frame import Env, Frame, Loop
from .lower_intervals import Interval, interval
from .lower_order import check_lazy
from .lower_sequences import items, length_of
from .lower_source import own_nodes, stored
from .lower_values import Group, Known, Missing, Run, Value, as_integer, literal, same, type_name
from .values import INTEGER, ArrayType, ListType, StructType, Type, is_integral

UNROLLED = 64  # items of different types that a loop is written out for

_LATER = Missing("may be undefined here", "give it a value on every path")


def branch(frame: Frame, node: ast.If) -> bool:
    """Lower an `if`; return True if nothing behind it is reached."""
    test = frame.truth(node.test)
    if isinstance(test, Known):
        return frame.run(node.body if test.value else node.orelse)
    before = dict(frame.env)
    with frame.nested() as then:
        then_ends = frame.run(node.body)
    after_then, frame.env = frame.env, before
    with frame.nested() as otherwise:
        else_ends = frame.run(node.orelse)
    after_else = frame.env
    if then_ends or else_ends:
        frame.env = after_else if then_ends else after_then
    else:
        frame.env = merged(frame, node, [(after_then, then), (after_else, otherwise)])
    note = frame.module.note(node.lineno, node.test.end_lineno or node.lineno)
    if then or otherwise:
        frame.emit(ir.If(test.expr, tuple(then), tuple(otherwise), note))
    return then_ends and else_ends


def merged(frame: Frame, node: ast.AST, paths: Sequence[tuple[Env, list[ir.Statement]]]) -> Env:
    """Return the variables behind paths that meet; each path ends with what makes them the same."""
    names = dict.fromkeys(name for env, _ in paths for name in env)
    result: Env = {}
    for name in names:
        values = [env.get(name) for env, _ in paths]
        found = _common(frame, node, name, values, [block for _, block in paths])
        if found is not None:
            result[name] = found
    return result


def _common(
    frame: Frame,
    node: ast.AST,
    name: str,
    values: list[Value | Missing | None],
    blocks: list[list[ir.Statement]],
) -> Value | Missing | None:
    first = values[0]
    if first is not None and all(v is not None and same(v, first) for v in values):
        return first
    if "." in name:
        return None  # a derived value is computed anew
    for value in values:
        if value is None or isinstance(value, Missing):
            return value or _LATER
    expressions = [frame.types.expression(v) for v in values if v is not None and not isinstance(v, Missing)]
    types = [None if e is None else e.type for e in expressions]
    if None in types or any(t != types[0] for t in types):
        return different([t for t in types if t is not None])
    assert types[0] is not None
    target = frame.variable(name, types[0])
    for value, block in zip(values, blocks, strict=True):
        assert value is not None and not isinstance(value, Missing)
        outer, frame.block = frame.block, block
        frame.store(target, value, node)
        frame.block = outer
    return Run(target)


def different(types: list[Type]) -> Missing:
    names = list(dict.fromkeys(type_name(t) for t in types))
    instead = "write 0.0" if set(names) == {"int", "float"} else "give it values of one type"
    if len(names) < 2:
        return Missing(
            "is a function or another object that differs between two paths", "write an if with two calls"
        )
    return Missing(f"has different types on two paths: {' and '.join(sorted(names, reverse=True))}", instead)


# -- loops ---------------------------------------------------------------------------------------------------


def loop(frame: Frame, node: ast.For | ast.While) -> bool:
    """Lower a loop, again until its variables are the same at the start of every turn."""
    if node.orelse:
        raise frame.refuse(node.orelse[0], "`else` of a loop", "set a variable before `break`, and test it")
    if isinstance(node, ast.For):
        mark = len(frame.block)
        turns = iteration(frame, node.iter, node)
        if turns is None:
            del frame.block[mark:]
            return _written_out(frame, node)
    else:
        turns = None
    _own_variables(frame, node)
    entry = dict(frame.env)
    state = _State(frame)
    while True:
        frame.env = dict(entry)
        context = Loop()
        frame.loops.append(context)
        statement, ends = _while(frame, node) if isinstance(node, ast.While) else _for(frame, node, turns)
        frame.loops.pop()
        again = [env for env in (*context.continues, *ends) if env is not None]
        changed = _changed(entry, again)
        if not changed:
            break
        entry.update(changed)
        state.restore()
    frame.emit(statement)
    return _after(frame, node, turns, entry, context, [env for env in ends if env is not None])


class _State:
    """The temporaries before a loop: a second try at it must not find those of the first."""

    def __init__(self, frame: Frame) -> None:
        self._frame = frame
        self._locals, self._temporaries = dict(frame.locals), set(frame.temporaries)

    def restore(self) -> None:
        """Forget the temporaries of the first try."""
        for name in set(self._frame.temporaries) - self._temporaries:
            del self._frame.locals[name]
        self._frame.temporaries = set(self._temporaries)


def _own_variables(frame: Frame, node: ast.For | ast.While) -> None:
    """Give each variable that the loop changes a variable of its own, where it is none yet."""
    for name in stored([node]):
        value = frame.env.get(name)
        if value is None or isinstance(value, Missing):
            frame.env.pop(name, None)
            continue
        e = frame.types.expression(value)
        if e is None:
            frame.env[name] = Missing(
                "is no number, and the loop changes it", "give it another name in the loop"
            )
            continue
        target = frame.variable(name, e.type)
        frame.store(target, value, node)
        frame.env[name] = Run(target)


def _changed(entry: Env, ends: list[Env]) -> Env:
    """Return the variables that are something else at the end of a turn than at its start."""
    found: Env = {}
    for name, value in entry.items():
        if isinstance(value, Missing) or "." in name:
            continue
        for env in ends:
            other = env.get(name)
            if other is None or not same(value, other):
                found[name] = _turned(value, other)
    return found


def _turned(value: Value, other: Value | Missing | None) -> Missing:
    if other is None or isinstance(other, Missing):
        return other or _LATER
    types = [v.type for v in (value, other) if isinstance(v, Run)]
    return different(types)


def _while(frame: Frame, node: ast.While) -> tuple[ir.Statement, list[Env | None]]:
    with frame.nested() as before:
        test = frame.truth(node.test)
        expression = frame.expr(node.test, test)
    at_test = dict(frame.env)
    with frame.nested() as body:
        ended = frame.run(node.body)
    note = frame.module.note(node.lineno, node.test.end_lineno or node.lineno)
    end = None if ended else frame.env
    frame.env = at_test
    return ir.While(tuple(before), expression, tuple(body), note), [end]


@dataclasses.dataclass(frozen=True)
class Turns:
    """The turns of a `for`: a range of integers, and what the target is at one of them."""

    start: ir.Expression
    stop: ir.Expression
    step: int
    item: Callable[[ir.Expression], Value]
    is_range: bool = False

    def bounds(self, frame: Frame) -> Interval:
        """Return the least and the largest value of the counting variable."""
        first, last = interval(self.start, frame.ranges), interval(self.stop, frame.ranges)
        if self.step > 0:
            return first[0], max(first[0], last[1] - 1)
        return min(first[1], last[0] + 1), first[1]

    def is_certain(self) -> bool:
        """Return True if there is at least one turn."""
        if not isinstance(self.start, ir.Literal) or not isinstance(self.stop, ir.Literal):
            return False
        assert isinstance(self.start.value, int) and isinstance(self.stop.value, int)
        return len(range(self.start.value, self.stop.value, self.step)) > 0


def _for(frame: Frame, node: ast.For, turns: Turns | None) -> tuple[ir.Statement, list[Env | None]]:
    assert turns is not None
    changed_inside = stored(node.body)
    target = node.target
    direct = turns.is_range and isinstance(target, ast.Name) and target.id not in changed_inside
    if direct and isinstance(target, ast.Name):
        counter = frame.variable(target.id, INTEGER)
    else:
        counter = frame.temporary(INTEGER, "k")
    hidden = frame.ranges.get(counter.name)
    frame.ranges[counter.name] = turns.bounds(frame)
    before = dict(frame.env)
    with frame.nested() as body:
        if direct and isinstance(target, ast.Name):
            frame.env[target.id] = Run(counter)
        else:
            frame.unpack(target, turns.item(counter))
        ended = frame.run(node.body)
    if direct and hidden is None:
        del frame.ranges[counter.name]
    note = frame.module.note(node.lineno, node.iter.end_lineno or node.lineno)
    end = None if ended else frame.env
    frame.env = before
    return ir.For(counter, turns.start, turns.stop, turns.step, tuple(body), note), [end]


def _after(
    frame: Frame, node: ast.For | ast.While, turns: Turns | None, entry: Env, context: Loop, ends: list[Env]
) -> bool:
    """Set the variables behind a loop; return True if nothing behind it is reached."""
    left = list(context.breaks)
    if isinstance(node, ast.While):
        if not (isinstance(node.test, ast.Constant) and node.test.value is True):
            left.append(frame.env)
        elif not left:
            return True
    else:
        assert turns is not None
        left += [*ends, *context.continues]
        if not turns.is_certain():
            left.append(entry)
    paths: list[tuple[Env, list[ir.Statement]]] = [(_without(env, node), []) for env in left]
    frame.env = merged(frame, node, paths) if left else entry
    if any(block for _, block in paths):
        raise frame.refuse(node, "a variable that a loop leaves in different ways", "give it a number before")
    return not left


def _without(env: Env, node: ast.For | ast.While) -> Env:
    """Return the variables without a range's own, which has another last value than in Python."""
    if not isinstance(node, ast.For):
        return env
    names = {n.id for n in ast.walk(node.target) if isinstance(n, ast.Name)}
    return {name: value for name, value in env.items() if name not in names} | {
        name: Missing("is the variable of a loop that has ended", "keep it under another name")
        for name in names
    }


# -- what a `for` goes through -------------------------------------------------------------------------------


def iteration(frame: Frame, node: ast.expr, of: ast.For) -> Turns | None:
    """Return the turns of a loop over `node`; None for items that must be written out one by one."""
    if isinstance(node, ast.Call) and not node.keywords:
        called = frame.value(node.func)
        if isinstance(called, Known) and called.value is range:
            return _range(frame, node)
        if isinstance(called, Known) and called.value is enumerate and len(node.args) == 1:
            inner = iteration(frame, node.args[0], of)
            return None if inner is None or inner.is_range else _with(inner, lambda k, v: Group((Run(k), v)))
    since = len(frame.block)
    value = frame.value(node)
    check_lazy(frame, of, value, since)
    if isinstance(value, Known) and isinstance(value.value, range):
        r = value.value
        return Turns(literal(r.start), literal(r.stop), r.step, Run, True)
    e = frame.types.expression(value)
    if e is None or isinstance(e.type, StructType) or not isinstance(e.type, ArrayType | ListType):
        return None
    item = e.type.item
    if isinstance(e.type, ArrayType) and not isinstance(e, ir.TableItem):
        e = (
            frame.types.table("TABLE", e)
            if isinstance(value, Known) and isinstance(e, ir.Make)
            else frame.keep(e).expr
        )
    length = length_of(frame, node, Run(e))
    return Turns(literal(0), literal(length), 1, lambda k: Run(ir.Item(item, e, k)))


def _with(inner: Turns, item: Callable[[ir.Expression, Value], Value]) -> Turns:
    return dataclasses.replace(inner, item=lambda k: item(k, inner.item(k)))


def _range(frame: Frame, node: ast.Call) -> Turns:
    values = [frame.expr(a, v) for a, v in zip(node.args, frame.values(node.args), strict=True)]
    if not 1 <= len(values) <= 3 or not all(is_integral(v.type) for v in values):
        raise frame.refuse(node, "range of what is no int", "write range(n) with whole numbers")
    values = [as_integer(v) for v in values]
    start, stop = (literal(0), values[0]) if len(values) == 1 else (values[0], values[1])
    step = values[2] if len(values) == 3 else literal(1)
    if not isinstance(step, ir.Literal) or not isinstance(step.value, int) or step.value == 0:
        raise frame.needs_number(node, "the step of the range is not known", "write a number that is not 0")
    return Turns(start, stop, step.value, Run, True)


def _written_out(frame: Frame, node: ast.For) -> bool:
    """Lower a loop over items of different types: its body once for each."""
    if any(isinstance(n, ast.Break | ast.Continue) for n in own_nodes(node.body)):
        raise frame.refuse(node, "break or continue in a loop over items of different types", "write a range")
    found = items(frame, node.iter, frame.value(node.iter))
    if len(found) > UNROLLED:
        raise frame.refuse(node, f"{len(found)} items of different types", "write items of one type")
    for item in found:
        frame.unpack(node.target, item)
        if frame.run(node.body):
            return True
    return False


def either(
    frame: Frame, node: ast.AST, test: Known | Run, then: Callable[[], Value], otherwise: Callable[[], Value]
) -> Value:
    """Return one of two values; what must be computed for one is computed for that one alone."""
    if isinstance(test, Known):
        return then() if test.value else otherwise()
    kept = dict(frame.env)
    with frame.nested() as first:
        a = frame.expr(node, then())
    frame.env = dict(kept)
    with frame.nested() as second:
        b = frame.expr(node, otherwise())
    frame.env = kept
    if a.type != b.type:
        why = different([a.type, b.type])
        raise frame.refuse(node, why.why, why.instead)
    if isinstance(a.type, ListType):
        raise frame.refuse(node, "one of two lists", "write an if that fills one list")
    if not first and not second:
        return Run(ir.Select(a.type, test.expr, a, b))
    target = frame.temporary(a.type, "value")
    for block, value in ((first, a), (second, b)):
        outer, frame.block = frame.block, block
        frame.store(target, Run(value), node)
        frame.block = outer
    frame.emit(ir.If(test.expr, tuple(first), tuple(second)))
    return Run(target)


def both(frame: Frame, nodes: Sequence[ast.expr], is_and: bool) -> Known | Run:
    """Return the truth value of `a and b` or `a or b`; b is computed only where Python computes it."""
    first = frame.truth(nodes[0])
    if len(nodes) == 1:
        return first
    if isinstance(first, Known):
        return first if bool(first.value) is not is_and else both(frame, nodes[1:], is_and)
    kept = dict(frame.env)
    with frame.nested() as block:
        rest = both(frame, nodes[1:], is_and)
        second = frame.expr(nodes[1], truth_of(frame, nodes[1], rest))
    frame.env = kept
    if not block:
        return Run(ir.Operation(first.type, "and" if is_and else "or", (first.expr, second)))
    target = frame.temporary(first.type, "both" if is_and else "any")
    outer, frame.block = frame.block, block
    frame.store(target, Run(second), nodes[1])
    frame.block = outer
    short = (ir.Assign(target, literal(not is_and)),)
    then, otherwise = (tuple(block), short) if is_and else (short, tuple(block))
    frame.emit(ir.If(first.expr, then, otherwise))
    return Run(target)
