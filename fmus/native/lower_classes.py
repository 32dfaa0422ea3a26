"""Classes that do more than keep their values: what they do has no native form."""

from __future__ import annotations

import ast
import dataclasses
import enum
import inspect
from collections.abc import Iterable, Iterator

from ...models import base
from .errors import Unsupported
from .lower_frame import Frame
from .lower_source import module_of

_ITEMS = ("iter", "getitem", "len", "add", "mul", "rmul", "contains", "reversed")
_COMPARED = ("eq", "ne", "lt", "le", "gt", "ge")
_ARITHMETIC = (
    "add",
    "sub",
    "mul",
    "truediv",
    "floordiv",
    "mod",
    "pow",
    "lshift",
    "rshift",
    "and",
    "or",
    "xor",
)
_NUMBER = ("bool", "int", "float", "index", "abs", "neg", "pos", "invert", "round", "trunc", "floor", "ceil")
_INTEGER = (*_COMPARED, *_ARITHMETIC, *(f"r{name}" for name in _ARITHMETIC), *_NUMBER, "divmod", "rdivmod")


def own_rule(python: type) -> str:
    """Return the name of what a class computes by a rule of its own where values are kept, "" for none."""
    return next(iter(_own_rules(python)), "")


def refuse_own_rules(frame: Frame, node: ast.AST, python: type) -> None:
    """Raise Unsupported where an object of such a class is made."""
    if rule := own_rule(python):
        raise frame.refuse(node, *_why(python, rule))


def check_classes(classes: Iterable[type]) -> None:
    """Raise Unsupported for a class with rules of its own, with the place of the class."""
    for python in dict.fromkeys(classes):
        if rule := own_rule(python):
            file = inspect.getsourcefile(python) or ""
            module = module_of({"__name__": python.__module__}, file)
            line = inspect.getsourcelines(python)[1]
            why, instead = _why(python, rule)
            raise Unsupported(
                f"{module.file.rpartition('/')[2]}:{line}: class {python.__name__}: {why}; {instead}"
            )


def _why(python: type, rule: str) -> tuple[str, str]:
    return f"{python.__name__} has a rule of its own, {rule}", "write a function, and call it"


def _own_rules(python: type) -> Iterator[str]:
    if type(python).__call__ not in (type.__call__, enum.EnumMeta.__call__):
        yield "a metaclass"
    if issubclass(python, enum.IntEnum):
        yield from _of_enumeration(python)
    elif issubclass(python, tuple):
        yield from _of_named_tuple(python)
    else:
        yield from _changed(python, object, ("getattribute",))
        if dataclasses.is_dataclass(python):
            yield from (name for name in ("__new__", "__init__") if not _is_generated(getattr(python, name)))
            yield from _properties(python, [f.name for f in dataclasses.fields(python)])
        else:
            yield from _changed(python, object, ("new", "setattr"))


def _is_generated(function: object) -> bool:
    """Return True for a function of Python itself, of dataclasses, or of the records of models."""
    code = getattr(function, "__code__", None)
    return code is None or code.co_filename in ("<string>", base.__file__)


def _of_enumeration(python: type[enum.IntEnum]) -> Iterator[str]:
    yield from _changed(python, int, _INTEGER)
    yield from _changed(python, enum.IntEnum, ("getattribute", "str", "format"))
    if python._missing_.__func__ is not enum.Enum._missing_.__func__:  # type: ignore[attr-defined] # class methods
        yield "_missing_"
    if any(item.value != int(item) for item in python):
        yield "items with two values"


def _of_named_tuple(python: type) -> Iterator[str]:
    made = next(each for each in python.__mro__ if "_fields" in vars(each))
    yield from _changed(python, tuple, ("getattribute", *_ITEMS))
    yield from (name for name in ("__new__", "_replace") if getattr(python, name) is not getattr(made, name))
    yield from _changed(python, object, ("init",))
    yield from _properties(python, getattr(made, "_fields", ()))


def _changed(python: type, origin: type, names: Iterable[str]) -> Iterator[str]:
    for name in (f"__{name}__" for name in names):
        if getattr(python, name, None) is not getattr(origin, name, None):
            yield name


def _properties(python: type, fields: Iterable[str]) -> Iterator[str]:
    for name in fields:
        if isinstance(inspect.getattr_static(python, name, None), property):
            yield name
