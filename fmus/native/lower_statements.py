"""Statements of Python."""

from __future__ import annotations

import ast
import copy
import types
from collections.abc import Sequence

from . import ir
from .lower_arithmetic import binary
from .lower_flow import branch, loop
from .lower_frame import Frame
from .lower_sequences import checked_index
from .lower_text import pieces_of
from .lower_values import (
    Group,
    Known,
    Missing,
    Run,
    Value,
    Words,
    described,
    mentions,
    node_line,
    number_type,
)
from .values import ListType

_REFUSED: dict[type[ast.stmt], tuple[str, str]] = {
    ast.Try: ("`try`", "test for what can fail before it does, with an if"),
    ast.With: ("`with`", "write plain statements"),
    ast.AsyncFor: ("`async`", "write a plain loop"),
    ast.AsyncWith: ("`async`", "write plain statements"),
    ast.AsyncFunctionDef: ("`async`", "write a plain function"),
    ast.ClassDef: ("a class in a function", "write it at the top of the module"),
    ast.Delete: ("`del`", "leave it out"),
    ast.Import: ("an import in a function", "write it at the top of the module"),
    ast.ImportFrom: ("an import in a function", "write it at the top of the module"),
    ast.Global: ("a global that changes", "keep it in State"),
    ast.Nonlocal: ("a variable of the outer function that changes", "return the value"),
    ast.Assert: ("`assert`", "write `if not ...: raise ValueError(...)`"),
    ast.Match: ("`match`", "write if and elif"),
}


def run(frame: Frame, statements: Sequence[ast.stmt]) -> bool:
    """Lower statements; return True if none behind them is reached."""
    return any(_statement(frame, node) for node in statements)


def _statement(frame: Frame, node: ast.stmt) -> bool:
    """Lower a statement; return True if nothing behind it is reached."""
    match node:
        case ast.If():
            return branch(frame, node)
        case ast.For() | ast.While():
            return loop(frame, node)
        case ast.FunctionDef():
            _define(frame, node)
            return False
        case ast.Pass():
            return False
        case ast.Break() | ast.Continue():
            return _leave(frame, node)
    since = len(frame.block)
    ended = _simple(frame, node)
    frame.note(frame.module.note(node.lineno, node_line(node)), since)
    return ended


def _simple(frame: Frame, node: ast.stmt) -> bool:
    match node:
        case ast.Expr():
            if not isinstance(node.value, ast.Constant):
                frame.value(node.value)
            return False
        case ast.Assign():
            _assigned(frame, node)
            return False
        case ast.AnnAssign():
            if node.value is not None:
                frame.unpack(node.target, frame.value(node.value))
            return False
        case ast.AugAssign():
            _augmented(frame, node)
            return False
        case ast.Return():
            frame.returned(node)
            return True
        case ast.Raise():
            _raise(frame, node)
            return True
    rule, instead = _REFUSED.get(type(node), (f"`{type(node).__name__.lower()}`", "write plain statements"))
    raise frame.refuse(node, rule, instead)


def _leave(frame: Frame, node: ast.Break | ast.Continue) -> bool:
    if not frame.loops:
        raise frame.refuse(node, "break or continue in a loop that is written out", "write a range")
    context = frame.loops[-1]
    if isinstance(node, ast.Break):
        context.breaks.append(dict(frame.env))
        frame.emit(ir.Break())
    else:
        context.continues.append(dict(frame.env))
        frame.emit(ir.Continue())
    return True


def _define(frame: Frame, node: ast.FunctionDef) -> None:
    if node.decorator_list:
        raise frame.refuse(node.decorator_list[0], "a decorator of a function in a function", "leave it out")
    frame.env[node.name] = frame.captured(node, node.name)


# -- assignments ---------------------------------------------------------------------------------------------


def _assigned(frame: Frame, node: ast.Assign) -> None:
    if isinstance(node.value, ast.GeneratorExp) and isinstance(node.targets[0], ast.Name):
        raise frame.refuse(node.value, "a generator that is kept", "write tuple(...) around it")
    value = frame.value(node.value)
    if len(node.targets) > 1:
        if isinstance(value, Run) and isinstance(value.type, ListType):
            raise frame.refuse(node, "one list with two names", "make a list for each name")
        if isinstance(value, Run):
            value = frame.settled(node, value)
            frame.temporaries.discard(getattr(value.expr, "name", ""))
    for target in node.targets:
        frame.unpack(target, value)


def unpack(frame: Frame, target: ast.expr, value: Value) -> None:
    """Give a target of an assignment its value."""
    if isinstance(target, ast.Name):
        frame.assign(target.id, value, target)
    elif isinstance(target, ast.Tuple | ast.List):
        _unpack_items(frame, target, value)
    elif isinstance(target, ast.Subscript):
        mark = len(frame.block)
        of, index = _element(frame, target, "py_list_set_index")
        _set(frame, target, of, index, frame.held(mark, value))
    elif isinstance(target, ast.Attribute) and _is_self(frame, target):
        frame.assign_self(target, value)
    elif isinstance(target, ast.Attribute):
        raise frame.refuse(target, "records do not change", "make a new one with the values")
    else:
        raise frame.refuse(target, "this target", "write a name, or an item of a list")


def _is_self(frame: Frame, target: ast.Attribute) -> bool:
    return isinstance(target.value, ast.Name) and target.value.id == frame.self_name


def _unpack_items(frame: Frame, target: ast.Tuple | ast.List, value: Value) -> None:
    found = frame.items(target, value)
    star = [k for k, part in enumerate(target.elts) if isinstance(part, ast.Starred)]
    parts = list(target.elts)
    if star:
        k, behind = star[0], len(parts) - star[0] - 1
        if len(found) < len(parts) - 1:
            raise frame.refuse(
                target, f"{len(found)} values for {len(parts) - 1} names and more", "write fewer names"
            )
        middle = found[k : len(found) - behind]
        found = [*found[:k], Group(tuple(middle)), *found[len(found) - behind :]]
        parts[k] = parts[k].value  # type: ignore[attr-defined] # it has a star
    if len(found) != len(parts):
        raise frame.refuse(
            target, f"{len(found)} values for {len(parts)} names", "write as many names as values"
        )
    for part, item in zip(parts, _independent(frame, target, parts, found), strict=True):
        frame.unpack(part, item)


def _independent(
    frame: Frame, node: ast.AST, parts: Sequence[ast.expr], found: Sequence[Value]
) -> list[Value]:
    """Return the values so that no assignment to a name before them changes one of them."""
    leaves = [leaf for item in found for leaf in _leaves(item)]
    for name in {leaf.expr.name for leaf in leaves if isinstance(leaf.expr, ir.Local)}:
        if sum(mentions(leaf.expr, name) for leaf in leaves) > 1:
            frame.temporaries.discard(name)  # it has two names from now on
    written: set[str] = set()
    kept: list[Value] = []
    for part, item in zip(parts, found, strict=True):
        if isinstance(item, Run) and any(frame.may_change(name, item.expr) for name in written):
            item = frame.keep(item.expr)
        kept.append(item)
        if any(isinstance(n, ast.Subscript) for n in ast.walk(part)):
            written.add("[]")
        written |= {n.id for n in ast.walk(part) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return kept


def _leaves(value: Value) -> list[Run]:
    """Return the values that the native code computes within a value."""
    if isinstance(value, Group):
        return [leaf for item in value.items for leaf in _leaves(item)]
    return [value] if isinstance(value, Run) else []


def assign(frame: Frame, name: str, value: Value, node: ast.AST) -> None:
    """Give a variable of the function a value."""
    _forget_derived(frame, name)
    if name == "_":
        frame.env[name] = Missing("is what nobody reads", "give it a name")
        return
    if isinstance(value, Known) and _stays_known(frame, name, value):
        frame.env[name] = value
        return
    if isinstance(value, Words):
        frame.env[name] = Words(
            tuple(p if isinstance(p, str) else _kept(frame, node, p) for p in value.pieces)
        )
        return
    if isinstance(value, Run) and isinstance(value.type, ListType) and not frame.is_new(value.expr):
        raise frame.refuse(node, "a list has one name", "write list(a) for a list of its own")
    e = frame.types.expression(value)
    if e is None and isinstance(value, Group):
        frame.env[name] = Group(tuple(_fixed(frame, node, item) for item in value.items), value.python)
        return
    if e is None:
        frame.env[name] = value
        return
    target = frame.variable(name, e.type)
    frame.store(target, Run(e), node)
    frame.env[name] = Run(target)


def _kept(frame: Frame, node: ast.AST, shown: ir.Shown) -> ir.Shown:
    return ir.Shown(frame.settled(node, Run(shown.value)).expr, shown.spec)


def _fixed(frame: Frame, node: ast.AST, item: Value) -> Value:
    return frame.settled(node, item) if isinstance(item, Run) else item


def _stays_known(frame: Frame, name: str, value: Known) -> bool:
    """Return True for what needs no variable: objects, and whole numbers and tuples with one assignment."""
    once = len(frame.stores.get(name, ())) == 1 and name not in frame.argument_names
    is_number = number_type(value.value) is not None
    if is_number and not isinstance(value.value, int):
        return False
    return once or (not is_number and not isinstance(value.value, tuple))


def _forget_derived(frame: Frame, name: str) -> None:
    for key in [key for key in frame.env if key.startswith(f"{name}.")]:
        del frame.env[key]


def _augmented(frame: Frame, node: ast.AugAssign) -> None:
    if isinstance(node.target, ast.Subscript):
        of, index = _element(frame, node.target, "py_list_index")  # it is read first
        kept = index if isinstance(index, ir.Literal | ir.Local) else frame.keep(index).expr
        assert isinstance(of.type, ListType)
        before = Run(ir.Item(of.type.item, of, kept))
        _set(frame, node, of, kept, _computed(frame, node, before))
        return
    if not isinstance(node.target, ast.Name):
        raise frame.refuse(node, "records do not change", "make a new one with the values")
    read = copy.copy(node.target)
    read.ctx = ast.Load()
    frame.unpack(node.target, _computed(frame, node, frame.value(read)))


def _computed(frame: Frame, node: ast.AugAssign, before: Value) -> Value:
    mark = len(frame.block)
    after = frame.value(node.value)
    return binary(frame, node, node.op, frame.held(mark, before), after)


def _element(frame: Frame, target: ast.Subscript, check: str) -> tuple[ir.Local, ir.Expression]:
    """Return the list and the index of an item that is given a value; `check` fails for another index."""
    if isinstance(target.slice, ast.Slice):
        raise frame.refuse(target, "a part of a list that is given a value", "write a loop over its items")
    of, index = frame.values([target.value, target.slice])
    if not isinstance(of, Run) or not isinstance(of.type, ListType):
        raise frame.refuse(target, f"{described(of)} does not change", "write a list: [0.0] * N")
    if not isinstance(of.expr, ir.Local):
        raise frame.refuse(target, "a list within another value", "give the list a name of its own")
    if of.expr in frame.arguments:
        frame.changes_arguments = True
    return of.expr, checked_index(frame, target, of.expr, index, check)


def _set(frame: Frame, node: ast.AST, of: ir.Local, index: ir.Expression, value: Value) -> None:
    e = frame.expr(node, value)
    assert isinstance(of.type, ListType)
    if e.type != of.type.item:
        raise frame.refuse(
            node,
            f"an item of {described(Run(of))} gets {described(value)}",
            "give all items one type: write 0.0",
        )
    frame.emit(ir.SetItem(of, index, e))


# -- exceptions ----------------------------------------------------------------------------------------------


def _raise(frame: Frame, node: ast.Raise) -> None:
    if node.exc is None:
        raise frame.refuse(node, "the exception before raised again", "raise one with a text")
    called = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
    given = node.exc.args if isinstance(node.exc, ast.Call) else []
    kind = frame.value(called)
    python = kind.value if isinstance(kind, Known) else None
    if not isinstance(python, type) or not issubclass(python, Exception) or not _is_plain(python):
        raise frame.refuse(node, "an exception whose text is its own", "raise ValueError(...) with a text")
    if len(given) > 1 or (isinstance(node.exc, ast.Call) and node.exc.keywords):
        raise frame.refuse(node, "an exception with several values", "write one text: an f-string")
    text: ir.Text = pieces_of(frame, given[0], frame.value(given[0])) if given else ()
    _check_text(frame, node, text)
    frame.emit(ir.Raise(python.__name__, text or ("",), frame.module.place(node)))


def _is_plain(python: type[Exception]) -> bool:
    """Return True for an exception whose str() is the text that it was given."""
    own = python.__str__ is BaseException.__str__
    return own and not isinstance(python.__init__, types.FunctionType)


def say(frame: Frame, node: ast.Return, value: ast.expr | None) -> None:
    """Return a text from `notice`."""
    if value is None:
        raise frame.refuse(node, "notice returns a text", 'write return ""')
    if isinstance(value, ast.IfExp):
        test = frame.truth(value.test)
        if isinstance(test, Known):
            say(frame, node, value.body if test.value else value.orelse)
            return
        with frame.nested() as then:
            say(frame, node, value.body)
        with frame.nested() as otherwise:
            say(frame, node, value.orelse)
        frame.emit(ir.If(test.expr, tuple(then), tuple(otherwise)))
        return
    text = pieces_of(frame, value, frame.value(value))
    _check_text(frame, node, text)
    frame.emit(ir.Say(text))


def _check_text(frame: Frame, node: ast.AST, text: ir.Text) -> None:
    if any("\0" in piece for piece in text if isinstance(piece, str)):
        raise frame.refuse(node, "a text with a null character, which ends a text of C", "leave it out")
