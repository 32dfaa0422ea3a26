"""The rows of `tables` for the calls of units, and the functions that repeat a check that failed there.

The process of an isolated unit makes them too, so that nothing here needs numba.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..fmi.fmi1 import Fmi1Unit
from ..fmi.fmi2 import Fmi2Unit
from ..fmi.fmi3 import Fmi3Unit
from ..fmi.instance import Instance
from ..fmi.transfer import Transfer
from . import tables as L
from .items import format_of, item_row
from .surroundings import address

KernelTable = NDArray[np.int64]
"""Rows of 8-byte numbers, int64 or the bits of float64, shape (rows, columns)."""

Cells = Mapping[int, int | float]
"""The numbers of one row by column; the others are 0."""

Recheck = Callable[[int, int], None]
"""Repeats the check that failed in machine code, given its code and detail, and raises the exception."""

_DIRECT = (Fmi1Unit, Fmi2Unit, Fmi3Unit)


def direct(unit: object) -> Instance | None:
    """Return the instance whose C functions machine code calls by itself; None: Python does the unit's turns.

    Python does those of units that need more than these calls: Model Exchange, written in Python.
    """
    return unit if isinstance(unit, Instance) and type(unit) in _DIRECT else None


class CallRows:
    """Rows of CALLS, ITEMS and UNITS.

    `rechecks` has a function for each row of CALLS, `called` its instance; `stepped` has that of each row of
    UNITS. `view`, shape (size,), is the memory of the values.
    """

    def __init__(self, view: memoryview[float]) -> None:
        self._view = view
        self.calls: list[Cells] = []
        self.items: list[Cells] = []
        self.units: list[Cells] = []
        self.rechecks: list[Recheck] = []
        self.called: list[Instance] = []
        self.stepped: list[Instance] = []
        self._kept: list[NDArray[np.float64]] = []  # arrays whose addresses are in the tables

    def add_call(self, instance: Instance, transfer: Transfer) -> None:
        """Add a row of CALLS, and the rows of ITEMS for its values."""

        def recheck(result: int, detail: int) -> None:
            if result == L.BAD_STATUS:
                instance.judge_transfer(transfer, detail)
            item = transfer.items[detail]
            sent = item.scale * self._view[item.slot] + item.offset
            value = transfer.values[detail] if transfer.gets else sent
            instance.refuse(transfer, detail, value)

        self.rechecks.append(recheck)
        self.calls.append(
            {
                L.FUNCTION: address(transfer.pointer),
                L.COMPONENT: instance.component,
                L.REFERENCES: ctypes.addressof(transfer.references),
                L.COUNT: len(transfer.references),
                L.VALUES: ctypes.addressof(transfer.values),
                L.TWICE: int(instance.fmi == "fmi3"),
                L.FORMAT: format_of(transfer),
                L.FIRST_ITEM: len(self.items),
            }
        )
        self.items += [item_row(transfer, item, self._kept) for item in transfer.items]
        self.called.append(instance)

    def add_unit(self, instance: Instance, times: Cells) -> Recheck:
        """Add the row of UNITS for a unit's steps, with the columns `times`; return the check of a step."""
        step = instance.step_call
        assert step is not None  # a unit that has been initialized has one
        row: dict[int, int | float] = {
            L.FUNCTION: address(step.pointer), L.COMPONENT: instance.component, L.ANSWERS: len(step.answers),
        }  # fmt: skip # a row
        row |= times
        row |= {L.EVENT + i: ctypes.addressof(answer) for i, answer in enumerate(step.answers)}
        self.units.append(row)
        self.stepped.append(instance)

        def recheck(result: int, detail: int) -> None:
            instance.judge_step(detail if result == L.BAD_STATUS else 0)

        return recheck


def collect_warnings(table: KernelTable, instances: Sequence[Instance]) -> None:
    """Add the warnings in a table, CALLS or UNITS, to those of the instances of its rows."""
    if table[:, L.WARNINGS].any():
        for i, instance in enumerate(instances):
            instance.log.warnings += int(table[i, L.WARNINGS])
        table[:, L.WARNINGS] = 0


def fill(table: KernelTable, i: int, row: Cells) -> None:
    """Write a row of a table: floats as float64, other numbers as int64."""
    numbers = table.view(np.float64)
    for column, value in row.items():
        (numbers if isinstance(value, float) else table)[i, column] = value


def table(rows: Sequence[Cells], width: int) -> KernelTable:
    """Return rows as a table, shape (rows, width); it has at least one row, so that it has an address."""
    made = np.zeros((max(1, len(rows)), width), dtype=np.int64)
    for i, row in enumerate(rows):
        fill(made, i, row)
    return made
