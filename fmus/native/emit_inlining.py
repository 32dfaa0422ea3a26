"""The functions of a program that a compiler is told to compute where they are called: those of a step."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator

from . import ir
from .emit_types import type_name

MOST = 300
"""Statements that all places together may get of a function that is called at several, with what it calls."""


class Calls:
    """Who calls whom, in a step, in what is shown and in what is told.

    What is derived from the parameters, and what is remembered, is computed once and no part of a step.
    """

    def __init__(self, program: ir.Program) -> None:
        self._functions = {f.name: f for f in program.functions}
        self._calls: dict[str, Counter[str]] = {
            f.name: Counter(called(f.body)) for f in program.functions if not f.remembers
        }
        self._sizes: dict[str, int] = {}
        roots = [program.step, program.outputs, *([program.notice] if program.notice else [])]
        self.in_step = self._reached(roots)

    def in_place(self) -> frozenset[str]:
        """Return the functions to compute in place, with those that look up what is known already."""
        return frozenset(name for name in self.in_step if self._fits(name))

    def _fits(self, name: str) -> bool:
        places = self._places(name)
        return places <= 1 or places * self._size(name) <= MOST

    def _reached(self, roots: list[str]) -> frozenset[str]:
        found: set[str] = set()
        ahead = list(roots)
        while ahead:
            if (name := ahead.pop()) not in found:
                found.add(name)
                ahead += self._calls.get(name, Counter())
        return frozenset(found)

    def _places(self, name: str) -> int:
        return sum(self._calls.get(caller, Counter())[name] for caller in self.in_step)

    def _size(self, name: str) -> int:
        """Return the number of statements of a function, with those of all that it calls."""
        if name not in self._sizes:
            function = self._functions.get(name)
            own = 3 if function is None or function.remembers else _statements(function.body)
            inner = self._calls.get(name, Counter()).items()
            self._sizes[name] = own + sum(count * self._size(callee) for callee, count in inner)
        return self._sizes[name]


def called(block: object) -> Iterator[str]:
    """Return the names of the functions of the program that a block calls, accessors of parameters too."""
    if isinstance(block, ir.Call | ir.Invoke):
        yield block.function
    if isinstance(block, ir.Derive):
        yield derived_name(type_name(block.parameters.type), block.name)
    if isinstance(block, tuple):
        for part in block:
            yield from called(part)
    elif dataclasses.is_dataclass(block) and not isinstance(block, ir.Place):
        for field in dataclasses.fields(block):
            if field.name != "type":
                yield from called(getattr(block, field.name))


def derived_name(parameters: str, name: str) -> str:
    """Return the name of the function that gives a derived value of the parameters."""
    return f"{parameters}_{name}"


def _statements(block: ir.Block) -> int:
    count = 0
    for s in block:
        count += 1
        match s:
            case ir.If():
                count += _statements(s.then + s.otherwise)
            case ir.For():
                count += _statements(s.body)
            case ir.While():
                count += _statements(s.before + s.body)
    return count
