"""Values of the mathematical library that are kept between steps, since their arguments often stay.

exp, sin and the like are a third of what a step of a small model costs, and their last bits are the
library's, so that none can be had by other means. But one whose argument is made of parameters, held inputs
and the step size alone is mostly asked for what it has just given. Which ones are kept is a guess about time
alone: a value is taken for the same bits of the argument only.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Set

from . import ir
from .values import ParametersType

_KEPT = {
    **{
        f"py_math_{name}": f"py_kept_{name}"
        for name in ["exp", "expm1", "log", "sin", "cos", "tan", "asin", "acos", "sinh", "cosh"]
    },
    "py_float_pow": "py_kept_pow",
}


class Kept:
    """The places of a program, in the functions of a step, whose values are kept, and their numbers."""

    def __init__(self, program: ir.Program, in_step: Set[str], clock: str | None) -> None:
        """`in_step` are the functions that a step computes, `clock` the name of the time among the inputs."""
        self._functions = {f.name: f for f in program.functions if f.name in in_step and not f.remembers}
        self._clock = clock
        self._changing: set[tuple[str, str]] = set()
        for f in self._functions.values():
            if f.name in (program.step, program.outputs, program.notice):
                self._changing.update((f.name, a.name) for a in f.arguments if a.type == program.state)
        more = True
        while more:
            before = len(self._changing)
            for f in self._functions.values():
                self._spread(f)
            more = len(self._changing) > before
        self._numbers: dict[tuple[str, ir.Checked], int] = {}
        for f in self._functions.values():
            for s in statements(f.body):
                if (
                    isinstance(s, ir.Checked)
                    and s.function in _KEPT
                    and not self._changes(f.name, s.arguments)
                ):
                    self._numbers.setdefault((f.name, s), len(self._numbers))

    @property
    def count(self) -> int:
        """The number of values that are kept."""
        return len(self._numbers)

    @property
    def functions(self) -> frozenset[str]:
        """The functions in which values are kept."""
        return frozenset(name for name, _ in self._numbers)

    def call(self, function: str, statement: ir.Checked) -> tuple[str, list[str]]:
        """Return the function that a statement calls, and its argument for what is kept, if anything is."""
        number = self._numbers.get((function, statement))
        if number is None:
            return statement.function, []
        return _KEPT[statement.function], [f"&memory->kept[{number}]"]

    def _changes(self, function: str, node: object) -> bool:
        """Return True for what is made of the state, of the time, or of what a loop counts."""
        match node:
            case ir.Local():
                return (function, node.name) in self._changing
            case ir.Field():
                return node.name == self._clock or self._changes(function, node.of)
            case tuple():
                return any(self._changes(function, part) for part in node)
        if dataclasses.is_dataclass(node) and not isinstance(node, ir.Place | ParametersType):
            fields = dataclasses.fields(node)
            return any(self._changes(function, getattr(node, f.name)) for f in fields if f.name != "type")
        return False

    def _spread(self, f: ir.Function) -> None:
        """Mark what a function makes of something that changes."""
        for s in statements(f.body):
            match s:
                case ir.Assign():
                    self._mark(f.name, s.target, s.value)
                case ir.Checked() | ir.Call():
                    self._mark(f.name, s.target, s.arguments)
                case ir.For():
                    self._changing.add((f.name, s.local.name))
                case ir.SetItem():
                    self._mark(f.name, s.list, (s.index, s.value))
            for name, given in calls(s):
                if name in self._functions:
                    for argument, value in zip(self._functions[name].arguments, given, strict=True):
                        if self._changes(f.name, value):
                            self._changing.add((name, argument.name))

    def _mark(self, function: str, target: ir.Local | None, value: object) -> None:
        if target is not None and self._changes(function, value):
            self._changing.add((function, target.name))


def statements(block: ir.Block) -> Iterator[ir.Statement]:
    """Return all statements of a block, with those of the blocks within them."""
    for s in block:
        yield s
        match s:
            case ir.If():
                yield from statements(s.then + s.otherwise)
            case ir.For():
                yield from statements(s.body)
            case ir.While():
                yield from statements(s.before + s.body)


def calls(node: object) -> Iterator[tuple[str, tuple[ir.Expression, ...]]]:
    """Return the calls of functions of the program in a statement or an expression, not in its blocks."""
    if isinstance(node, ir.Call | ir.Invoke):
        yield node.function, node.arguments
    if isinstance(node, tuple):
        for part in node:
            if not isinstance(part, ir.Statement):
                yield from calls(part)
    elif dataclasses.is_dataclass(node) and not isinstance(node, ir.Place | ParametersType):
        for field in dataclasses.fields(node):
            if field.name != "type":
                yield from calls(getattr(node, field.name))
