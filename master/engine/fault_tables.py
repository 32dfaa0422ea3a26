"""The tables of faults, and of nodes that can be off a bus (`cosim.can.wire.tables`), made from a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.wire import tables as T
from ...cosim.clock import picoseconds
from ...cosim.plan.nodes import node_of
from ...cosim.plan.plan import FaultPlan, MessagePlan
from ...cosim.system.fault_spec import (
    Babble,
    BusOff,
    Corrupt,
    Delay,
    Fault,
    FrameFault,
    Freeze,
    Lose,
    Silence,
)

Arrays = dict[str, NDArray[Any]]
"""Tables by the names of `Wire`."""


def nodes_of(plans: Sequence[MessagePlan]) -> list[tuple[str, str]]:
    """Return bus and name of each node that sends one of these messages, in the order of their table."""
    return list(dict.fromkeys((plan.bus, node_of(plan)) for plan in plans))


def add_faults(made: Arrays, plans: Sequence[MessagePlan], faults: Sequence[FaultPlan]) -> None:
    """Add the faults of the scenario to the tables of messages, buses and nodes, which stand already.

    Those that take nodes off a bus stand in the order of their times.
    """
    buses, nodes = list(dict.fromkeys(plan.bus for plan in plans)), nodes_of(plans)
    keys = {(plan.bus, plan.message.name): plan.message.priority for plan in plans}
    made["faults"] = np.zeros((max(1, len(faults)), T.FAULT_WIDTH), dtype=np.int64)
    made["odds"] = np.ones(max(1, len(faults)))
    made["state"][T.FAULTS] = len(faults)
    numbers = numbers_of(faults)
    for row, i in enumerate(in_order(faults)):
        found = faults[i]
        bus = buses.index(found.bus)
        columns = {
            T.FAULT_BUS: bus,
            T.FAULT_KEY: keys.get((found.bus, found.message), -1),
            T.FAULT_NODE: nodes.index((found.bus, found.node)) if found.node else -1,
            T.SINCE_TIME: found.since,
            T.UNTIL_TIME: found.until,
            T.LEFT: -1,
            T.EACH: 1,
            T.FAULT_NUMBER: numbers[i],
        }
        for column, value in (columns | _columns(found.fault)).items():
            made["faults"][row, column] = value
        match found.fault:
            case BusOff():
                made["buses"][bus, T.STRIKES] += 1
            case Babble():
                made["buses"][bus, T.TO_BABBLE] += 1
                own = [(plan.bus, plan.message.name) for plan in plans].index((found.bus, found.message))
                made["messages"][own, T.BABBLES] = row + 1
            case _:
                made["odds"][row] = found.fault.probability


def in_order(faults: Sequence[FaultPlan]) -> list[int]:
    """Return the places of faults in the order of their rows."""
    return sorted(range(len(faults)), key=lambda i: faults[i].since)


def numbers_of(faults: Sequence[FaultPlan]) -> list[int]:
    """Return the number by which each fault draws: no two of one action that can hit one message share it.

    They count those of one action on one message, or on one node, which is odd, in the order of the file: a
    fault more changes no draw of those on others. The loss of a variation has the first number of its
    message, in a scenario with such faults or without.
    """
    targets = [(found.fault.action, found.bus, found.message, found.node, found.varied) for found in faults]
    return [
        targets[:i].count(target) + _varies(found) << 1 | bool(found.node)
        for i, (target, found) in enumerate(zip(targets, faults, strict=True))
    ]


def _varies(found: FaultPlan) -> bool:
    """Return True for a fault of the scenario of which a variation has one too, which draws first."""
    return isinstance(found.fault, Lose) and bool(found.message) and not found.varied


def hits_of(made: Arrays, faults: Sequence[FaultPlan]) -> dict[int, int]:
    """Return the number of frames that each fault hit, by its place in `faults`."""
    return {i: int(made["faults"][row, T.HITS]) for row, i in enumerate(in_order(faults))}


def _columns(fault: Fault) -> dict[int, Any]:
    """Return what a fault does, by the columns of its row."""
    match fault:
        case Lose():
            return _frames(fault) | {T.FAULT_KIND: T.LOSE}
        case Silence():
            return _frames(fault) | {T.FAULT_KIND: T.SILENCE}
        case Corrupt():
            return _frames(fault) | {T.FAULT_KIND: T.CORRUPT, T.BYTE: fault.byte, T.MASK: fault.mask}
        case Freeze():
            return _frames(fault) | {T.FAULT_KIND: T.FREEZE, T.COUNTER_TOO: fault.counter == "frozen"}
        case Delay():
            return _frames(fault) | {T.FAULT_KIND: T.LATE, T.AMOUNT: picoseconds(fault.by)}
        case BusOff():
            return {T.FAULT_KIND: T.BUS_OFF}
        case Babble():
            return {T.FAULT_KIND: T.BABBLE, T.AMOUNT: min(picoseconds(fault.period or 0.0), 2**62)}
        case _:
            assert_never(fault)


def _frames(fault: FrameFault) -> dict[int, Any]:
    left = -1 if fault.count is None else fault.count
    return {T.LEFT: left, T.EACH: fault.every, T.FAULT_SEED: fault.seed}


def owner_of(slot: int, nodes: Sequence[tuple[str, str]], receiving: Mapping[int, tuple[str, str]]) -> int:
    """Return the row of nodes of a mailbox whose node can be off its bus; -1: it cannot."""
    node = receiving.get(slot)
    return nodes.index(node) if node in nodes else -1
