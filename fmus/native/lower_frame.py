"""One function while it is lowered: its variables, its statements so far, and what its parts need of it."""

from __future__ import annotations

import abc
import ast
import contextlib
import dataclasses
import types
from collections.abc import Iterator, Sequence

from . import ir
from .errors import Unsupported
from .lower_intervals import Interval
from .lower_source import FunctionNode, Module, NeedsNumber
from .lower_types import Names, Types
from .lower_values import (
    Callable,
    Code,
    Group,
    Known,
    Missing,
    Run,
    Value,
    Words,
    described,
    mentions,
    reads_list,
)
from .values import ListType, StructType, Type

Env = dict[str, Value | Missing]

# names of what functions of python_arithmetic.h give, by the last part of their names
_RESULTS = {
    "div": "quotient",
    "floordiv": "quotient",
    "mod": "remainder",
    "pow": "power",
    "mul": "product",
    "add": "sum",
    "sub": "difference",
    "exp": "exponential",
    "expm1": "exponential",
    "sqrt": "root",
    "log": "logarithm",
    "sin": "sine",
    "cos": "cosine",
    "tan": "tangent",
    "abs": "size",
    "index": "place",
    "floor": "whole",
    "ceil": "whole",
    "trunc": "whole",
    "int": "whole",
    "round": "whole",
}


@dataclasses.dataclass(frozen=True)
class Lowered:
    """A specialization: the function of the program, or a value that is known without one."""

    function: ir.Function | None
    constant: Value | None = None
    changes: bool = False


class Lowering(abc.ABC):
    """A program that is being lowered. `declared` are the structs of the records that the model declares."""

    types: Types
    declared: dict[type, StructType]

    @abc.abstractmethod
    def specialize(self, callee: Callable, bound: Sequence[tuple[str, Value]], name: str = "") -> Lowered:
        """Return the specialization of a function for the types of these arguments."""

    @abc.abstractmethod
    def is_active(self, code: Code) -> bool:
        """Return True for a function that is being lowered, so that a call of it calls itself."""

    @abc.abstractmethod
    def can_fail(self, function: str) -> bool:
        """Return True if a function of the program can fail."""


@dataclasses.dataclass
class Loop:
    """A loop that is being lowered: the variables where it is left, and where a turn ends early."""

    breaks: list[Env] = dataclasses.field(default_factory=list)
    continues: list[Env] = dataclasses.field(default_factory=list)


class Frame(abc.ABC):
    """A function that is being lowered, with the parts that all others use."""

    def __init__(
        self, program: Lowering, code: Code, node: FunctionNode, module: Module, names: Sequence[str]
    ) -> None:
        self.program, self.types = program, program.types
        self.code, self.node, self.module = code, node, module
        self.names = Names(names)
        self.env: Env = {}
        self.block: list[ir.Statement] = []
        self.locals: dict[str, ir.Local] = {}
        self.temporaries: set[str] = set()
        self.arguments: tuple[ir.Local, ...] = ()
        self.declared = program.declared
        self.self_name = ""
        self.loops: list[Loop] = []
        self.changes_arguments = False
        self.stores: dict[str, list[int]] = {}
        self.ranges: dict[str, Interval] = {}
        self._by_name: dict[tuple[str, Type], ir.Local] = {}

    # -- what the parts do ---------------------------------------------------------------------------------

    @abc.abstractmethod
    def value(self, node: ast.expr) -> Value:
        """Return the value of an expression, after emitting what it must compute first."""

    @abc.abstractmethod
    def call(
        self, node: ast.expr, callee: Callable, given: Sequence[Value], named: dict[str, Value]
    ) -> Value:
        """Return the result of a call of one of the model's functions."""

    @abc.abstractmethod
    def called(self, node: ast.Call) -> Value:
        """Return the result of a call."""

    @abc.abstractmethod
    def captured(self, node: ast.FunctionDef | ast.Lambda, name: str) -> Value:
        """Return a function in this function, with what it captures."""

    @abc.abstractmethod
    def derived(self, node: ast.expr, of: Run, function: types.FunctionType, name: str) -> Value:
        """Return a cached property."""

    @abc.abstractmethod
    def run(self, statements: Sequence[ast.stmt]) -> bool:
        """Lower statements; return True if none behind them is reached."""

    @abc.abstractmethod
    def attribute(self, node: ast.expr, of: Value, name: str) -> Value:
        """Return an attribute of a value."""

    @abc.abstractmethod
    def truth(self, node: ast.expr) -> Known | Run:
        """Return the truth value of an expression."""

    @abc.abstractmethod
    def items(self, node: ast.AST, value: Value) -> list[Value]:
        """Return the items of a value whose length is known."""

    @abc.abstractmethod
    def assign(self, name: str, value: Value, node: ast.AST) -> None:
        """Give a variable of the function a value."""

    @abc.abstractmethod
    def assign_self(self, target: ast.Attribute, value: Value) -> None:
        """Give an attribute of the object that is being made its value."""

    @abc.abstractmethod
    def returned(self, node: ast.Return) -> None:
        """Lower a `return`."""

    @abc.abstractmethod
    def unpack(self, target: ast.expr, value: Value) -> None:
        """Give a target of an assignment its value."""

    # -- refusals ------------------------------------------------------------------------------------------

    def refuse(self, node: ast.AST, rule: str, instead: str) -> Unsupported:
        """Return the exception for a construct."""
        return self.module.refuse(node, rule, instead)

    def needs_number(self, node: ast.AST, rule: str, instead: str) -> Unsupported:
        """Return the exception for a number that must be known when the FMU is built."""
        return self.module.refuse(node, rule, instead, NeedsNumber)

    # -- values --------------------------------------------------------------------------------------------

    def expr(self, node: ast.AST, value: Value) -> ir.Expression:
        """Return a value as an expression. Raises Unsupported for what has no native form."""
        found = self.types.expression(value)
        if found is None:
            text, instead = described(value), "compute with numbers and tuples"
            if "numpy" in text:
                instead = "write float(...) of it, in the module"
            raise self.refuse(node, f"{text} has no native form", instead)
        return found

    def settled(self, node: ast.AST, value: Value) -> Run:
        """Return a value that later changes do not reach: a temporary, if needed."""
        e = self.expr(node, value)
        if isinstance(e, ir.Literal) or (isinstance(e, ir.Local) and e.name in self.temporaries):
            return Run(e)
        return self.keep(e)

    def simple(self, node: ast.AST, value: Value) -> Run:
        """Return a value that may be read twice within one expression."""
        e = self.expr(node, value)
        return Run(e) if _is_plain(e) else self.keep(e)

    def keep(self, e: ir.Expression, hint: str = "value") -> Run:
        """Return a temporary that has this value."""
        target = self.temporary(e.type, hint)
        self.emit(ir.Assign(target, e))
        return Run(target)

    def values(self, nodes: Sequence[ast.expr]) -> list[Value]:
        """Return the values of expressions, from the left to the right.

        An item of a list is read before a later one changes it.
        """
        found: list[Value] = []
        marks = []
        for node in nodes:
            found.append(self.value(node))
            marks.append(len(self.block))
        return [self.held(marks[k], found[k]) for k in reversed(range(len(nodes)))][::-1]

    def held(self, mark: int, value: Value) -> Value:
        """Return a value that was read before the statements from `mark` on, as it was then."""
        return self._kept_before([mark], value) if self._changes(self.block[mark:]) else value

    def _kept_before(self, mark: list[int], value: Value) -> Value:
        """Return a value with what it reads of lists kept before the statement at `mark`, which moves on."""
        match value:
            case Run():
                return Run(self._read_before(mark, value.expr))
            case Group():
                return dataclasses.replace(
                    value, items=tuple(self._kept_before(mark, v) for v in value.items)
                )
            case Callable():
                return dataclasses.replace(
                    value, bound=tuple(self._kept_before(mark, v) for v in value.bound)
                )
            case Words():
                pieces = (
                    p if isinstance(p, str) else ir.Shown(self._read_before(mark, p.value), p.spec)
                    for p in value.pieces
                )
                return Words(tuple(pieces))
        return value

    def _read_before(self, mark: list[int], e: ir.Expression) -> ir.Expression:
        if not reads_list(e):
            return e
        target = self.temporary(e.type, "before")
        self.block.insert(mark[0], ir.Assign(target, e))
        mark[0] += 1
        return target

    @staticmethod
    def _changes(block: Sequence[ir.Statement]) -> bool:
        calls = [s for s in block if isinstance(s, ir.Call)]
        inner = [s for s in block if isinstance(s, ir.If | ir.For | ir.While)]
        return bool(inner) or any(isinstance(a.type, ListType) for s in calls for a in s.arguments)

    # -- statements ----------------------------------------------------------------------------------------

    def emit(self, statement: ir.Statement) -> None:
        """Put a statement behind those so far."""
        self.block.append(statement)

    @contextlib.contextmanager
    def nested(self) -> Iterator[list[ir.Statement]]:
        """Collect the statements of a block of its own."""
        outer, self.block = self.block, []
        try:
            yield self.block
        finally:
            self.block = outer

    def temporary(self, type_: Type, hint: str) -> ir.Local:
        """Return a new local variable that no name of the source stands for."""
        local = ir.Local(type_, self.names.new(hint))
        self.locals[local.name] = local
        self.temporaries.add(local.name)
        return local

    def checked(self, node: ast.AST, type_: Type, function: str, arguments: Sequence[ir.Expression]) -> Run:
        """Return the result of a function of python_arithmetic.h that can fail."""
        target = self.temporary(type_, _RESULTS.get(function.rpartition("_")[2], "number"))
        self.emit(ir.Checked(target, function, tuple(arguments), self.module.place(node)))
        return Run(target)

    def variable(self, name: str, type_: Type) -> ir.Local:
        """Return the local variable that a name of the source is while it has this type."""
        key = (name, type_)
        if key not in self._by_name:
            is_free = (
                all(known != name for known, _ in self._by_name)
                and name not in self.argument_names
                and name not in self.locals
            )
            own = name if is_free else self.names.new(name)
            self._by_name[key] = self.locals[own] = ir.Local(type_, own)
        return self._by_name[key]

    @property
    def argument_names(self) -> set[str]:
        """The names of the function's arguments."""
        return {a.name for a in self.arguments}

    def may_change(self, name: str, e: ir.Expression) -> bool:
        """Return True if an expression reads what an assignment to a name, or to an item ("[]"), changes."""
        if name == "[]":
            return reads_list(e)
        return any(known == name and mentions(e, local.name) for (known, _), local in self._by_name.items())

    def is_new(self, e: ir.Expression) -> bool:
        """Return True for a list that has no name yet."""
        if isinstance(e, ir.Field):
            return self.is_new(e.of)
        return isinstance(e, ir.Make | ir.Invoke) or (isinstance(e, ir.Local) and e.name in self.temporaries)

    def store(self, target: ir.Local, value: Value, node: ast.AST) -> None:
        """Give a local variable a value; a temporary that was just computed for it is left out."""
        e = self.expr(node, value)
        if e == target:
            return
        k = self._computed(e, target)
        if k is None:
            self.emit(ir.Assign(target, e))
            return
        assert isinstance(e, ir.Local)
        statement = self.block[k]
        assert isinstance(statement, ir.Checked | ir.Call | ir.Derive | ir.Assign)
        self.block[k] = dataclasses.replace(statement, target=target)
        del self.locals[e.name]
        self.temporaries.discard(e.name)
        for name in [name for name, held in self.env.items() if held == Run(e)]:
            del self.env[name]

    def _computed(self, e: ir.Expression, target: ir.Local) -> int | None:
        """Return the place of the statement that computes a temporary, if it may give `target` its value."""
        if not isinstance(e, ir.Local) or e.name not in self.temporaries or isinstance(e.type, ListType):
            return None
        for k in reversed(range(len(self.block))):
            statement = self.block[k]
            if isinstance(statement, ir.Checked | ir.Call | ir.Derive | ir.Assign) and statement.target == e:
                return k
            if mentions(statement, e.name) or mentions(statement, target.name):
                return None
        return None

    def note(self, text: str, since: int) -> None:
        """Put a note at the last statement of those from `since` on that can have one."""
        if not text:
            return
        for k in reversed(range(since, len(self.block))):
            statement = self.block[k]
            if not isinstance(statement, ir.SetLength | ir.Break | ir.Continue | ir.Raise | ir.Say):
                self.block[k] = dataclasses.replace(statement, note=text)
                return


def _is_plain(e: ir.Expression) -> bool:
    if isinstance(e, ir.Field):
        return _is_plain(e.of)
    return isinstance(e, ir.Literal | ir.Local | ir.TableItem)
