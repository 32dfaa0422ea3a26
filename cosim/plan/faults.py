"""Faults on buses, from a scenario to the messages that they hit."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from ..can.framing import Framing, check_quantized
from ..clock import Clock, picoseconds
from ..errors import ConfigError, nearest
from ..system.scenario import Fault, Scenario
from .plan import FaultPlan, MessagePlan, Plan

FOREVER = 2**62
"""The end [ps] of a fault without a duration."""


def with_faults(plan: Plan, scenario: Scenario) -> Plan:
    """Return the plan with the faults of a scenario: messages that one hits are sent as frames.

    Raises ConfigError, which names the fault, where there is no message or node that it could hit.
    """
    messages, faults = plan.messages, list[FaultPlan]()
    for number, fault in enumerate(scenario.file.faults, 1):
        place = f"{scenario.path}: fault {number}"
        found = _planned(fault, messages, plan.clock, place)
        if fault.byte is not None:
            _check_byte(fault, found, messages, place)
        faults.append(found)
    hit = tuple(_framed(m) if any(_hits(fault, m) for fault in faults) else m for m in messages)
    return dataclasses.replace(plan, messages=hit, faults=tuple(faults))


def node_of(message: MessagePlan) -> str:
    """Return the node that sends a message; where the database names none, its unit."""
    named = [sender for sender in message.message.senders if sender != "Vector__XXX"]
    return named[0] if named else next(iter(message.senders.values()), "").partition(".")[0]


def _planned(fault: Fault, messages: Sequence[MessagePlan], clock: Clock, place: str) -> FaultPlan:
    target = fault.message or fault.node or ""
    bus, _, name = target.partition(".")
    known = {f"{m.bus}.{m.message.name if fault.message else node_of(m)}" for m in messages}
    for message in messages:
        if message.bus == bus:
            check_quantized(message.settings, f"{place}: buses.{bus}", fault=True)
    if messages and target not in known:
        key = "message" if fault.message else "node"
        raise ConfigError(
            f"{place}.{key}: nothing is sent by '{target}'{nearest(target, known)}; a fault hits "
            f"what is sent: {', '.join(sorted(known))}"
        )
    since = picoseconds(fault.time - clock.start)
    until = FOREVER if fault.duration is None else since + picoseconds(fault.duration)
    return FaultPlan(
        fault, bus, name if fault.message else "", name if fault.node else "", since, min(until, FOREVER)
    )


def _check_byte(fault: Fault, found: FaultPlan, messages: Sequence[MessagePlan], place: str) -> None:
    for message in messages:
        if _hits(found, message) and not (fault.byte or 0) < message.message.length:
            raise ConfigError(
                f"{place}.byte: {message.bus}.{message.message.name} has the bytes 0 to "
                f"{message.message.length - 1}, and no byte {fault.byte}"
            )


def _hits(fault: FaultPlan, message: MessagePlan) -> bool:
    name = fault.message == message.message.name if fault.message else fault.node == node_of(message)
    return message.bus == fault.bus and name


def _framed(plan: MessagePlan) -> MessagePlan:
    """Return the message sent as frames, which end in the mailboxes, also where there is a delay."""
    if plan.framing is not None:
        return plan
    mailbox = dict(plan.arrivals)
    routes = tuple(
        dataclasses.replace(route, sinks=tuple((mailbox.get(slot, slot), map_) for slot, map_ in route.sinks))
        for route in plan.routes
    )
    return dataclasses.replace(plan, routes=routes, arrivals=(), framing=Framing())
