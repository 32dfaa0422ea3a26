"""Outputs that no vehicle can have, though their unit's status was ok all the time."""

from __future__ import annotations

import numpy as np

from ..cosim.interface import VariableInfo
from ..cosim.plan import Plan
from ..cosim.rows import Array, Table

_ROWS = 1 << 14  # at a time
_SLACK = 1e-9  # of a limit, for what was rounded
_LARGEST = 1e30
"""Beyond it, in whatever unit of measure, an output without declared limits is taken to have diverged."""


def implausible(table: Table, plan: Plan) -> list[str]:
    """Recorded outputs that left the range that they declare, or went beyond 1e30: a sentence for each.

    A range that does not hold is no error: it is the author's claim, and the run went on with what the unit
    computed.
    """
    if not table.shape[0]:
        return []
    interfaces = {unit.name: unit.interface for unit in plan.units}
    found = []
    for column, low, high in zip(plan.columns, *_extremes(table), strict=True):
        unit, _, variable = column.name.partition(".")
        about = interfaces[unit].variables[variable]
        if about.type in ("Real", "Integer") and about.causality in ("output", "local"):
            found += _sentences(column.name, about, float(low), float(high))
    return found


def _extremes(table: Table) -> tuple[Array, Array]:
    """The smallest and the largest value of each column, shapes (columns,)."""
    low, high = np.full(table.shape[1], np.inf), np.full(table.shape[1], -np.inf)
    for start in range(0, table.shape[0], _ROWS):
        rows = table.rows(start, start + _ROWS)
        low, high = np.minimum(low, rows.min(axis=0)), np.maximum(high, rows.max(axis=0))
    return low, high


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
