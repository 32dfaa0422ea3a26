"""Rows of the kernel's tables: how it moves each value of a C call (ITEMS), steps a unit, sends a signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ....cosim.can.channel import SignalRoute
from ....cosim.can.quantization import SignalOperation
from ....cosim.plan.turns import TurnTimes
from ....cosim.units.measure import Affine
from ...fmi.transfer import Item, Transfer
from . import tables as L
from .codes import raw_mode

Cells = Mapping[int, int | float]
"""The numbers of one row by column; the others are 0."""


def item_row(transfer: Transfer, item: Item, kept: list[NDArray[np.float64]]) -> dict[int, int | float]:
    """Return the numbers of a row by column.

    An enumeration that leaves numbers out has an array of those that it has, which is added to `kept`.
    """
    (low, high), choices = transfer.type.doubles, item.variable.choices
    row: dict[int, int | float] = {
        L.SLOT: item.slot, L.FACTOR: item.scale, L.ADDEND: item.offset, L.LOW: low, L.HIGH: high
    }  # fmt: skip # a row
    if choices:
        row |= {L.LOW: float(choices[0]), L.HIGH: float(choices[-1])}
        if choices[-1] - choices[0] >= len(choices):
            numbers = np.array(choices, dtype=np.float64)
            kept.append(numbers)
            row |= {L.CHOICES: len(choices), L.NUMBERS_OF: numbers.ctypes.data}
    return row


def format_of(transfer: Transfer) -> int:
    """Return the code of a call's buffer."""
    if not transfer.items:
        return L.IN_PLACE
    return transfer.type.code + (L.GETS if transfer.gets else 0)


def times_row(times: TurnTimes) -> Cells:
    """Return the columns of UNITS that say when the unit steps."""
    last = times.last or times.steps(0)  # without a last turn these are not looked at
    return {
        L.STEPS: times.substeps, L.TIME_FACTOR: times.factor, L.DIVISOR: times.divisor,
        L.ADVANCE: times.advance, L.STEP_SIZE: times.size, L.LAST_TURN: times.last_k,
        L.LAST_ADVANCE: last.advance, L.LAST_SIZE: last.size, L.LANDING_SIZE: last.last,
    }  # fmt: skip # columns of a row


def mapped(affine: Affine) -> dict[int, int | float]:
    """Return a map's columns; an offset of 0 becomes -0.0, since adding 0.0 would turn -0.0 into 0.0."""
    return {L.SCALE: float(affine.scale), L.ADD: float(affine.offset) or -0.0}


def signal_row(route: SignalRoute, operation: SignalOperation, first_sink: int) -> Cells:
    """Return the columns of SIGNALS that say how a signal is sent; its receivers begin at `first_sink`."""
    row: dict[int, int | float] = {
        L.FROM: route.source,
        L.MODE: raw_mode(operation),
        L.SATURATES: int(operation.raw_below is not None),
        L.TO: first_sink,
        L.RECEIVERS: len(route.sinks),
        L.IN_SCALE: float(route.to_bus.scale),
        L.IN_ADD: float(route.to_bus.offset) or -0.0,
        L.LEAST: operation.low,
        L.GREATEST: operation.high,
        L.RESOLUTION: operation.scale,
        L.OFFSET: operation.offset,
        L.OUT_ADD: operation.offset if operation.adds_offset else -0.0,
    }
    if operation.raw_below is not None and operation.raw_above is not None:
        row |= {L.BELOW: float(operation.raw_below), L.ABOVE: float(operation.raw_above)}
    return row
