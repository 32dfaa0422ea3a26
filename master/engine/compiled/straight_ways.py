"""Values of the functions that are written out, and what they are where several ways meet."""

from __future__ import annotations

import dataclasses
import functools

from .llvm_text import DOUBLE, WORD, Function, number
from .straight_numbers import BIT, Either, Number, UnknownForm, common_kind, same, union


@dataclasses.dataclass(frozen=True)
class Table:
    """A table of the frame path."""

    name: str


class AllTables:
    """The tables of the frame path."""


Value = Either | Table | AllTables | tuple["Value", ...] | None


def joined(f: Function, ways: list[tuple[str, Value]]) -> Value:
    """Return the value of one of several ways: a phi, unless it is the same on all."""
    values = [value for _, value in ways]
    tuples = [value for value in values if isinstance(value, tuple)]
    if tuples and len(tuples) == len(values):
        parts = zip(*tuples, strict=True)
        return tuple(
            joined(f, [(block, part) for (block, _), part in zip(ways, each, strict=True)]) for each in parts
        )
    if all(value == values[0] and type(value) is type(values[0]) for value in values) and not isinstance(
        values[0], float
    ):
        return values[0]
    numbers = [value for value in values if isinstance(value, int | float | Number)]
    if len(numbers) < len(values):
        return None
    if all(same(value, numbers[0]) for value in numbers):
        return numbers[0]
    kind = functools.reduce(_wider, (common_kind(value, value) for value in numbers))
    low, high = (
        functools.reduce(_bounded, (union(value, value) for value in numbers))
        if kind == WORD
        else (None, None)
    )
    texts = [_operand(value, kind) for value in numbers]
    found = ", ".join(f"[ {text}, %{block} ]" for text, (block, _) in zip(texts, ways, strict=True))
    return Number(f.let(f"phi {kind} {found}"), kind, low, high)


def _operand(value: Either, kind: str) -> str:
    """Return a number as an operand of a phi."""
    if isinstance(value, Number):
        if value.kind != kind:
            raise UnknownForm(f"{value.kind} or {kind}")
        return value.name
    return number(float(value)) if kind == DOUBLE else str(int(value))


def _wider(a: str, b: str) -> str:
    return DOUBLE if DOUBLE in (a, b) else WORD if WORD in (a, b) else BIT


def _bounded(
    a: tuple[int | None, int | None], b: tuple[int | None, int | None]
) -> tuple[int | None, int | None]:
    low = None if a[0] is None or b[0] is None else min(a[0], b[0])
    return low, None if a[1] is None or b[1] is None else max(a[1], b[1])
