"""The types and tables of a program that is being lowered, each made once."""

from __future__ import annotations

import dataclasses
import enum
import functools
import re
from collections.abc import Sequence
from types import FunctionType

from . import ir
from .lower_source import first_line
from .lower_values import (
    Callable,
    Group,
    Known,
    Run,
    Value,
    code_key,
    is_parameters,
    literal,
    number_type,
    value_key,
)
from .values import (
    BOOLEAN,
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    EnumType,
    ParametersType,
    StructType,
    Type,
)

_LETTERS: dict[Type, str] = {REAL: "r", INTEGER: "i", BOOLEAN: "b", COMPLEX: "c"}


_OF_C = re.compile(r"\w+_(computed|frame)|(minimum|maximum|items)_\d+|items_of_\w+")
"""Names that a file of C has beside those of the program (emit_functions, emit_description)."""


class Names:
    """Names that are given out once each."""

    def __init__(self, taken: Sequence[str] = ()) -> None:
        self._taken = set(taken)

    def new(self, wanted: str) -> str:
        """Return the name, or with a number behind it where it is taken."""
        wanted = f"own_{wanted}" if _OF_C.fullmatch(wanted) else wanted
        name, number = wanted, 2
        while name in self._taken:
            name, number = f"{wanted}_{number}", number + 1
        self._taken.add(name)
        return name


class Types:
    """The structs, tables and parameters of one program."""

    def __init__(self) -> None:
        self.structs: list[StructType] = []
        self.tables: dict[object, ir.Table] = {}
        self.parameters: dict[type, ParametersType] = {}
        self.callables: dict[StructType, Callable] = {}
        self._by_key: dict[object, StructType] = {}
        self.names = Names()  # of types, tables and functions together

    # -- structs -------------------------------------------------------------------------------------------

    def record(self, python: type, fields: Sequence[tuple[str, Type]]) -> StructType:
        """Return the struct of a class with these fields."""
        name = _class_name(python)
        return self._struct((python, *fields), name, fields, python, first_line(python))

    def tuple_of(self, items: Sequence[Type], python: type | None = None) -> Type:
        """Return the type of a tuple: an array where all items are of one type and it is no NamedTuple."""
        if python is not None:
            return self.record(python, list(zip(_field_names(python), items, strict=True)))
        if all(item == items[0] for item in items):
            return ArrayType(items[0], len(items))
        fields = [(f"item_{k}", item) for k, item in enumerate(items)]
        letters = "".join(_LETTERS.get(item, "x") for item in items)
        return self._struct(("tuple", *fields), f"Tuple_{letters}", fields, None, "")

    def of_callable(self, value: Callable, fields: Sequence[tuple[str, Type]]) -> StructType:
        """Return the struct that keeps the bound values of a function, those that are not known."""
        name = f"Bound_{getattr(value.code, '__name__', '') or getattr(value.code, 'name', '')}".replace(
            "__", "_"
        )
        known = [value_key(v) for v in value.bound if isinstance(v, Known)]
        key = (code_key(value.code), value.remembers, *known, *fields)
        struct = self._struct(key, name, fields, None, "Values that are bound to a function")
        self.callables.setdefault(struct, value)
        return struct

    def captured(self, name: str, key: object, fields: Sequence[tuple[str, Type]]) -> StructType:
        """Return the struct of what a function in a function captured."""
        return self._struct((key, *fields), f"Captured_{name}", fields, None, f"What `{name}` captured")

    def _struct(
        self, key: object, name: str, fields: Sequence[tuple[str, Type]], python: type | None, about: str
    ) -> StructType:
        if key not in self._by_key:
            struct = StructType(self.names.new(name), tuple(fields), python, about)
            self._by_key[key] = struct
            self.structs.append(struct)
        return self._by_key[key]

    def model_record(self, python: type) -> StructType:
        """Return the struct of one of a model's records, by the declared start values."""
        fields = []
        for f in dataclasses.fields(python):
            type_ = number_type(f.default)
            assert type_ is not None, f.name
            fields.append((f.name, type_))
        return self.record(python, fields)

    def declared_state(self, python: type) -> StructType | None:
        """Return the struct of a state by its start values; None where they do not give all types."""
        starts = {f.name: f.default for f in dataclasses.fields(python)}
        found = {name: self.expression(Known(start)) for name, start in starts.items()}
        types = {name: e.type for name, e in found.items() if e is not None}
        return self.record(python, list(types.items())) if len(types) == len(starts) else None

    def model_parameters(self, python: type) -> ParametersType:
        """Return the type of a model's parameters, one for each class."""
        if python not in self.parameters:
            fields = self.model_record_fields(python)
            self.parameters[python] = ParametersType(self.names.new(_class_name(python)), python, fields)
        return self.parameters[python]

    @staticmethod
    def model_record_fields(python: type) -> tuple[tuple[str, Type], ...]:
        """Return the declared fields of a record with their types."""
        types = [(f.name, number_type(f.default)) for f in dataclasses.fields(python)]
        return tuple((name, type_) for name, type_ in types if type_ is not None)

    # -- values --------------------------------------------------------------------------------------------

    def expression(self, value: Value) -> ir.Expression | None:
        """Return a value as an expression; None for what has no native form, or none as a value."""
        match value:
            case Run():
                return value.expr
            case Known():
                return self._known(value.value)
            case Group():
                return self._made([self.expression(item) for item in value.items], value.python)
            case Callable():
                return self._of_callable(value)
        return None

    def _made(self, items: list[ir.Expression | None], python: type | None) -> ir.Expression | None:
        found = [item for item in items if item is not None]
        if len(found) < len(items) or not items:
            return None
        return ir.Make(self.tuple_of([item.type for item in found], python), tuple(found))

    def _of_callable(self, value: Callable) -> ir.Expression | None:
        if (
            len(value.bound) == 1
            and isinstance(value.bound[0], Run)
            and not isinstance(value.code, FunctionType)
        ):
            self.callables.setdefault(_struct_of(value.bound[0]), value)
            return value.bound[0].expr
        fields, items = [], []
        for k, bound in enumerate(value.bound):
            expr = self.expression(bound)
            if expr is None and not isinstance(bound, Known):
                return None
            if expr is not None and not isinstance(bound, Known) and not is_parameters(bound):
                fields.append((f"bound_{k}", expr.type))
                items.append(expr)
        return ir.Make(self.of_callable(value, fields), tuple(items)) if fields else None

    def _known(self, value: object) -> ir.Expression | None:
        if number_type(value) is not None:
            assert isinstance(value, int | float | complex)
            return literal(value)
        if isinstance(value, tuple | list):
            python = type(value) if type(value) not in (tuple, list) else None
            if python is not None and not hasattr(python, "_fields"):
                return None
            return self._made([self._known(item) for item in value], python)
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            names = [f.name for f in dataclasses.fields(value)]
            items = [self._known(getattr(value, name)) for name in names]
            found = [item for item in items if item is not None]
            if len(found) == len(items):
                fields = [(name, item.type) for name, item in zip(names, found, strict=True)]
                return ir.Make(self.record(type(value), fields), tuple(found))
        return None

    def needed_parameters(self, value: Value) -> ParametersType | None:
        """Return the parameters that a function has captured, or one that it holds; None for other values."""
        if isinstance(value, Run) and isinstance(value.type, ParametersType):
            return value.type
        struct = value.type if isinstance(value, Run) and isinstance(value.type, StructType) else None
        function = self.callables.get(struct) if struct is not None else value
        held: list[Value] = []
        if isinstance(function, Callable):
            of_function = isinstance(function.code, FunctionType)
            held += function.bound if of_function else [v for _, v in function.code.known]  # type: ignore[union-attr] # of a LocalFunction
            if not of_function and function.bound and isinstance(function.bound[0], Run):
                struct = _struct_of(function.bound[0])
        for _, type_ in struct.fields if struct is not None else ():
            if isinstance(type_, StructType):
                held += [self.callables[type_]] if type_ in self.callables else []
        found = (self.needed_parameters(each) for each in held)
        return next((parameters for parameters in found if parameters is not None), None)

    def table(self, name: str, made: ir.Make) -> ir.TableItem:
        """Return a table of numbers that are known; `name` is that of the global that it stands for."""
        key = (made.type, repr(made))
        if key not in self.tables:
            self.tables[key] = ir.Table(self.names.new(name), made.type, made)
        return ir.TableItem(made.type, self.tables[key].name)

    # -- the order of types --------------------------------------------------------------------------------

    def ordered(self, roots: Sequence[Type]) -> tuple[StructType, ...]:
        """Return the structs that these types need, each behind those that it is made of."""
        found: dict[StructType, None] = {}
        seen: set[object] = set()

        def visit(type_: Type) -> None:
            for part in parts(type_):
                visit(part)
            if isinstance(type_, StructType):
                found.setdefault(type_)

        def parts(type_: Type) -> list[Type]:
            if isinstance(type_, ParametersType):
                if id(type_) in seen:
                    return []
                seen.add(id(type_))
                return [t for _, t in type_.fields] + [t for t, _ in type_.derived.values()]
            if isinstance(type_, StructType):
                return [t for _, t in type_.fields]
            item = getattr(type_, "item", None)
            return [item] if item is not None and not isinstance(type_, EnumType) else []

        for root in roots:
            visit(root)
        return tuple(found)


def _struct_of(value: Run) -> StructType:
    assert isinstance(value.type, StructType)
    return value.type


def _class_name(python: type) -> str:
    """Return a name for the struct of a class: without that of the model in which it stands."""
    return python.__qualname__.rpartition(".")[2].lstrip("_")


@functools.cache
def _field_names(python: type) -> tuple[str, ...]:
    return tuple(getattr(python, "_fields", ()))


def is_named_tuple(python: object) -> bool:
    """Return True for a class made by NamedTuple."""
    return isinstance(python, type) and issubclass(python, tuple) and hasattr(python, "_fields")


def is_enumeration(python: object) -> bool:
    """Return True for a class of integers with names."""
    return isinstance(python, type) and issubclass(python, enum.IntEnum)
