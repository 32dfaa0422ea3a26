"""Warnings of implausible outputs: beyond their declared range, or diverged, though every status was ok."""

from __future__ import annotations

import numpy as np

from ...cosim.interface import VariableInfo
from ...cosim.plan.plan import Plan
from ...cosim.row_store import Array, Table
from ...cosim.visible import on_one_line

_ROWS = 1 << 14  # read at a time
_SLACK = 1e-9  # of a limit: rounding may exceed it
_LARGEST = 1e30
"""The magnitude, in any unit of measure, beyond which an output without declared limits has diverged."""


class Extremes:
    """The smallest and the largest value of each column of a growing table; no final row is read twice."""

    def __init__(self, columns: int) -> None:
        self._rows = 0
        self._low, self._high = np.full(columns, np.inf), np.full(columns, -np.inf)

    def of(self, table: Table) -> tuple[Array, Array]:
        """Return both for a table of the rows so far, shapes (columns,).

        Its last row may not be final, and is read again with those that follow.
        """
        count = table.shape[0]
        for start in range(self._rows, count - 1, _ROWS):
            self._low, self._high = self._with(table.rows(start, min(start + _ROWS, count - 1)))
        self._rows = max(self._rows, count - 1)
        return self._with(table.rows(self._rows, count))

    def _with(self, rows: Array) -> tuple[Array, Array]:
        if not len(rows):
            return self._low, self._high
        return np.minimum(self._low, rows.min(axis=0)), np.maximum(self._high, rows.max(axis=0))


def implausible(extremes: tuple[Array, Array], plan: Plan) -> list[str]:
    """Return a sentence for each recorded output that left its declared range or exceeded 1e30.

    `extremes` are the smallest and largest values, shapes (columns,). Leaving a range is no error: the range
    is the author's claim, and the run went on with the computed values.
    """
    interfaces = {unit.name: unit.interface for unit in plan.units}
    found = []
    for column, low, high in zip(plan.columns, *extremes, strict=True):
        unit, _, variable = column.name.partition(".")
        about = interfaces[unit].variables[variable]
        if low <= high and about.type in ("Real", "Integer") and about.causality in ("output", "local"):
            found += _sentences(on_one_line(column.name), about, float(low), float(high))
    return found


def _sentences(name: str, about: VariableInfo, low: float, high: float) -> list[str]:
    unit = f" {about.unit}" if about.unit else ""
    if about.min is not None and low < about.min - _SLACK * abs(about.min):
        return [f"{name} reached {low:g}{unit}, below its minimum of {about.min:g}{unit}"]
    if about.max is not None and high > about.max + _SLACK * abs(about.max):
        return [f"{name} reached {high:g}{unit}, above its maximum of {about.max:g}{unit}"]
    farthest = max(low, high, key=abs)
    if abs(farthest) > _LARGEST:
        return [f"{name} reached {farthest:g}{unit}: it diverged, or its unit of measure is not what it says"]
    return []
