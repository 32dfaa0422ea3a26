"""The tables of the frame path (`cosim.can.wire.tables`), made from a plan."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.channel import SignalRoute
from ...cosim.can.database import Signal
from ...cosim.can.message_settings import SendType
from ...cosim.can.quantization import SignalOperation, decode
from ...cosim.can.timing.lengths import bit_time
from ...cosim.can.unfilled import raw_values
from ...cosim.can.wire import tables as T
from ...cosim.can.wire.buffers import NEVER
from ...cosim.can.wire.payload import place_of, put, words
from ...cosim.can.wire.tables import Wire
from ...cosim.clock import picoseconds
from ...cosim.plan.nodes import node_of
from ...cosim.plan.plan import FaultPlan, MessagePlan
from .fault_tables import Arrays, add_faults, nodes_of
from .listener_tables import Rows, add_listeners
from .sender import Sender

_MOST_BITS = 1024  # no frame is longer
_LOG_ROWS = 1024  # frames that are logged between two calls of Python


def wire_arrays(
    senders: Sequence[Sender],
    memory: NDArray[np.float64],
    step: float,
    logs: bool,
    initial: Mapping[int, float] | None = None,
    faults: Sequence[FaultPlan] = (),
    receiving: Mapping[int, tuple[str, str]] | None = None,
    streams: int = 0,
) -> Arrays:
    """Return the tables of the messages of `senders`, but for `helper`; message i is that of sender i.

    They stand bus by bus, on each in the order in which they win it. `memory` is the run's, shape (size,);
    `step` [s] that of the run. `logs`: frames are logged.
    `initial` are the values of mailboxes before the first frame, by slot, `receiving` their nodes that can be
    off the bus; `streams` logs are replayed.
    """
    plans = [sender.plan for sender in senders]
    made: Arrays = {
        "messages": _table(len(plans), T.MESSAGE),
        "base": _table(len(plans), T.BYTES),
        "waiting": _table(len(plans), T.BYTES),
        "staged": _table(len(plans), T.BYTES),
        "kept": _table(len(plans), T.BYTES),
        "uses": _table(0, T.USE),
        "ids": np.zeros(max(1, 16 * len(plans)), dtype=np.int64),
        "log": _table(_LOG_ROWS, T.LOG_WIDTH),
        "replays": _table(streams * T.REPLAY_ROWS, T.LOG_WIDTH),
        "streams": _table(streams, T.STREAM_WIDTH),
        "memory": memory,
        "frame": np.zeros(T.BYTES, dtype=np.int64),
        "single": np.zeros(1, dtype=np.float32),
        "double": np.zeros(1),
        "state": np.zeros(T.STATE, dtype=np.int64),
    }
    made["single_bits"], made["double_bits"] = made["single"].view(np.int32), made["double"].view(np.int64)
    made["state"][T.STEP_TIME] = picoseconds(step)
    listeners = add_listeners(made, plans, receiving or {})
    _add_signals(made, senders, listeners)
    _add_fallback(made, plans, initial or {})
    _add_protection(made, plans, listeners)
    _add_buses(made, plans, step)
    _add_rings(made, plans)
    same = [(plan.bus, plan.message.priority) for plan in plans]
    for i, plan in enumerate(plans):
        pages = {T.PAGE: i - same.index(same[i]), T.PAGES: same.count(same[i])}
        _fill(made["messages"], i, _message_row(plan) | pages | {T.LOGGED: logs})
        made["base"][i, : plan.message.length] = list(_base(plan))
    made["waiting"][:] = made["base"]  # what babbles has no other payload
    add_faults(made, plans, faults)
    return made


def ring_of_bus(made: Arrays, bus: int) -> int:
    """Return the ring in which the frames of a bus are under way where they take time."""
    return int(made["messages"][made["buses"][bus, T.FIRST_MESSAGE], T.RING])


def _message_row(plan: MessagePlan) -> dict[int, Any]:
    message = plan.message
    return {
        T.KEY: message.priority, T.ID: message.frame_id, T.EXTENDED: message.extended, T.FD: message.fd,
        T.LENGTH: message.length, T.EVERY: plan.every, T.FIRST: plan.first,
        T.SWITCHED: message.fd and plan.settings.data_bitrate is not None,
        T.JITTER: picoseconds(plan.settings.jitter_of(message.name)),
        T.SEND_TYPE: _send_type(plan.sending.kind), T.INTERVAL: plan.sending.interval,
        T.CYCLE: plan.sending.cycle,
    }  # fmt: skip # a row


def _send_type(kind: SendType) -> int:
    """Return the code of a send type."""
    match kind:
        case "cyclic":
            return T.CYCLIC
        case "on_change":
            return T.ON_CHANGE
        case "cyclic_and_on_change":
            return T.MIXED
        case "if_active":
            return T.IF_ACTIVE
        case "on_write":
            return T.ON_WRITE
        case _:
            assert_never(kind)


def _add_buses(made: Arrays, plans: Sequence[MessagePlan], step: float) -> None:
    """Add the tables of buses and of nodes, which are the senders that the database names."""
    buses = list(dict.fromkeys(plan.bus for plan in plans))
    nodes = nodes_of(plans)
    made["buses"], made["nodes"] = _table(len(buses), T.BUS_WIDTH), _table(len(nodes), T.NODE_WIDTH)
    made["chances"] = _table(len(buses), _MOST_BITS, np.float64)
    for row, (bus, _) in enumerate(nodes):
        made["nodes"][row, T.BUS_OF] = buses.index(bus)
    for i, plan in enumerate(plans):
        _fill(made["messages"], i, {T.BUS: buses.index(plan.bus), T.NODE: nodes.index(_node(plan))})
    for row, bus in enumerate(buses):
        own = [i for i, plan in enumerate(plans) if plan.bus == bus]
        settings = plans[own[0]].settings
        # frames of a log, which may stand first, have no delay of their own: it is in their times
        timed, steps = plans[own[0]].timed, max(plans[i].delay for i in own)
        delay = picoseconds(settings.delay) if timed else steps * picoseconds(step)
        _fill(
            made["buses"], row,
            {T.DELAY: delay, T.TIMED: timed, T.FIRST_MESSAGE: own[0], T.MESSAGES: len(own),
             T.BIT: bit_time(settings.bitrate),
             T.DATA_BIT: bit_time(settings.data_bitrate or settings.bitrate),
             T.SEED: settings.seed, T.NAME: zlib.crc32(bus.encode()), T.NOISY: settings.bit_error_rate > 0.0,
             T.NEXT_QUEUED: NEVER},
        )  # fmt: skip # a row
        right = math.log1p(-settings.bit_error_rate)
        made["chances"][row] = [-math.expm1(bits * right) for bits in range(_MOST_BITS)]


def _node(plan: MessagePlan) -> tuple[str, str]:
    return plan.bus, node_of(plan)


def views(arrays: Arrays, helper: Any) -> Wire:
    """Return the tables as Python reads them fastest."""
    return Wire(**{name: array.data for name, array in arrays.items()}, helper=helper)


def _base(plan: MessagePlan) -> bytes:
    """Return the payload of signals that nothing fills, with the page's multiplexers; 0 in all others."""
    filled = {route.signal.name for route in plan.routes}
    if plan.framing is not None and plan.framing.protection is not None:
        filled |= {signal.name for signal in plan.framing.protection.signals}
    frame = bytearray(plan.message.length)
    for name, raw in raw_values(plan.message).items():
        if name not in filled:
            signal = plan.message.signals[name]
            start, little = place_of(signal)
            put(frame, little, start, signal.length, *words(raw_bits(signal, raw)))
    return bytes(frame)


def raw_bits(signal: Signal, raw: float | int) -> int:
    """Return a raw value of a signal as a number that has its bits; negative too."""
    if not signal.is_float:
        return int(raw)
    return int.from_bytes(struct.pack("<f" if signal.length == 32 else "<d", raw), "little")


def _add_fallback(made: Arrays, plans: Sequence[MessagePlan], initial: Mapping[int, float]) -> None:
    """Add what receivers get after a timeout, for each row of sinks; NaN: the last value."""
    found: list[float] = []
    for plan in plans:
        choice = plan.settings.of_message(plan.message.name).on_timeout
        for route in plan.routes:
            code = route.signal.not_available
            for slot, map_ in route.sinks:
                value = math.nan
                if choice == "initial":
                    value = initial.get(slot, math.nan)
                elif choice == "sna" and code is not None:
                    value = map_(decode(route.signal, code))
                found.append(value)
    made["fallback"] = np.array(found or [math.nan])


def _add_protection(made: Arrays, plans: Sequence[MessagePlan], listeners: Sequence[Rows]) -> None:
    """Add the protection of messages, their timeouts, and the inputs that receive their status."""
    statuses: list[int] = []
    for i, plan in enumerate(plans):
        if plan.framing is None:
            continue
        own, slots = plan.settings.of_message(plan.message.name), plan.framing.status
        row: dict[int, Any] = {T.TIMEOUT: own.timeout or 0}
        row |= {T.FIRST_STATUS: len(statuses) // 2, T.STATUSES: len(slots)}
        for slot in slots:
            statuses += [slot, listeners[i][slot]]
        if (protection := plan.framing.protection) is not None:
            made["ids"][16 * i : 16 * i + len(protection.ids)] = protection.ids
            start, little = place_of(protection.crc)
            row |= {
                T.PROFILE: protection.profile, T.CRC_AT: protection.crc.start // 8,
                T.CHECK_START: start, T.CHECK_LITTLE: little, T.CHECK_BITS: protection.crc.length,
                T.COVERED: plan.message.own_length or plan.message.length,
                T.MAX_DELTA: protection.max_delta,
            }  # fmt: skip # a row
            if protection.counter is not None:
                row[T.COUNTER_START], row[T.COUNTER_LITTLE] = place_of(protection.counter)
                row[T.COUNTER_BITS] = protection.counter.length
            if protection.nibble is not None:
                row[T.NIBBLE_START], row[T.NIBBLE_LITTLE] = place_of(protection.nibble)
        _fill(made["messages"], i, row)
    made["statuses"] = np.array(statuses or [0, -1], dtype=np.int64)


def _add_signals(made: Arrays, senders: Sequence[Sender], listeners: Sequence[Rows]) -> None:
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
            sinks += [{T.SLOT: slot, T.LISTENER: listeners[i][slot]} for slot, _ in route.sinks]
            # adding an offset of 0.0 would turn -0.0 into 0.0
            maps += [{T.FACTOR: a.scale, T.ADDEND: a.offset or -0.0} for _, a in route.sinks]
    made["signals"], made["reals"] = _table(len(signals), T.SIGNAL), _table(len(signals), T.REAL, np.float64)
    made["sinks"], made["maps"] = _table(len(sinks), T.SINK), _table(len(sinks), T.MAP, np.float64)
    for name, rows in (("signals", signals), ("reals", reals), ("sinks", sinks), ("maps", maps)):
        for i, row in enumerate(rows):
            _fill(made[name], i, row)


def _signal_row(route: SignalRoute, operation: SignalOperation, first_sink: int) -> dict[int, int]:
    start, little = place_of(operation.signal)
    low, high = words(_inactive(operation.signal))
    return {
        T.SOURCE: route.source, T.KIND: _kind(operation), T.SATURATES: operation.raw_below is not None,
        T.FIRST_SINK: first_sink, T.SINKS: len(route.sinks), T.BITS: operation.signal.length,
        T.START: start, T.LITTLE: little, T.SIGNED: operation.signal.signed,
        T.IDLE_LOW: low, T.IDLE_HIGH: high,
    }  # fmt: skip # a row


def _inactive(signal: Signal) -> int:
    """Return the bits of the raw value at which a signal is not active."""
    raw = signal.start_raw if signal.inactive_raw is None else signal.inactive_raw
    if not signal.is_float:
        return int(raw)
    with np.errstate(over="ignore"):  # beyond the greatest it is infinite, which no value that is sent is
        value = np.array(raw, dtype=np.float32 if signal.length == 32 else np.float64)
    return int(value.view(np.int32 if signal.length == 32 else np.int64))


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
    """Return the code of the steps from a value to the raw value; EXACT: Python does them."""
    return T.EXACT if operation.kind == "exact" else rounding_code(operation)


def rounding_code(operation: SignalOperation) -> int:
    """Return the code of how a raw value is rounded, also of one that no double holds."""
    match operation.kind:
        case "float32":
            return T.FLOAT32
        case "float64":
            return T.FLOAT64
        case "integer" | "exact":
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
    """Add the rings of frames under way: of each bus on which they take time, each message with a delay."""
    rings: list[dict[int, int]] = []
    rows = 0
    places: dict[str, int] = {}
    for i, plan in enumerate(plans):
        bus = made["buses"][made["messages"][i, T.BUS]]
        if plan.timed and plan.bus in places:
            ring = places[plan.bus]
        elif plan.timed or plan.delay or plan.latest:
            ring = places[plan.bus] = len(rings)
            late = -(-plan.latest // int(made["state"][T.STEP_TIME]))
            waits = (plan.delay + late) // plan.every + 1 + (late > 0)
            room = _under_way(made, bus, plans) if plan.timed else waits
            rings.append({T.START_ROW: rows, T.ROWS: room})
            rows += room
        else:
            ring = -1
        _fill(made["messages"], i, {T.RING: ring})
    made["rings"], made["flights"] = _table(len(rings), T.RING_WIDTH), _table(rows, T.FLIGHT)
    for i, row in enumerate(rings):
        _fill(made["rings"], i, row)


def _under_way(made: Arrays, bus: NDArray[np.int64], plans: Sequence[MessagePlan]) -> int:
    """Return how many frames can be under way on a bus: those that end in a step, and wait for its delay.

    One ends at each shortest frame's time at most, and each message is queued once a cycle, and once before.
    """
    step = int(made["state"][T.STEP_TIME])
    span = step + int(bus[T.DELAY])
    first = int(bus[T.FIRST_MESSAGE])
    own = plans[first : first + int(bus[T.MESSAGES])]
    return sum((span + plan.latest) // (plan.every * step) + 3 for plan in own)


def _table(rows: int, width: int, kind: Any = np.int64) -> NDArray[Any]:
    """Return a table of zeros; it has at least one row, so that it has an address."""
    return np.zeros((max(1, rows), width), dtype=kind)


def _fill(table: NDArray[Any], i: int, row: dict[int, Any]) -> None:
    for column, value in row.items():
        table[i, column] = value
