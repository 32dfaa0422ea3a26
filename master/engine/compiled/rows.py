"""Rows of the kernel's tables that come from the plan: times of a unit, maps, signals."""

from __future__ import annotations

from ....cosim.can.channel import SignalRoute
from ....cosim.can.quantization import SignalOperation
from ....cosim.plan.turns import TurnTimes
from ....cosim.units.measure import Affine
from ...machine import tables as L
from ...machine.rows import Cells
from ..wire_tables import rounding_code


def times_row(times: TurnTimes) -> Cells:
    """Return the columns of UNITS that say when the unit steps."""
    last = times.last or times.steps(times.first)  # without a last turn these are not looked at
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
        L.MODE: rounding_code(operation),
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
