"""The tables of the frame path (`cosim.can.wire.tables`), made from a plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.channel import SignalRoute
from ...cosim.can.database import Message, Signal
from ...cosim.can.frames import encoder
from ...cosim.can.quantization import SignalOperation
from ...cosim.can.timing.arbitration import arbitration_key
from ...cosim.can.wire import tables as T
from ...cosim.can.wire.tables import Wire
from ...cosim.clock import picoseconds
from ...cosim.plan.plan import MessagePlan
from .sender import Sender

Arrays = dict[str, NDArray[Any]]
"""Tables by the names of `Wire`; `helper` is not among them."""

_LOG_ROWS = 1024  # frames that are logged between two calls of Python


def wire_arrays(senders: Sequence[Sender], memory: NDArray[np.float64], step: float, logs: bool) -> Arrays:
    """Return the tables of the messages of `senders`; message i is that of sender i.

    `memory` is the run's, shape (size,); `step` [s] that of the run. `logs`: frames are logged.
    """
    plans = [sender.plan for sender in senders]
    buses = list(dict.fromkeys(plan.bus for plan in plans))
    made: Arrays = {
        "messages": _table(len(plans), T.MESSAGE),
        "base": _table(len(plans), T.BYTES),
        "waiting": _table(len(plans), T.BYTES),
        "buses": _table(len(buses), T.BUS_WIDTH),
        "log": _table(_LOG_ROWS, T.LOG_WIDTH),
        "memory": memory,
        "frame": np.zeros(T.BYTES, dtype=np.int64),
        "single": np.zeros(1, dtype=np.float32),
        "double": np.zeros(1),
        "state": np.zeros(T.STATE, dtype=np.int64),
    }
    made["single_bits"], made["double_bits"] = made["single"].view(np.int32), made["double"].view(np.int64)
    made["state"][T.STEP_TIME] = picoseconds(step)
    for plan in plans:
        made["buses"][buses.index(plan.bus), T.DELAY] = plan.delay * picoseconds(step)
    _add_signals(made, senders)
    _add_rings(made, plans)
    for i, plan in enumerate(plans):
        _fill(
            made["messages"], i,
            {T.BUS: buses.index(plan.bus),
             T.KEY: arbitration_key(plan.message.frame_id, plan.message.extended),
             T.LENGTH: plan.message.length, T.EXTENDED: plan.message.extended, T.FD: plan.message.fd,
             T.EVERY: plan.every, T.FIRST: plan.first, T.LOGGED: logs},
        )  # fmt: skip # a row
        made["base"][i, : plan.message.length] = list(_base(plan.message, plan.routes))
    return made


def views(arrays: Arrays, helper: Any) -> Wire:
    """Return the tables as Python reads them fastest."""
    return Wire(**{name: array.data for name, array in arrays.items()}, helper=helper)


def _base(message: Message, routes: Sequence[SignalRoute]) -> bytes:
    """Return the payload with the start values of signals that no connection feeds, and 0 in all others."""
    start = {signal.name: signal.start_raw for signal in message.signals.values()}
    return encoder(message)(start | {route.signal.name: 0 for route in routes})


def _add_signals(made: Arrays, senders: Sequence[Sender]) -> None:
    """Add the tables of signals and their receivers, and where those of each message begin."""
    signals: list[dict[int, Any]] = []
    reals: list[dict[int, Any]] = []
    sinks: list[dict[int, Any]] = []
    maps: list[dict[int, Any]] = []
    for i, sender in enumerate(senders):
        _fill(made["messages"], i, {T.FIRST_SIGNAL: len(signals), T.SIGNALS: len(sender.plan.routes)})
        for route, operation in zip(sender.plan.routes, sender.channel.operations, strict=True):
            signals.append(_signal_row(route, operation, len(sinks)))
            reals.append(_real_row(route, operation))
            sinks += [{T.SLOT: slot} for slot, _ in route.sinks]
            # adding an offset of 0.0 would turn -0.0 into 0.0
            maps += [{T.FACTOR: a.scale, T.ADDEND: a.offset or -0.0} for _, a in route.sinks]
    made["signals"], made["reals"] = _table(len(signals), T.SIGNAL), _table(len(signals), T.REAL, np.float64)
    made["sinks"], made["maps"] = _table(len(sinks), T.SINK), _table(len(sinks), T.MAP, np.float64)
    for name, rows in (("signals", signals), ("reals", reals), ("sinks", sinks), ("maps", maps)):
        for i, row in enumerate(rows):
            _fill(made[name], i, row)


def _signal_row(route: SignalRoute, operation: SignalOperation, first_sink: int) -> dict[int, int]:
    start, little = place_of(operation.signal)
    return {
        T.SOURCE: route.source, T.KIND: _kind(operation), T.SATURATES: operation.raw_below is not None,
        T.FIRST_SINK: first_sink, T.SINKS: len(route.sinks), T.BITS: operation.signal.length,
        T.START: start, T.LITTLE: little, T.SIGNED: operation.signal.signed,
    }  # fmt: skip # a row


def _real_row(route: SignalRoute, operation: SignalOperation) -> dict[int, float]:
    row = {
        T.IN_SCALE: route.to_bus.scale, T.IN_ADD: route.to_bus.offset or -0.0,
        T.LEAST: operation.low, T.GREATEST: operation.high,
        T.SCALE: operation.scale, T.OFFSET: operation.offset,
        T.OUT_ADD: operation.offset if operation.adds_offset else -0.0,
    }  # fmt: skip # a row
    if operation.raw_below is not None and operation.raw_above is not None:
        row |= {T.BELOW: float(operation.raw_below), T.ABOVE: float(operation.raw_above)}
    return row


def _kind(operation: SignalOperation) -> int:
    """Return the code of the steps from a value to the raw value."""
    match operation.kind:
        case "float32":
            return T.FLOAT32
        case "float64":
            return T.FLOAT64
        case "exact":
            return T.EXACT
        case "integer":
            pass
        case _:
            assert_never(operation.kind)
    match operation.settings.rounding:
        case "nearest":
            return T.NEAREST
        case "half_even":
            return T.HALF_EVEN
        case "truncate":
            return T.TRUNCATE
        case _:
            assert_never(operation.settings.rounding)


def _add_rings(made: Arrays, plans: Sequence[MessagePlan]) -> None:
    """Add the rings of frames under way: one for each message whose bus has a delay."""
    rings: list[dict[int, int]] = []
    rows = 0
    for i, plan in enumerate(plans):
        _fill(made["messages"], i, {T.RING: len(rings) if plan.delay else -1})
        if plan.delay:
            rings.append({T.START_ROW: rows, T.ROWS: plan.delay // plan.every + 1})
            rows += plan.delay // plan.every + 1
    made["rings"], made["flights"] = _table(len(rings), T.RING_WIDTH), _table(rows, T.FLIGHT)
    for i, row in enumerate(rings):
        _fill(made["rings"], i, row)


def _table(rows: int, width: int, kind: Any = np.int64) -> NDArray[Any]:
    """Return a table of zeros; it has at least one row, so that it has an address."""
    return np.zeros((max(1, rows), width), dtype=kind)


def _fill(table: NDArray[Any], i: int, row: dict[int, Any]) -> None:
    for column, value in row.items():
        table[i, column] = value


def place_of(signal: Signal) -> tuple[int, int]:
    """Return the place of a signal in the frame, as `wire.payload` counts it, and 1 where it is Intel's."""
    start = signal.start if signal.little_endian else 8 * (signal.start // 8) + 7 - signal.start % 8
    return start, int(signal.little_endian)
