"""Nodes that are off the bus: they send nothing and hear nothing, by a fault or by their own errors.

A node is back when it has heard 128 times 11 recessive bits in a row: an idle bus has one such row in 11
bits, the end of a frame with the space behind it is one more.
"""

from __future__ import annotations

from . import tables as T
from .tables import Wire

_ROWS = 128
_ROW = 11  # bits: delimiter, end of frame and interframe space of a frame are as many


def is_off(w: Wire, node: int, time: int) -> bool:
    """Return True if a node is off the bus at a time, which is not before it was so the last time."""
    return bool(w.nodes[node, T.OFF_SINCE] <= time < w.nodes[node, T.OFF_UNTIL])


def strike(w: Wire, bus: int, now: int) -> int:
    """Take nodes off a bus by the faults that begin by now; return their number."""
    f, count = w.faults, 0
    for row in range(w.state[T.FAULTS]):
        mine = f[row, T.FAULT_KIND] == T.BUS_OFF and f[row, T.FAULT_BUS] == bus
        if mine and f[row, T.MET] == 0 and f[row, T.SINCE_TIME] <= now:
            f[row, T.MET] = 1
            count += 1
            switch_off(w, bus, f[row, T.FAULT_NODE], f[row, T.SINCE_TIME], f[row, T.UNTIL_TIME])
            w.nodes[f[row, T.FAULT_NODE], T.OFF_BY] = row + 1
    w.buses[bus, T.STRIKES] -= count
    return count


def switch_off(w: Wire, bus: int, node: int, since: int, until: int) -> None:
    """Let a node be off the bus, and begin to recover at a time."""
    n, b = w.nodes, w.buses
    if not is_off(w, node, since):
        n[node, T.OFF_SINCE] = since
    if n[node, T.RECOVERY] == 0:
        b[bus, T.OFF_NODES] += 1
    n[node, T.BUS_OFFS] += 1
    n[node, T.ERROR_COUNT] = n[node, T.RECEIVE_COUNT] = n[node, T.OFF_BY] = 0
    n[node, T.RECOVERY] = _ROWS
    n[node, T.HEARD_AT] = max(until, b[bus, T.FREE_AT] - _ROW * b[bus, T.BIT])
    set_back(w, bus, node)


def set_back(w: Wire, bus: int, node: int) -> None:
    """Set the time at which a node is back if the bus stays idle until then."""
    n = w.nodes
    n[node, T.OFF_UNTIL] = n[node, T.HEARD_AT] + n[node, T.RECOVERY] * _ROW * w.buses[bus, T.BIT]
    n[node, T.READY_AT] = n[node, T.OFF_UNTIL]


def recover(w: Wire, bus: int, now: int) -> None:
    """Let the nodes that are off a bus hear a frame that has it from now on until it is free."""
    n, row = w.nodes, _ROW * w.buses[bus, T.BIT]
    for node in range(len(n)):
        if n[node, T.BUS_OF] != bus or n[node, T.RECOVERY] == 0:
            continue
        if n[node, T.OFF_UNTIL] <= now:
            n[node, T.RECOVERY] = 0
            w.buses[bus, T.OFF_NODES] -= 1
            continue
        n[node, T.RECOVERY] -= max(0, now - n[node, T.HEARD_AT]) // row
        n[node, T.HEARD_AT] = max(n[node, T.HEARD_AT], w.buses[bus, T.FREE_AT] - row)
        set_back(w, bus, node)


def hear(w: Wire, i: int, time: int) -> int:
    """Let those receivers of the frame at hand, of message i, take it that are on the bus at a time.

    Return their number; a frame that others do not hear is counted, and the faults behind it.
    """
    m, on, first = w.messages, 0, w.messages[i, T.FIRST_LISTENER]
    for a in range(first, first + m[i, T.LISTENERS]):
        owner = w.listeners[a, T.OWNER]
        w.listeners[a, T.TAKES] = 1
        if owner >= 0 and is_off(w, owner, time):
            w.listeners[a, T.TAKES] = 0
            note_hit(w, owner)
        on += w.listeners[a, T.TAKES]
    if on < m[i, T.LISTENERS]:
        m[i, T.UNHEARD] += 1
    return on


def note_hit(w: Wire, node: int) -> None:
    """Count a frame that a node could not send or hear at the fault that has taken it off the bus, if any."""
    if w.nodes[node, T.OFF_BY] > 0:
        w.faults[w.nodes[node, T.OFF_BY] - 1, T.HITS] += 1
