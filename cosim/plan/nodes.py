"""The nodes of a bus by its messages: which one sends a message, and behind which one an input is."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from ..system.fault_spec import Babble
from ..system.system import System
from .plan import FaultPlan, InputPlan, MessagePlan


def node_of(message: MessagePlan) -> str:
    """Return the node that sends a message; where the database names none, its unit."""
    named = message.message.senders
    return named[0] if named else next(iter(message.senders.values()), "").partition(".")[0]


def receiving_nodes(
    messages: Sequence[MessagePlan], inputs: Mapping[str, InputPlan], system: System, struck: Collection[str]
) -> dict[int, tuple[str, str]]:
    """Return bus and node behind each mailbox that receives frames of a bus whose nodes can be off it.

    These are the buses `struck` by a fault and those with wrong bits. A unit is the node that its `nodes`
    name, or else that sends what the unit sends; of several the one that the database names as receiver.
    A unit that is none of them always receives.
    """
    units = {plan.mailbox: name.partition(".")[0] for name, plan in inputs.items()}
    nodes: dict[tuple[str, str], set[str]] = {}
    for message in messages:
        for sender in message.senders.values():
            unit = sender.partition(".")[0]
            nodes.setdefault((message.bus, unit), set()).update(
                system.file.units[unit].nodes or [node_of(message)]
            )
    found: dict[int, tuple[str, str]] = {}
    for message in messages:
        noisy = message.timed and message.settings.bit_error_rate > 0.0
        if message.framing is None or not (noisy or message.bus in struck):
            continue
        ends = [(slot, r.signal.receivers) for r in message.routes for slot, _ in r.sinks]
        named = [node for signal in message.message.signals.values() for node in signal.receivers]
        ends += [(slot, tuple(named)) for slot in message.framing.status]
        for slot, receivers in ends:
            unit = units.get(slot, "")
            own = nodes.get((message.bus, unit), set(system.file.units[unit].nodes if unit else ()))
            chosen = own if len(own) == 1 else own & set(receivers)
            if len(chosen) == 1:
                found[slot] = message.bus, next(iter(chosen))
    return found


def hits(fault: FaultPlan, message: MessagePlan) -> bool:
    """Return True if a fault acts on frames of a message, as its sender sends them."""
    if isinstance(fault.fault, Babble):
        return False
    name = fault.message == message.message.name if fault.message else fault.node == node_of(message)
    return message.bus == fault.bus and name
