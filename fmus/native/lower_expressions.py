"""Expressions of Python: names, attributes, conditions; the others are passed on."""

from __future__ import annotations

import ast
import builtins
import functools
import types

from . import ir
from .lower_arithmetic import binary, compare, negated, truth_of, unary
from .lower_flow import both, either
from .lower_frame import Frame
from .lower_sequences import comprehension, elements, listed, repeated, subscript
from .lower_text import added, formatted
from .lower_types import is_named_tuple
from .lower_values import Callable, Group, Known, LocalFunction, Missing, Run, Value, described
from .values import BOOLEAN, COMPLEX, INTEGER, REAL, EnumType, ParametersType, StructType

_REFUSED: dict[type[ast.AST], tuple[str, str]] = {
    ast.NamedExpr: ("an assignment within an expression", "write the assignment on a line of its own"),
    ast.Await: ("`await`", "write a plain function"),
    ast.Yield: ("`yield`", "return a tuple"),
    ast.YieldFrom: ("`yield`", "return a tuple"),
    ast.Set: ("a set has no order", "write a tuple"),
    ast.SetComp: ("a set has no order", "write a tuple"),
    ast.Dict: ("a dictionary that is made when the model runs", "write it at the top of the module"),
    ast.DictComp: ("a dictionary that is made when the model runs", "write it at the top of the module"),
}


def value(frame: Frame, node: ast.expr) -> Value:
    """Return the value of an expression, after emitting what it must compute first."""
    match node:
        case ast.Constant():
            return Known(node.value)
        case ast.Name():
            return name(frame, node)
        case ast.Attribute():
            return frame.attribute(node, frame.value(node.value), node.attr)
        case ast.Tuple():
            return _tuple(elements(frame, node.elts))
        case ast.List():
            return listed(frame, node, elements(frame, node.elts))
        case ast.BinOp():
            return _binary(frame, node)
        case ast.UnaryOp():
            if isinstance(node.op, ast.Not):
                return negated(frame.truth(node.operand))
            return unary(frame, node, frame.value(node.operand))
        case ast.BoolOp():
            return _chosen(frame, node)
        case ast.Compare():
            return _compared(frame, node)
        case ast.IfExp():
            test = frame.truth(node.test)
            return either(frame, node, test, lambda: frame.value(node.body), lambda: frame.value(node.orelse))
        case ast.Subscript():
            return subscript(frame, node)
        case ast.Call():
            return frame.called(node)
        case ast.ListComp():
            return listed(frame, node, comprehension(frame, node))
        case ast.GeneratorExp():
            return Group(tuple(comprehension(frame, node)))
        case ast.JoinedStr():
            return formatted(frame, node)
        case ast.Lambda():
            return frame.captured(node, "function")
    rule, instead = _REFUSED.get(
        type(node), (f"{type(node).__name__} is not lowered", "write it with numbers")
    )
    raise frame.refuse(node, rule, instead)


def _binary(frame: Frame, node: ast.BinOp) -> Value:
    if isinstance(node.op, ast.Mult):
        found = repeated(frame, node)
        if found is not None:
            return found
    left, right = frame.values([node.left, node.right])
    text = added(frame, node, left, right) if isinstance(node.op, ast.Add) else None
    return text or binary(frame, node, node.op, left, right)


def _tuple(values: list[Value]) -> Value:
    if all(isinstance(v, Known) for v in values):
        return Known(tuple(v.value for v in values if isinstance(v, Known)))
    return Group(tuple(values))


# -- names and attributes ------------------------------------------------------------------------------------


def name(frame: Frame, node: ast.Name) -> Value:
    """Return what a name stands for: a variable, else a global, else what Python has built in."""
    found = frame.env.get(node.id)
    if isinstance(found, Missing):
        raise frame.refuse(node, f"{node.id} {found.why}", found.instead)
    if found is not None:
        return found
    if node.id in frame.stores:
        raise frame.refuse(node, f"{node.id} may be undefined here", "give it a value on every path")
    closed = _closed_over(frame.code)
    if node.id in closed:
        return Known(closed[node.id])
    scope = frame.module.scope
    if node.id in scope:
        if not isinstance(scope[node.id], types.ModuleType) and frame.module.changes(node.id):
            raise frame.refuse(node, f"the global {node.id} changes", "keep it in State or in Parameters")
        return Known(scope[node.id])
    if hasattr(builtins, node.id):
        return Known(getattr(builtins, node.id))
    raise frame.refuse(node, f"there is no {node.id}", "define it")


def _closed_over(code: types.FunctionType | LocalFunction) -> dict[str, object]:
    """Return what a function of the module had captured when the module was read."""
    if isinstance(code, LocalFunction) or not code.__closure__:
        return {}
    return {
        n: cell.cell_contents for n, cell in zip(code.__code__.co_freevars, code.__closure__, strict=True)
    }


def attribute(frame: Frame, node: ast.expr, of: Value, attr: str) -> Value:
    """Return an attribute of a value."""
    if isinstance(of, Known):
        return _of_known(frame, node, of.value, attr)
    if isinstance(of, Group) and is_named_tuple(of.python):
        names = getattr(of.python, "_fields", ())
        if attr in names:
            return of.items[names.index(attr)]
        of = Run(frame.expr(node, of))
    if isinstance(of, Run):
        if of.type is COMPLEX and attr in ("real", "imag"):
            return Run(ir.Field(REAL, of.expr, {"real": "re", "imag": "im"}[attr]))
        if isinstance(of.type, StructType | ParametersType):
            return _of_struct(frame, node, of, of.type, attr)
        if isinstance(of.type, EnumType):
            if attr == "value":
                return Run(ir.Convert(INTEGER, of.expr))
            found = _of_class(of.type.enumeration, attr)
            if isinstance(found, property) and isinstance(found.fget, types.FunctionType):
                return frame.call(node, Callable(found.fget, (of,)), (), {})
            if isinstance(found, types.FunctionType):
                return Callable(found, (of,))
            raise frame.refuse(
                node, f"the {attr} of an item that is known only when it runs", "write its number"
            )
        if of.type is REAL and attr == "real":
            return of
    raise frame.refuse(
        node, f"{described(of)} has no `{attr}` here", "use fields of records and plain numbers"
    )


def _of_known(frame: Frame, node: ast.expr, of: object, attr: str) -> Value:
    if not hasattr(of, attr):
        raise frame.refuse(node, f"{described(Known(of))} has no {attr}", "write a name that it has")
    try:
        found = getattr(of, attr)
    except (ArithmeticError, ValueError) as error:
        raise frame.refuse(node, f"{attr} fails: {error}", "use parameters that it is defined for") from None
    if isinstance(found, types.MethodType) and isinstance(found.__func__, types.FunctionType):
        return Callable(found.__func__, (Known(found.__self__),))
    return Known(found)


def _of_struct(frame: Frame, node: ast.expr, of: Run, type_: StructType | ParametersType, attr: str) -> Value:
    fields = dict(type_.fields)
    if attr in fields:
        if isinstance(of.expr, ir.Make):
            return Run(of.expr.items[list(fields).index(attr)])
        return Run(ir.Field(fields[attr], of.expr, attr))
    found = _of_class(type_.python, attr)
    if isinstance(found, functools.cached_property) and isinstance(found.func, types.FunctionType):
        return frame.derived(node, of, found.func, attr)
    if isinstance(found, property) and isinstance(found.fget, types.FunctionType):
        return frame.call(node, Callable(found.fget, (of,)), (), {})
    if isinstance(found, staticmethod):
        return Known(found.__func__)
    if isinstance(found, types.FunctionType):
        return Callable(found, (of,))
    if isinstance(found, int | float | complex | tuple) and not isinstance(found, types.MemberDescriptorType):
        return Known(found)
    what = type_.python.__name__ if type_.python else "a tuple"
    raise frame.refuse(
        node, f"{what} has no `{attr}` that can be lowered", "write a field, a property or a function"
    )


def _of_class(python: type | None, attr: str) -> object:
    for base in python.__mro__ if python is not None else ():
        if attr in vars(base):
            return vars(base)[attr]
    return None


# -- conditions ----------------------------------------------------------------------------------------------


def truth(frame: Frame, node: ast.expr) -> Known | Run:
    """Return the truth value of an expression."""
    if isinstance(node, ast.BoolOp):
        return both(frame, node.values, isinstance(node.op, ast.And))
    return truth_of(frame, node, frame.value(node))


def _chosen(frame: Frame, node: ast.BoolOp) -> Value:
    """Return `a and b` or `a or b` as a value: one of the operands."""
    is_and = isinstance(node.op, ast.And)
    found = frame.value(node.values[0])
    for following in node.values[1:]:
        if isinstance(found, Known):
            found = frame.value(following) if bool(found.value) is is_and else found
            continue
        first = frame.simple(node, found)
        if first.type is BOOLEAN:
            found = _both(frame, node, first, following, is_and)
            continue
        test = truth_of(frame, node, first)
        lazy = functools.partial(frame.value, following)
        found = either(frame, node, test, *((lazy, lambda: first) if is_and else (lambda: first, lazy)))  # noqa: B023 - called at once
    return found


def _both(frame: Frame, node: ast.BoolOp, first: Run, following: ast.expr, is_and: bool) -> Value:
    with frame.nested() as block:
        second = frame.expr(node, frame.value(following))
    if second.type is not BOOLEAN:
        raise frame.refuse(node, "`and` or `or` of a bool and a number", "write a condition")
    if not block:
        return Run(ir.Operation(BOOLEAN, "and" if is_and else "or", (first.expr, second)))
    target = frame.temporary(BOOLEAN, "both" if is_and else "any")
    block.append(ir.Assign(target, second))
    short = (ir.Assign(target, ir.Literal(BOOLEAN, not is_and)),)
    frame.emit(ir.If(first.expr, *((tuple(block), short) if is_and else (short, tuple(block)))))
    return Run(target)


def _compared(frame: Frame, node: ast.Compare) -> Value:
    """Return a comparison, or a chain of them, of which a later one is made where those before are true."""
    if len(node.ops) == 1:
        return compare(frame, node, node.ops[0], *frame.values([node.left, node.comparators[0]]))
    left, middle = frame.values([node.left, node.comparators[0]])
    kept = middle if isinstance(middle, Known) else frame.simple(node, middle)
    return _chained(frame, node, compare(frame, node, node.ops[0], left, kept), kept, 1)


def _chained(frame: Frame, node: ast.Compare, found: Known | Run, left: Value, k: int) -> Value:
    if k == len(node.ops) or (isinstance(found, Known) and not found.value):
        return found
    with frame.nested() as block:
        right = frame.value(node.comparators[k])
        kept = right if isinstance(right, Known) else frame.simple(node, right)
        rest = _chained(frame, node, compare(frame, node, node.ops[k], left, kept), kept, k + 1)
        second = frame.expr(node, rest)
    if isinstance(found, Known):
        frame.block.extend(block)
        return rest
    if not block:
        return Run(ir.Operation(BOOLEAN, "and", (found.expr, second)))
    target = frame.temporary(BOOLEAN, "both")
    block.append(ir.Assign(target, second))
    frame.emit(ir.If(found.expr, tuple(block), (ir.Assign(target, ir.Literal(BOOLEAN, False)),)))
    return Run(target)
