"""The types of values that a model's functions hold when they run as C.

A model's code has no declared types that could be trusted: `lower` finds them by following the values. Every
local variable, argument and field has one of these types on all paths.

    Python                                           here
    float, int, bool, complex                        REAL, INTEGER, BOOLEAN, COMPLEX
    item of an IntEnum                               EnumType: an integer that knows its class
    frozen record, NamedTuple, mixed tuple, object   StructType: a value, copied
    tuple of equal items                             ArrayType: a value, may be indexed at run time
    list with a bound of its length                  ListType: one name, changed in place
    Parameters                                       ParametersType: fields, and what is derived of them once
    function in a function, bound arguments          StructType of what it captured
"""

from __future__ import annotations

import dataclasses
import enum


class Scalar(enum.Enum):
    """A plain number; the value is its C type."""

    REAL = "double"
    INTEGER = "int64_t"
    BOOLEAN = "bool"
    COMPLEX = "py_complex"


REAL, INTEGER, BOOLEAN, COMPLEX = Scalar


@dataclasses.dataclass(frozen=True)
class EnumType:
    """An item of `enumeration`, held as an integer."""

    enumeration: type[enum.IntEnum]


@dataclasses.dataclass(frozen=True)
class StructType:
    """Named values, of different types in general. `name` is unique within a program.

    `python` is the class that it stands for (a record, a NamedTuple), else None: a plain tuple, whose fields
    are `item_0`, `item_1`, ..., or a function with what it captured.
    """

    name: str
    fields: tuple[tuple[str, Type], ...]
    python: type | None = None
    about: str = ""


@dataclasses.dataclass(frozen=True)
class ArrayType:
    """A tuple of `length` values of one type."""

    item: Type
    length: int


@dataclasses.dataclass(frozen=True)
class ListType:
    """A list of at most `capacity` values of one type."""

    item: Type
    capacity: int


@dataclasses.dataclass(frozen=True, eq=False)
class ParametersType:
    """A record of parameters, handed on by address; one object in a program for each class.

    `fields` are the declared ones. `derived` are its cached properties that are used: name, type, and the
    name of the function that computes it from the parameters. It grows while a program is lowered.
    """

    name: str
    python: type
    fields: tuple[tuple[str, Type], ...]
    derived: dict[str, tuple[Type, str]] = dataclasses.field(default_factory=dict)


Type = Scalar | EnumType | StructType | ArrayType | ListType | ParametersType


def is_integral(type_: Type) -> bool:
    """Return True for what C holds as an integer: integers, truth values and items of enumerations."""
    return type_ in (INTEGER, BOOLEAN) or isinstance(type_, EnumType)
