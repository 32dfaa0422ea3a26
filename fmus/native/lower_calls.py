"""Calls: of records, of the model's functions, of methods, of what makes functions."""

from __future__ import annotations

import ast
import dataclasses
import functools
import inspect
import operator
import types
from collections.abc import Sequence

from . import ir
from .lower_builtins import find
from .lower_classes import refuse_own_rules
from .lower_frame import Frame
from .lower_sequences import elements
from .lower_text import glued, is_text, show
from .lower_types import is_enumeration, is_named_tuple
from .lower_values import (
    Callable,
    Group,
    Known,
    LocalFunction,
    Run,
    Value,
    Words,
    as_integer,
    described,
    literal,
    number_type,
    type_name,
)
from .values import BOOLEAN, COMPLEX, ArrayType, EnumType, ListType, StructType, Type, is_integral

_INSTEAD = {
    "numpy": "write plain Python with math and loops",
    "scipy": "write plain Python with math and loops",
    "random": "give the random numbers as an input",
    "time": "take the time as an input: time()",
}
_METHODS = {
    "append": "write [0.0] * N and keep the number of items",
    "pop": "write [0.0] * N and keep the number of items",
    "insert": "write [0.0] * N and move the items in a loop",
    "extend": "write [0.0] * N and keep the number of items",
    "sort": "write a loop that swaps",
    "copy": "write list(a)",
    "get": "write table[key] with a key that is there",
    "format": "write an f-string",
}


def called(frame: Frame, node: ast.Call) -> Value:
    """Return the result of a call."""
    method = _of_object(frame, node)
    if method is not None:
        return method
    callee = frame.value(node.func)
    mark = len(frame.block)
    if any(keyword.arg is None for keyword in node.keywords):
        raise frame.refuse(node, "`**` in a call", "write the arguments by their names")
    found = elements(frame, [*node.args, *(keyword.value for keyword in node.keywords)])
    count = len(found) - len(node.keywords)
    named = {keyword.arg or "": v for keyword, v in zip(node.keywords, found[count:], strict=True)}
    return call_value(frame, node, frame.held(mark, callee), found[:count], named)


def call_value(
    frame: Frame, node: ast.Call, callee: Value, given: Sequence[Value], named: dict[str, Value]
) -> Value:
    """Return the result of a call of a value with arguments."""
    if isinstance(callee, Run) and isinstance(callee.type, StructType):
        callee = callable_of(frame, callee) or callee
    if isinstance(callee, Callable):
        return frame.call(node, callee, given, named)
    if not isinstance(callee, Known):
        raise frame.refuse(node, f"{described(callee)} is called", "call a function of the model's module")
    function = callee.value
    builtin = find(function)
    if builtin is not None:
        if named and set(named) != {"strict"}:
            raise frame.refuse(node, f"{_name(function)} with keywords", "write it without them")
        return builtin(frame, node, given)
    if isinstance(function, type):
        return _made(frame, node, function, given, named)
    found = _of_function(frame, node, function, given, named)
    if found is not None:
        return found
    owner = getattr(function, "__self__", None)
    module = getattr(function, "__module__", None) or type(owner or function).__module__
    module = str(module).partition(".")[0]
    instead = _INSTEAD.get(module, "write it in the model's module, in plain Python")
    raise frame.refuse(node, f"{module}.{_name(function)} is not lowered", instead)


def _name(function: object) -> str:
    return str(getattr(function, "__name__", type(function).__name__))


def _of_function(
    frame: Frame, node: ast.Call, function: object, given: Sequence[Value], named: dict[str, Value]
) -> Value | None:
    """Return the result of a call of a function, or of an object that is one; None for what has no source."""
    if isinstance(function, types.MethodType) and isinstance(function.__func__, types.FunctionType):
        return frame.call(node, Callable(function.__func__, (Known(function.__self__),)), given, named)
    if isinstance(function, type(_remembered)):
        inner = inspect.unwrap(function)
        assert isinstance(inner, types.FunctionType)
        return frame.call(node, Callable(inner, remembers=True), given, named)
    if function is functools.lru_cache or function is functools.cache:
        if given and isinstance(given[0], Known) and isinstance(given[0].value, int | None):
            return Known(_REMEMBERS)
        return _remembering(frame, node, given) if given else Known(_REMEMBERS)
    if function is _REMEMBERS:
        return _remembering(frame, node, given)
    if isinstance(function, functools.partial):
        more = {name: Known(value) for name, value in function.keywords.items()}
        bound = [Known(value) for value in function.args]
        return call_value(frame, node, Known(function.func), [*bound, *given], {**more, **named})
    if isinstance(function, operator.attrgetter):
        names = function.__reduce__()[1]
        found = [frame.attribute(node, given[0], name) for name in names]
        return found[0] if len(found) == 1 else Group(tuple(found))
    if function is getattr:
        return _getattr(frame, node, given)
    if function is dataclasses.replace:
        return _replaced(frame, node, given, named)
    if isinstance(function, types.FunctionType):
        return frame.call(node, Callable(function), given, named)
    return None


_REMEMBERS = object()


@functools.cache
def _remembered() -> None:
    """Nothing, and of the type of all functions that lru_cache makes."""


def _remembering(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    """Return a function that keeps its last call."""
    value = given[0]
    if isinstance(value, Known) and isinstance(value.value, types.FunctionType):
        value = Callable(value.value)
    if isinstance(value, Run):
        value = callable_of(frame, value) or value
    if not isinstance(value, Callable):
        raise frame.refuse(node, f"lru_cache of {described(value)}", "give it a function")
    return dataclasses.replace(value, remembers=True)


def _getattr(frame: Frame, node: ast.Call, given: Sequence[Value]) -> Value:
    if len(given) != 2 or not isinstance(given[1], Known) or not isinstance(given[1].value, str):
        raise frame.refuse(
            node, "an attribute whose name is known only when it runs", "write an if for each name"
        )
    return frame.attribute(node, given[0], given[1].value)


def callable_of(frame: Frame, value: Run) -> Callable | None:
    """Return the function whose captured or bound values a struct holds; None for another struct."""
    if not isinstance(value.type, StructType):
        return None
    template = frame.types.callables.get(value.type)
    if template is None:
        return None
    if isinstance(template.code, LocalFunction):
        return Callable(template.code, (value,), template.remembers)
    kept = frame.simple(frame.node, value).expr
    fields = dict(value.type.fields)
    bound = [
        Run(ir.Field(fields[f"bound_{k}"], kept, f"bound_{k}")) if f"bound_{k}" in fields else known
        for k, known in enumerate(template.bound)
    ]
    return Callable(template.code, tuple(bound), template.remembers)


# -- methods of objects --------------------------------------------------------------------------------------


def _of_object(frame: Frame, node: ast.Call) -> Value | None:
    """Return the result of a method of a text, a list or a number; None for another call."""
    if not isinstance(node.func, ast.Attribute):
        return None
    attr = node.func.attr
    if attr == "join":
        return glued(frame, node, *_joined(frame, node))
    if attr not in _METHODS and attr not in (
        "conjugate",
        "bit_length",
        "is_integer",
        "_replace",
        "index",
        "count",
    ):
        return None
    of = frame.value(node.func.value)
    if isinstance(of, Run) and of.type is COMPLEX and attr == "conjugate":
        return Run(ir.Apply(COMPLEX, "py_complex_conjugate", (of.expr,)))
    if attr == "_replace" and (is_named_tuple(getattr(of, "python", None)) or isinstance(of, Run)):
        return _replaced(frame, node, [of], _by_keyword(frame, node))
    if isinstance(of, Run) and isinstance(of.type, StructType) and of.type.python is not None:
        return None  # a method of the model's own class
    if isinstance(of, Known) and not isinstance(of.value, dict | list | tuple | set | str | float | int):
        return None
    instead = _METHODS.get(attr, "write it with operators, or as a function")
    raise frame.refuse(node, f"the method {attr} of {described(of)}", instead)


def _by_keyword(frame: Frame, node: ast.Call) -> dict[str, Value]:
    values = frame.values([k.value for k in node.keywords])
    return {k.arg or "": value for k, value in zip(node.keywords, values, strict=True)}


def _joined(frame: Frame, node: ast.Call) -> tuple[str, list[Value]]:
    assert isinstance(node.func, ast.Attribute)
    between = frame.value(node.func.value)
    if not isinstance(between, Known) or not isinstance(between.value, str) or len(node.args) != 1:
        raise frame.refuse(node, "join of what is no text", "write an f-string")
    return between.value, frame.items(node, frame.value(node.args[0]))


# -- objects -------------------------------------------------------------------------------------------------


def _made(
    frame: Frame, node: ast.Call, python: type, given: Sequence[Value], named: dict[str, Value]
) -> Value:
    """Return a new object of a class."""
    if is_enumeration(python) or is_named_tuple(python) or dataclasses.is_dataclass(python):
        refuse_own_rules(frame, node, python)
    if is_enumeration(python):
        return _item(frame, node, python, given)
    if python is functools.partial:
        return _partial(frame, node, given, named)
    if is_named_tuple(python):
        names = getattr(python, "_fields", ())
        defaults = getattr(python, "_field_defaults", {})
        values = _by_name(frame, node, names, defaults, given, named)
        return Group(tuple(values), python)
    if dataclasses.is_dataclass(python):
        return _record(frame, node, python, given, named)
    if issubclass(python, BaseException):
        raise frame.refuse(node, "an exception that is not raised here", "write `raise` before it")
    if python is str:
        if given and is_text(given[0]) and python is str:
            return given[0]
        if len(given) == 1 and isinstance(given[0], Run):
            return Words((show(frame, node, given[0]),))
        raise frame.refuse(node, "a text", "write an f-string in the exception")
    init = vars(python).get("__init__")
    if isinstance(init, types.FunctionType) and python.__new__ is object.__new__:
        refuse_own_rules(frame, node, python)
        return frame.call(node, Callable(init, (Known(python),)), given, named)
    if python.__module__ == "numpy" or python.__module__.startswith("numpy."):
        raise frame.refuse(
            node, f"numpy.{python.__name__} is not lowered", "write plain Python with math and loops"
        )
    raise frame.refuse(
        node,
        f"an object of {python.__name__}",
        "write a NamedTuple, a frozen dataclass, or a class whose __init__ assigns each self.x once",
    )


def _by_name(
    frame: Frame,
    node: ast.Call,
    names: Sequence[str],
    defaults: dict[str, object],
    given: Sequence[Value],
    named: dict[str, Value],
) -> list[Value]:
    """Return the value of each field, by place, by name, or by default."""
    if len(given) > len(names) or set(named) - set(names[len(given) :]):
        raise frame.refuse(
            node, f"arguments that do not fit {', '.join(names)}", "write one value for each field"
        )
    values = []
    for k, name in enumerate(names):
        if k < len(given):
            values.append(given[k])
        elif name in named:
            values.append(named[name])
        elif name in defaults:
            values.append(Known(defaults[name]))
        else:
            raise frame.refuse(node, f"{name} is missing", "write one value for each field")
    return values


def _record(
    frame: Frame, node: ast.Call, python: type, given: Sequence[Value], named: dict[str, Value]
) -> Value:
    """Return an object of a frozen dataclass."""
    params = getattr(python, "__dataclass_params__")  # noqa: B009 - of all dataclasses
    if not params.frozen or "__post_init__" in dir(python):
        raise frame.refuse(
            node, f"{python.__name__} can change, or does more than keep values", "write a frozen dataclass"
        )
    fields = dataclasses.fields(python)
    if any(f.default_factory is not dataclasses.MISSING for f in fields):
        raise frame.refuse(node, f"{python.__name__} has defaults that are made anew", "write the values")
    defaults = {f.name: f.default for f in fields if f.default is not dataclasses.MISSING}
    values = _by_name(frame, node, [f.name for f in fields], defaults, given, named)
    if all(isinstance(v, Known) for v in values):
        if python in frame.declared:
            record(frame, node, python, values)
        return Known(python(*(v.value for v in values if isinstance(v, Known))))
    return Run(record(frame, node, python, values))


def record(frame: Frame, node: ast.AST, python: type, values: Sequence[Value]) -> ir.Expression:
    """Return a record; one that the model declares has the types of its declaration."""
    names = [f.name for f in dataclasses.fields(python)]
    items = [frame.expr(node, value) for value in values]
    if python in frame.declared:
        for name, item, declared in zip(names, items, frame.declared[python].fields, strict=True):
            check_declared(frame, node, f"{python.__name__}.{name}", item, declared[1])
        return ir.Make(frame.declared[python], tuple(items))
    for name, item in zip(names, items, strict=True):
        if isinstance(item.type, ListType):
            raise frame.refuse(node, f"{python.__name__}.{name} is a list", "write tuple(a)")
    type_ = frame.types.record(python, [(n, item.type) for n, item in zip(names, items, strict=True)])
    return ir.Make(type_, tuple(items))


def check_declared(frame: Frame, node: ast.AST, name: str, item: ir.Expression, declared: Type) -> None:
    """Raise Unsupported for a value of another type than a variable is declared with."""
    if item.type == declared:
        return
    words = type_name(declared)
    instead = {"float": "write 0.0, or float(...)", "int": "write int(...)", "bool": "write a condition"}
    if isinstance(declared, ArrayType):
        instead[words] = "keep its length and the type of its items"
    raise frame.refuse(
        node,
        f"{name} is declared {words} and gets {described(Run(item))}",
        instead.get(words, f"write {words}(...)"),
    )


def _replaced(frame: Frame, node: ast.Call, given: Sequence[Value], named: dict[str, Value]) -> Value:
    """Return a record or a NamedTuple with some fields changed."""
    of = given[0]
    e = frame.simple(node, of).expr
    if not isinstance(e.type, StructType) or e.type.python is None or set(named) - set(dict(e.type.fields)):
        raise frame.refuse(node, f"{described(of)} with fields changed", "name fields of a record")
    values = [named.get(name) or frame.attribute(node, Run(e), name) for name, _ in e.type.fields]
    if is_named_tuple(e.type.python):
        return Group(tuple(values), e.type.python)
    return Run(record(frame, node, e.type.python, values))


def _item(frame: Frame, node: ast.Call, python: type, given: Sequence[Value]) -> Value:
    """Return an item of an enumeration by its number; one that is none fails as in Python."""
    if len(given) != 1:
        raise frame.refuse(node, "an enumeration that is made when the model runs", "write it in the module")
    if isinstance(given[0], Known):
        try:
            return Known(python(given[0].value))
        except ValueError as error:
            raise frame.refuse(node, str(error), "write one of its items") from None
    e = frame.simple(node, given[0]).expr
    type_ = number_type(next(iter(python)))  # type: ignore[call-overload] # an enumeration
    assert isinstance(type_, EnumType)
    if e.type == type_:
        return Run(e)
    if not is_integral(e.type):
        raise frame.refuse(node, f"{python.__name__} of {described(given[0])}", "give it an int")
    tests = [ir.Operation(BOOLEAN, "!=", (as_integer(e), literal(int(item)))) for item in type_.enumeration]
    missing: ir.Expression = tests[0]
    for test in tests[1:]:
        missing = ir.Operation(BOOLEAN, "and", (missing, test))
    text = (ir.Shown(as_integer(e)), f" is not a valid {python.__qualname__}")
    frame.emit(ir.If(missing, (ir.Raise("ValueError", text, frame.module.place(node)),)))
    return Run(ir.Convert(type_, as_integer(e)))


def _partial(frame: Frame, node: ast.Call, given: Sequence[Value], named: dict[str, Value]) -> Value:
    if named or not given:
        raise frame.refuse(node, "partial with keywords", "bind the first arguments")
    function = given[0]
    if isinstance(function, Known) and isinstance(function.value, types.FunctionType):
        return Callable(function.value, tuple(given[1:]))
    if isinstance(function, Callable) and not isinstance(function.code, LocalFunction):
        return dataclasses.replace(function, bound=(*function.bound, *given[1:]))
    raise frame.refuse(node, f"partial of {described(function)}", "give it a function of the module")
