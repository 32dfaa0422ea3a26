"""Values while a function is lowered: what runs later, and what is known when the FMU is built."""

from __future__ import annotations

import ast
import dataclasses
import enum
import math
import types

from . import ir
from .lower_source import FunctionNode, Module
from .values import (
    BOOLEAN,
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    EnumType,
    ListType,
    ParametersType,
    StructType,
    Type,
)


@dataclasses.dataclass(frozen=True)
class Run:
    """A value that the native code computes."""

    expr: ir.Expression

    @property
    def type(self) -> Type:
        """The type of the expression."""
        return self.expr.type


@dataclasses.dataclass(frozen=True, eq=False)
class Known:
    """A Python object that is known when the FMU is built: a number, a function, a class, a record."""

    value: object


@dataclasses.dataclass(frozen=True)
class Group:
    """A tuple whose items are known one by one; of `python`, where that is a class of NamedTuple."""

    items: tuple[Value, ...]
    python: type | None = None


@dataclasses.dataclass(frozen=True)
class Words:
    """A text that is put together where it is needed."""

    pieces: ir.Text


@dataclasses.dataclass(frozen=True, eq=False)
class LocalFunction:
    """A function in a function: its source, and what it captured that is known when the FMU is built."""

    name: str
    node: FunctionNode
    module: Module
    known: tuple[tuple[str, Value], ...] = ()

    def key(self) -> tuple[object, ...]:
        """Return what tells it from others."""
        return (self.node, *((name, value_key(value)) for name, value in self.known))


Code = types.FunctionType | LocalFunction


@dataclasses.dataclass(frozen=True)
class Callable:
    """A function with arguments that are bound to it: a method, a partial, or one that captured values.

    Of a LocalFunction `bound` is what it captured, as one struct, or nothing.
    """

    code: Code
    bound: tuple[Value, ...] = ()
    remembers: bool = False


Value = Run | Known | Group | Words | Callable


@dataclasses.dataclass(frozen=True)
class Missing:
    """The reason for which a name has no value, `why`, and what to write instead."""

    why: str
    instead: str


def code_key(code: Code) -> object:
    """Return what tells one function from another."""
    return code.key() if isinstance(code, LocalFunction) else code


def value_key(value: Value) -> object:
    """Return what tells apart values that belong to a specialization: types, and objects that are known."""
    match value:
        case Run():
            return value.type
        case Known():
            return known_key(value.value)
        case Group():
            return (value.python, *(value_key(item) for item in value.items))
        case Callable():
            return (code_key(value.code), value.remembers, *(value_key(item) for item in value.bound))
        case Words():
            return value.pieces


def known_key(value: object) -> object:
    """Return a key of an object that is equal only for the same object, or the same number of one type."""
    if isinstance(value, int | float | complex | str) and not isinstance(value, enum.Enum):
        return (type(value), repr(value))
    if isinstance(value, tuple):
        return (type(value), *(known_key(item) for item in value))
    return ("object", id(value))


def same(a: Value | Missing, b: Value | Missing) -> bool:
    """Return True if two values are the same on all paths."""
    if isinstance(a, Known) and isinstance(b, Known):
        return known_key(a.value) == known_key(b.value)
    return a == b


def type_name(type_: Type) -> str:
    """Return the name of a type in messages: int, float, Road, tuple[float, float]."""
    if isinstance(type_, EnumType):
        return type_.enumeration.__name__
    if isinstance(type_, ArrayType):
        return f"a tuple of {type_.length} {type_name(type_.item)}"
    if isinstance(type_, ListType):
        return f"a list of {type_.capacity} {type_name(type_.item)}"
    if isinstance(type_, StructType | ParametersType):
        return type_.python.__name__ if type_.python else type_.name
    return {REAL: "float", INTEGER: "int", BOOLEAN: "bool", COMPLEX: "complex"}[type_]


def number_type(value: object) -> Type | None:
    """Return the type of a number that is known; None for what is no number of 64 bits."""
    if isinstance(value, enum.IntEnum):
        return EnumType(type(value))
    if type(value) is bool:
        return BOOLEAN
    if type(value) is int:
        return INTEGER if -(2**63) <= value < 2**63 else None
    if type(value) is float:
        return REAL
    return COMPLEX if type(value) is complex else None


def literal(value: float | int | bool | complex) -> ir.Literal:
    """Return a number that is known as an expression."""
    type_ = number_type(value)
    assert type_ is not None
    return ir.Literal(type_, int(value) if isinstance(value, enum.IntEnum) else value)


def as_real(e: ir.Expression) -> ir.Expression:
    """Return a number as a real, as Python converts an int that meets a float."""
    if e.type is REAL:
        return e
    if isinstance(e, ir.Literal) and not isinstance(e.value, complex):
        return ir.Literal(REAL, float(e.value))
    return ir.Convert(REAL, e)


def as_integer(e: ir.Expression) -> ir.Expression:
    """Return an integer, a truth value or an item of an enumeration as an integer."""
    if e.type is INTEGER:
        return e
    if isinstance(e, ir.Literal) and not isinstance(e.value, complex):
        return ir.Literal(INTEGER, int(e.value))
    return ir.Convert(INTEGER, e)


def is_parameters(value: Value) -> bool:
    """Return True for the parameters of the model, of which there is one object: nothing keeps them."""
    return isinstance(value, Run) and isinstance(value.type, ParametersType)


def is_simple(e: ir.Expression) -> bool:
    """Return True for an expression that may stand twice: a variable, a field of one, a number."""
    if isinstance(e, ir.Field):
        return is_simple(e.of)
    if isinstance(e, ir.Item):
        return is_simple(e.of) and isinstance(e.index, ir.Literal)
    return isinstance(e, ir.Literal | ir.Local | ir.TableItem)


def reads_list(e: object) -> bool:
    """Return True if an expression reads of a list, which a call may change; the list itself is not read."""
    if isinstance(e, ir.Item) and isinstance(e.of.type, ListType):
        return True
    if isinstance(e, ir.Invoke) and any(isinstance(a.type, ListType) for a in e.arguments):
        return True
    if isinstance(e, tuple):
        return any(reads_list(part) for part in e)
    if not dataclasses.is_dataclass(e) or isinstance(e, ir.Literal | ir.Local):
        return False
    return any(reads_list(getattr(e, f.name)) for f in dataclasses.fields(e) if f.name != "type")


def is_nonzero(e: ir.Expression) -> bool:
    """Return True for a number that is known not to be 0."""
    return (
        isinstance(e, ir.Literal)
        and bool(e.value)
        and not (isinstance(e.value, float) and math.isnan(e.value))
    )


def node_line(node: ast.stmt) -> int:
    """Return the last line of a statement."""
    return node.end_lineno or node.lineno


def mentions(node: object, name: str) -> bool:
    """Return True if a statement or an expression reads this variable, or gives it a value."""
    if isinstance(node, ir.Local):
        return node.name == name
    if isinstance(node, tuple):
        return any(mentions(part, name) for part in node)
    if not dataclasses.is_dataclass(node) or isinstance(node, ir.Literal | ir.Place):
        return False
    return any(mentions(getattr(node, f.name), name) for f in dataclasses.fields(node) if f.name != "type")


def described(value: Value) -> str:
    """Return a few words for what a value is."""
    match value:
        case Run():
            return type_name(value.type)
        case Known():
            return _known_words(value.value)
        case Group():
            return "a tuple"
        case Callable():
            name = value.code.name if isinstance(value.code, LocalFunction) else value.code.__qualname__
            return f"the function {name}"
    return "a text"


def _known_words(value: object) -> str:
    if isinstance(value, str):
        return "a text"
    if value is None:
        return "None"
    type_ = number_type(value)
    if type_ is not None:
        return type_name(type_)
    if type(value) is int:
        return "an int beyond 64 bits"
    if type(value).__module__ == "numpy":
        kind = "an array" if getattr(value, "shape", ()) else "a number"
        return f"{kind} of numpy ({type(value).__name__})"
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    return str(name) if name else f"a {type(value).__name__}"
