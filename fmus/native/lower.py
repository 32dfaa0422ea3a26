"""A model's class as a program of typed functions: the only place that knows which Python has a native form.

One function is made for each specialization of a Python function: it and the types of its arguments.
Arguments that are known when the FMU is built and have no native form (functions, classes, texts) are part of
what tells specializations apart. Types are found by following the values; annotations are not read.

What has no native form raises Unsupported: file, line, source text, rule, and what to write instead.
"""

from __future__ import annotations

import ast
import dataclasses
from collections.abc import Iterator, Sequence
from types import FunctionType

from ...models.base import Model
from . import ir
from .errors import Unsupported
from .lower_classes import check_classes
from .lower_frame import Lowered, Lowering
from .lower_functions import FunctionFrame
from .lower_source import FunctionNode, NeedsNumber, first_line, source_of
from .lower_source import parameters as parameter_names
from .lower_types import Names, Types
from .lower_values import (
    Callable,
    Code,
    Known,
    LocalFunction,
    Run,
    Value,
    code_key,
    is_parameters,
    value_key,
)
from .values import REAL, EnumType, ListType, ParametersType, StructType, Type

__all__ = ["Unsupported", "lower"]


def lower(model: type[Model]) -> ir.Program:
    """Return a model as a program. Raises Unsupported for a construct that has no native form."""
    return _Program(model).whole()


class _Program(Lowering):
    """A model that is being lowered."""

    def __init__(self, model: type[Model]) -> None:
        self.model, self.types = model, Types()
        self.parameters = self.types.model_parameters(model.Parameters)
        self.declared = {r: self.types.model_record(r) for r in (model.Inputs, model.Outputs)}
        state = self.types.declared_state(model.State)
        if state is not None:
            self.declared[model.State] = state
        self._functions: dict[str, ir.Function] = {}
        self._done: dict[object, Lowered | NeedsNumber] = {}
        self._active: list[Code] = []
        self._kept: list[object] = []  # objects whose id is a key must live

    def whole(self) -> ir.Program:
        """Return the program."""
        u, y = self.declared[self.model.Inputs], self.declared[self.model.Outputs]
        more: list[tuple[str, Type]] = [("u", u)] if self.model.feeds_through() else []
        initial = self._root("initial", [("u", u)], self.declared.get(self.model.State))
        x = self._state(initial)
        step = self._root("step", [("x", x), ("u", u), ("dt", REAL)], x)
        outputs = self._root("outputs", [("x", x), *more], y)
        notice = None
        if self.model.notice is not None:
            notice = self._root("notice", [("before", x), ("after", x), ("u", u)], None)
        functions = self._reached([f for f in (initial, step, outputs, notice) if f is not None])
        used = [t for f in functions for t in _types_of(f)]
        check_classes([*self._classes(functions)])
        tables = tuple(t for t in self.types.tables.values() if any(_reads(f, t.name) for f in functions))
        types = self.types.ordered([*used, self.parameters, u, x, y, *(t.type for t in tables)])
        return ir.Program(
            self.model.__name__, first_line(self.model), self.parameters, u, x, y, types, tables,
            self._without_clashes(functions), initial, step, outputs, notice,
        )  # fmt: skip # as they are declared

    def _classes(self, functions: Sequence[ir.Function]) -> Iterator[type]:
        """Return the classes of the values that the program computes with."""
        for type_ in (t for f in functions for part in _parts(f) for t in [getattr(part, "type", None)]):
            if isinstance(type_, EnumType):
                yield type_.enumeration
        for struct in self.types.structs:
            if struct.python is not None:
                yield struct.python

    def _state(self, initial: str) -> StructType:
        """Return the type of the state: as it is declared, else as `initial` returns it."""
        returned = self._functions[initial].returns
        if not isinstance(returned, StructType) or returned.python is not self.model.State:
            raise Unsupported(f"{self.model.__name__}.initial returns no State: write return State(...)")
        return self.declared.setdefault(self.model.State, returned)

    def _root(self, name: str, given: list[tuple[str, Type]], expected: Type | None) -> str:
        """Lower one of the model's functions; return the name that it has in the program."""
        function = getattr(self.model, name)
        if not isinstance(function, FunctionType):
            raise Unsupported(
                f"{self.model.__name__}.{name} is no plain function: write @staticmethod before it"
            )
        names = parameter_names(source_of(function)[0])
        types: list[Type] = [self.parameters, *(type_ for _, type_ in given)]
        if len(names) != len(types):
            raise Unsupported(
                f"{self.model.__name__}.{name} has {len(names)} parameters: it must have {len(types)}"
            )
        bound: list[tuple[str, Value]] = [
            (own, Run(ir.Local(type_, own))) for own, type_ in zip(names, types, strict=True)
        ]
        lowered = self._specialized(Callable(function), bound, name, expected, name == "notice")
        assert lowered.function is not None
        if lowered.function.returns is None and name != "notice":
            module, node = source_of(function)[1], source_of(function)[0]
            raise module.refuse(node, "a path without return", "return a value on every path")
        return lowered.function.name

    # -- specializations -----------------------------------------------------------------------------------

    def specialize(self, callee: Callable, bound: Sequence[tuple[str, Value]], name: str = "") -> Lowered:
        """Return the specialization of a function for the types of these arguments."""
        return self._specialized(callee, bound, name, None, False)

    def is_active(self, code: Code) -> bool:
        """Return True for a function that is being lowered."""
        return any(code_key(active) == code_key(code) for active in self._active)

    def can_fail(self, function: str) -> bool:
        """Return True if a function of the program can fail."""
        return self._functions[function].can_fail

    def _specialized(
        self,
        callee: Callable,
        bound: Sequence[tuple[str, Value]],
        name: str,
        expected: Type | None,
        speaks: bool,
    ) -> Lowered:
        captured = (
            value_key(callee.bound[0]) if isinstance(callee.code, LocalFunction) and callee.bound else None
        )
        arguments = tuple((n, value_key(v)) for n, v in bound)
        key = (code_key(callee.code), callee.remembers, captured, arguments)
        self._kept.append(bound)
        found = self._done.get(key)
        if isinstance(found, NeedsNumber):
            raise found
        if found is None:
            self._active.append(callee.code)
            try:
                found = self._done[key] = self._lowered(callee, bound, name, expected, speaks)
            except NeedsNumber as error:
                self._done[key] = error
                raise
            finally:
                self._active.pop()
        return found

    def _lowered(
        self,
        callee: Callable,
        bound: Sequence[tuple[str, Value]],
        name: str,
        expected: Type | None,
        speaks: bool,
    ) -> Lowered:
        code = callee.code
        node, module = (code.node, code.module) if isinstance(code, LocalFunction) else source_of(code)
        frame = FunctionFrame(self, code, node, module, expected)
        frame.speaks, frame.is_root = speaks, bool(name) and not name.startswith("compute_")
        _bind(frame, callee, bound)
        frame.lower()
        if frame.constants:
            if not frame.block and len(frame.constants) == 1:
                return Lowered(None, frame.constants[0])
            raise frame.refuse(
                node, "a function that computes, and returns a function or an object", "return numbers"
            )
        function = ir.Function(
            self.types.names.new(name or _name(code, frame.self_name)),
            frame.arguments,
            frame.returns,
            tuple(frame.locals.values()),
            tuple(frame.block),
            self._fails(frame.block),
            module.place(node),
            _about(node),
            callee.remembers,
        )
        self._functions[function.name] = function
        return Lowered(function, None, frame.changes_arguments)

    def _fails(self, block: Sequence[ir.Statement]) -> bool:
        """Return True if a statement of these can fail."""
        for s in block:
            match s:
                case ir.Checked() | ir.Raise():
                    return True
                case ir.Call() if self.can_fail(s.function):
                    return True
                case ir.Derive() if self.can_fail(self._deriving(s)):
                    return True
                case ir.If() if self._fails(s.then) or self._fails(s.otherwise):
                    return True
                case ir.For() if self._fails(s.body):
                    return True
                case ir.While() if self._fails(s.before) or self._fails(s.body):
                    return True
        return False

    @staticmethod
    def _deriving(s: ir.Derive) -> str:
        assert isinstance(s.parameters.type, ParametersType)
        return s.parameters.type.derived[s.name][1]

    # -- what is needed ------------------------------------------------------------------------------------

    def _reached(self, roots: Sequence[str]) -> list[ir.Function]:
        """Return the functions that these call, each behind those that it calls itself."""
        found: dict[str, ir.Function] = {}

        def visit(name: str) -> None:
            if name in found:
                return
            for node in _parts(self._functions[name].body):
                if isinstance(node, ir.Call | ir.Invoke):
                    visit(node.function)
                elif isinstance(node, ir.Derive):
                    visit(self._deriving(node))
            found[name] = self._functions[name]

        for root in roots:
            visit(root)
        for name in [n for n, (_, function) in self.parameters.derived.items() if function not in found]:
            del self.parameters.derived[name]
        return list(found.values())

    def _without_clashes(self, functions: list[ir.Function]) -> tuple[ir.Function, ...]:
        """Return the functions with variables that have no name of a function, a table or a type."""
        taken = {f.name for f in functions} | {t.name for t in self.types.tables.values()}
        taken |= {f"{f.name}_computed" for f in functions if f.remembers}
        taken |= {t.name for t in self.types.structs} | {self.parameters.name}
        return tuple(_renamed_locals(f, taken) for f in functions)


def _bind(frame: FunctionFrame, callee: Callable, bound: Sequence[tuple[str, Value]]) -> None:
    """Set the variables with which a function starts."""
    arguments = []
    code = callee.code
    if isinstance(code, LocalFunction):
        frame.env.update({name: v for name, v in code.known if not is_parameters(v)})
        if callee.bound:
            struct = callee.bound[0]
            assert isinstance(struct, Run) and isinstance(struct.type, StructType)
            local = ir.Local(struct.type, frame.names.new("captured"))
            arguments.append(local)
            for name, type_ in struct.type.fields:
                frame.env[name] = Run(ir.Field(type_, local, name))
    for name, value in bound:
        if isinstance(value, Run):
            local = ir.Local(value.type, name)
            arguments.append(local)
            frame.env[name] = Run(local)
        else:
            frame.env[name] = value
    own = next((Run(a) for a in arguments if isinstance(a.type, ParametersType)), None)
    if isinstance(code, LocalFunction) and own is not None:
        frame.env.update({name: own for name, v in code.known if is_parameters(v)})
    frame.arguments = tuple(arguments)
    is_init = not isinstance(code, LocalFunction) and code.__name__ == "__init__"
    if is_init and bound and isinstance(bound[0][1], Known):
        frame.self_name = bound[0][0]


def _name(code: Code, self_name: str) -> str:
    """Return the name of a function in the program: its own, with that of its class."""
    if isinstance(code, LocalFunction):
        return code.name.strip("_") or "function"
    parts = [part.strip("_") for part in code.__qualname__.replace("<lambda>", "function").split(".")]
    if self_name:
        return f"make_{parts[-2]}"
    return "_".join(parts[-2:]) if "<locals>" not in code.__qualname__ else parts[-1]


def _about(node: FunctionNode) -> str:
    text = ast.get_docstring(node) if isinstance(node, ast.FunctionDef) else ""
    return (text or "").strip().partition("\n")[0]


def _parts(node: object) -> Iterator[object]:
    """Return an expression, a statement or a block, and all that is in it."""
    if isinstance(node, tuple):
        for part in node:
            yield from _parts(part)
    elif dataclasses.is_dataclass(node) and not isinstance(node, StructType | ParametersType | ListType):
        yield node
        for f in dataclasses.fields(node):
            if f.name not in ("type", "place"):
                yield from _parts(getattr(node, f.name))


def _types_of(function: ir.Function) -> list[Type]:
    found = [local.type for local in (*function.arguments, *function.locals)]
    found += [
        n.type for n in _parts(function.body) if isinstance(n, ir.Make | ir.Field | ir.Item | ir.Invoke)
    ]
    return found + ([function.returns] if function.returns is not None else [])


def _reads(function: ir.Function, table: str) -> bool:
    return any(isinstance(n, ir.TableItem) and n.name == table for n in _parts(function.body))


def _renamed_locals(function: ir.Function, taken: set[str]) -> ir.Function:
    names = Names([*taken, *(local.name for local in (*function.arguments, *function.locals))])
    clashing = [x.name for x in (*function.arguments, *function.locals) if x.name in taken]
    renamed = {name: names.new(f"{name}_") for name in clashing}
    if not renamed:
        return function

    def change(node: object) -> object:
        if isinstance(node, ir.Local):
            return ir.Local(node.type, renamed.get(node.name, node.name))
        if isinstance(node, tuple):
            return tuple(change(part) for part in node)
        if not dataclasses.is_dataclass(node) or isinstance(node, type | ir.Place | ir.Literal):
            return node
        if isinstance(node, StructType | ParametersType | ListType) or type(node).__name__.endswith("Type"):
            return node
        fields = [f.name for f in dataclasses.fields(node)]
        return type(node)(**{name: change(getattr(node, name)) for name in fields})

    changed = change(function)
    assert isinstance(changed, ir.Function)
    return changed
