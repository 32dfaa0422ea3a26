"""The structure of a program: what of its tables is equal in all runs of one system, as the text of a key.

Slots, counts, kinds and the order of operations belong to it, and which maps change nothing. Addresses,
factors, limits, periods and times do not: the machine code that is made for a structure reads them from the
tables, so that it stays the same whatever a parameter is, and wherever a library is loaded.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...fmi.types import WIDE_CODES
from ...machine import tables as L
from ...machine.rows import KernelTable
from .known_frames import Frames, frames_of

if TYPE_CHECKING:
    from .program import Program

ALWAYS = -1
"""The group of operations that are due at each step."""


@dataclasses.dataclass(frozen=True)
class Move:
    """A value that is taken from a slot, mapped by the numbers of a table's row, and written to a slot.

    `plain`: the map changes nothing. One of the two slots is -1 where the value does not come from the
    memory, or does not go there.
    """

    row: int
    source: int
    sink: int
    plain: bool


@dataclasses.dataclass(frozen=True)
class CCall:
    """A row of CALLS: get or set `count` values; `items` are those that are converted, by `format`.

    `listed`: one of them is of an enumeration with gaps.
    """

    row: int
    count: int
    twice: bool
    format: int
    items: tuple[Move, ...]
    listed: bool

    @property
    def is_wide(self) -> bool:
        """True if it reads whole numbers that a double does not all hold."""
        return self.format - L.GETS in WIDE_CODES


@dataclasses.dataclass(frozen=True)
class Stepping:
    """A row of UNITS: the FMU steps of a turn, and whether each answers as in FMI 3.0."""

    row: int
    count: int
    answers: bool


@dataclasses.dataclass(frozen=True)
class Sent:
    """A row of SIGNALS: where the value comes from and goes, the rounding, and what changes nothing."""

    row: int
    source: int
    mode: int
    plain_in: bool
    plain_raw: tuple[bool, bool]  # an offset of 0, a resolution of 1
    plain_out: bool
    sinks: tuple[Move, ...]


@dataclasses.dataclass(frozen=True)
class Step:
    """An operation of the program: `kind`, a, b and c as in OPS, the group with which it is due.

    A group has the number of its first operation. The others are what the operation's rows say.
    """

    kind: int
    group: int
    a: int
    b: int
    c: int
    moves: tuple[Move, ...] = ()
    calls: tuple[CCall, ...] = ()
    stepping: Stepping | None = None
    sent: tuple[Sent, ...] = ()


@dataclasses.dataclass(frozen=True)
class Structure:
    """The operations of a step in order, the slots that are recorded, and what is known of frames."""

    steps: tuple[Step, ...]
    columns: tuple[int, ...]
    frames: Frames | None = None


def structure_of(program: Program) -> Structure:
    """Return the structure of a program."""
    return _Reader(program).structure()


class _Reader:
    """The tables of a program as numbers of Python."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._routes, self._sinks = _Rows(program.routes), _Rows(program.sinks)
        self._items, self._signals = _Rows(program.items), _Rows(program.signal_table)
        self._calls, self._units = program.calls.tolist(), program.units.tolist()

    def structure(self) -> Structure:
        """Return it."""
        steps: list[Step] = []
        due = None
        for i, op in enumerate(self._program.ops.tolist()):
            if (op[L.EVERY], op[L.FIRST]) == (1, 0):
                due, group = None, ALWAYS
            elif due != (op[L.EVERY], op[L.FIRST]):
                due, group = (op[L.EVERY], op[L.FIRST]), i
            steps.append(self._step(op, group))
        frames = frames_of(self._program.frames) if self._program.frames is not None else None
        return Structure(tuple(steps), tuple(self._program.columns.tolist()), frames)

    def _step(self, op: list[int], group: int) -> Step:
        kind, a, b, c = op[L.KIND], op[L.A], op[L.B], op[L.C]
        if kind == L.TAKE:
            moves = tuple(self._routes.move(row, True) for row in range(a, a + b))
            return Step(kind, group, a, b, c, moves=moves)
        if kind == L.CALL:
            return Step(kind, group, a, b, c, calls=(self._call(a),))
        if kind == L.STEP:
            unit = self._units[a]
            stepping = Stepping(a, unit[L.STEPS], bool(unit[L.ANSWERS]))
            calls = tuple(self._call(row) for row in range(b, b + c))
            return Step(kind, group, a, b, c, calls=calls, stepping=stepping)
        if kind == L.SEND:
            return Step(kind, group, a, b, c, sent=tuple(self._sent(row) for row in range(a, a + b)))
        if kind == L.EFFECT:
            b = 0  # the number of those of the moment
        return Step(kind, group, a, b, c)

    def _call(self, row: int) -> CCall:
        call = self._calls[row]
        rows = range(call[L.FIRST_ITEM], call[L.FIRST_ITEM] + call[L.COUNT]) if call[L.FORMAT] else ()
        gets = call[L.FORMAT] > L.GETS
        items = tuple(self._item(i, gets) for i in rows)
        listed = any(self._items.numbers[i][L.CHOICES] for i in rows)
        return CCall(row, call[L.COUNT], bool(call[L.TWICE]), call[L.FORMAT], items, listed)

    def _item(self, row: int, gets: bool) -> Move:
        slot, values = self._items.numbers[row][L.SLOT], self._items.values[row]
        plain = _is_plain(values[L.FACTOR], values[L.ADDEND])
        return Move(row, -1 if gets else slot, slot if gets else -1, plain)

    def _sent(self, row: int) -> Sent:
        numbers, values = self._signals.numbers[row], self._signals.values[row]
        first = numbers[L.TO]
        sinks = range(first, first + numbers[L.RECEIVERS])
        return Sent(
            row,
            numbers[L.FROM],
            numbers[L.MODE],
            _is_plain(values[L.IN_SCALE], values[L.IN_ADD]),
            (_is(values[L.OFFSET], 0.0), values[L.RESOLUTION] == 1.0),
            _is(values[L.OUT_ADD], -0.0),
            tuple(self._sinks.move(i, False) for i in sinks),
        )


class _Rows:
    """A table as rows of whole numbers, and as rows of real ones."""

    def __init__(self, table: KernelTable) -> None:
        self.numbers: list[list[int]] = table.tolist()
        self.values: list[list[float]] = table.view(np.float64).tolist()

    def move(self, row: int, sourced: bool) -> Move:
        """Return the move of a row of ROUTES or SINKS; `sourced`: its value comes from the memory."""
        numbers, values = self.numbers[row], self.values[row]
        plain = _is_plain(values[L.SCALE], values[L.ADD])
        return Move(row, numbers[L.SOURCE] if sourced else -1, numbers[L.SINK], plain)


def _is_plain(scale: float, add: float) -> bool:
    """Return True where scale * x + add is x, for all x: adding 0.0 would change -0.0."""
    return scale == 1.0 and _is(add, -0.0)


def _is(value: float, zero: float) -> bool:
    """Return True for this zero, with its sign."""
    return value == 0.0 and math.copysign(1.0, value) == math.copysign(1.0, zero)


def key(structure: Structure) -> str:
    """Return a text that is equal for equal structures."""
    frames = "" if structure.frames is None else structure.frames.text
    return repr(_plainly((structure.steps, structure.columns))) + frames


def _plainly(thing: Any) -> Any:
    """Return records as tuples, whose text is short."""
    if isinstance(thing, tuple):
        return tuple(_plainly(each) for each in thing)
    if dataclasses.is_dataclass(thing):
        return tuple(_plainly(getattr(thing, field.name)) for field in dataclasses.fields(thing))
    return thing
