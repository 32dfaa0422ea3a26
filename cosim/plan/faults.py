"""Faults on buses, from a scenario to the messages that they hit."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Mapping, Sequence

from ..can.bus_settings import BusVariation
from ..can.database import Message
from ..can.framing import Framing, check_quantized
from ..clock import picoseconds
from ..errors import ConfigError, nearest
from ..system.fault_spec import Babble, BusOff, Corrupt, Delay, Fault, Freeze, Lose, target_of
from ..system.scenario import Scenario
from ..system.system import System
from .idle_faults import idle_faults
from .nodes import hits, node_of, receiving_nodes
from .plan import FaultPlan, MessagePlan, Plan

FOREVER = 2**62
"""The end [ps] of a fault without a duration; no time is farther."""
_ALONE = (Freeze, Delay, BusOff, Babble)  # two of them at once contradict each other


def with_faults(plan: Plan, system: System, scenario: Scenario, varied: BusVariation | None = None) -> Plan:
    """Return the plan with the faults of a scenario: messages that one hits are sent as frames.

    A variation with a `loss` has a fault for each message that loses its frames.
    Raises ConfigError, which names the fault, where there is no message or node that it could hit. In an
    ideal run there is no bus, and no fault on one: it has a warning.
    """
    if plan.ideal:
        return dataclasses.replace(plan, warnings=(*plan.warnings, *_without_bus(scenario)))
    losses = _losses(plan, varied) if varied is not None and varied.loss else []
    faults = planned(scenario.file.faults, plan.messages, plan.clock.start, str(scenario.path))
    faults += tuple(
        dataclasses.replace(loss, varied=True)
        for loss in planned(losses, plan.messages, plan.clock.start, "bus variation: loss")
    )
    messages = framed(plan.messages, faults)
    given = faults[: len(scenario.file.faults)]
    struck = {fault.bus for fault in faults if isinstance(fault.fault, BusOff)}
    return dataclasses.replace(
        plan,
        messages=messages,
        warnings=(*plan.warnings, *idle_faults(given, messages, plan.clock, str(scenario.path))),
        faults=faults,
        babblers=babblers(faults, messages),
        receiving_nodes=receiving_nodes(messages, plan.inputs, system, struck),
    )


def _losses(plan: Plan, varied: BusVariation) -> list[Fault]:
    """Return a fault for each message of a plan by which its frames are lost with a probability.

    The seed is that of its bus, to which a variation has added its own.
    """
    seeds = {f"{message.bus}.{message.message.name}": message.settings.seed for message in plan.messages}
    loss, start = float(varied.loss), plan.clock.start
    return [
        Lose(action="lose", time=start, message=name, probability=loss, seed=seed)
        for name, seed in seeds.items()
    ]


def planned(
    faults: Sequence[Fault], messages: Sequence[MessagePlan], start: float, path: str
) -> tuple[FaultPlan, ...]:
    """Return the faults of the file `path` in a run that begins at `start` [s].

    Raises ConfigError as `with_faults` does.
    """
    found = tuple(
        _planned(fault, number, messages, start, f"{path}: fault {number}")
        for number, fault in enumerate(faults, 1)
    )
    _check_overlaps(found, messages, path)
    return found


def _without_bus(scenario: Scenario) -> list[str]:
    """Return a warning where an ideal run, which has no buses, leaves faults on them out."""
    count = len(scenario.file.faults)
    if not count:
        return []
    them = "its fault on a bus is" if count == 1 else f"its {count} faults on buses are"
    return [f"{scenario.path}: the run is ideal, without buses: {them} left out"]


def _planned(
    fault: Fault, number: int, messages: Sequence[MessagePlan], start: float, place: str
) -> FaultPlan:
    since = min(max(picoseconds(fault.time - start), -FOREVER), FOREVER)
    until = FOREVER if fault.duration is None else min(since + picoseconds(fault.duration), FOREVER)
    bus, _, name = target_of(fault).partition(".")
    message = None if isinstance(fault, BusOff | Babble) else fault.message
    node = fault.node
    found = FaultPlan(fault, bus, name if message else "", name if node else "", since, until)
    if isinstance(fault, Babble):
        own = f"fault_{number}_0x{fault.id:X}"  # of its frames
        found = dataclasses.replace(found, message=own, since=max(0, since))
    _check_target(fault, message, messages, place)
    check_quantized(
        next(m.settings for m in messages if m.bus == bus), f"{place}: buses.{bus}", "a fault hits frames"
    )
    if isinstance(fault, Delay):
        _check_sent(found, messages, place)
    if isinstance(fault, Corrupt):
        _check_byte(fault, found, messages, place)
    if isinstance(fault, Babble):
        _check_babble(fault, found, messages, place)
    return found


def _check_target(fault: Fault, message: str | None, messages: Sequence[MessagePlan], place: str) -> None:
    """Raise ConfigError where nothing is sent by what a fault names."""
    target = target_of(fault)
    key = "message" if message else "node" if fault.node else "bus"
    known = {
        {"message": f"{m.bus}.{m.message.name}", "node": f"{m.bus}.{node_of(m)}", "bus": m.bus}[key]
        for m in messages
    }
    if target not in known:
        by = "on" if key == "bus" else "by"
        rule = "a fault hits what is sent"
        if isinstance(fault, BusOff):
            rule = (
                "a node that sends nothing has no errors of its own that take it off the bus; nodes that send"
            )
        there = f"{rule}: {', '.join(sorted(known))}" if known else "no bus carries anything"
        raise ConfigError(f"{place}.{key}: nothing is sent {by} '{target}'{nearest(target, known)}; {there}")


def _check_sent(found: FaultPlan, messages: Sequence[MessagePlan], place: str) -> None:
    for message in messages:
        if message.replayed and hits(found, message):
            raise ConfigError(
                f"{place}.action: frames of {message.bus}.{message.message.name} come from a log, at its "
                "times: `delay` acts on what a unit sends"
            )


def _check_byte(fault: Corrupt, found: FaultPlan, messages: Sequence[MessagePlan], place: str) -> None:
    for message in messages:
        if hits(found, message) and not fault.byte < message.message.length:
            raise ConfigError(
                f"{place}.byte: {message.bus}.{message.message.name} has the bytes 0 to "
                f"{message.message.length - 1}, and no byte {fault.byte}"
            )


def _check_babble(fault: Babble, found: FaultPlan, messages: Sequence[MessagePlan], place: str) -> None:
    own = [message for message in messages if message.bus == found.bus]
    if not own[0].timed:
        raise ConfigError(
            f'{place}.action: bus {found.bus} has timing = "instant": frames take no time there, so that '
            f'nobody waits for a node that babbles; give [buses.{found.bus}] timing = "frame"'
        )
    for message in own:
        if (message.message.frame_id, message.message.extended) == (fault.id, fault.extended):
            raise ConfigError(
                f"{place}.id: 0x{fault.id:X} is the identifier of {message.bus}.{message.message.name}, "
                "which is sent: two nodes with one identifier destroy each other's frames; take another one"
            )


def _check_overlaps(faults: Sequence[FaultPlan], messages: Sequence[MessagePlan], path: str) -> None:
    """Raise ConfigError where two faults at one time contradict each other."""
    for (i, one), (j, other) in itertools.combinations(enumerate(faults, 1), 2):
        if not isinstance(one.fault, _ALONE) or one.fault.action != other.fault.action:
            continue
        if max(one.since, other.since) < min(one.until, other.until) and _same(one, other, messages):
            what = f"{one.fault.action} of {target_of(one.fault)}"
            raise ConfigError(
                f"{path}: fault {j}: it overlaps fault {i}, {what}; of such faults there is one at a time"
            )


def _same(one: FaultPlan, other: FaultPlan, messages: Sequence[MessagePlan]) -> bool:
    """Return True if two faults of one action act on the same."""
    if isinstance(one.fault, Babble) and isinstance(other.fault, Babble):
        return (one.bus, one.fault.id, one.fault.extended) == (
            other.bus,
            other.fault.id,
            other.fault.extended,
        )
    return any(hits(one, message) and hits(other, message) for message in messages)


def framed(messages: Sequence[MessagePlan], faults: Sequence[FaultPlan]) -> tuple[MessagePlan, ...]:
    """Return the messages of a plan, as frames where a fault has to do with them."""
    return tuple(_hit(message, faults) for message in messages)


def _hit(message: MessagePlan, faults: Sequence[FaultPlan]) -> MessagePlan:
    """Return the message as a frame if a fault has to do with it."""
    mine = [fault for fault in faults if hits(fault, message)]
    off = any(isinstance(fault.fault, BusOff) and fault.bus == message.bus for fault in faults)
    if not (mine or off):
        return message
    late = [
        min(picoseconds(fault.fault.by), fault.until - fault.since)  # no more of them are under way at once
        for fault in mine
        if isinstance(fault.fault, Delay)
    ]
    return dataclasses.replace(_framed(message), latest=max(late, default=0))


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


def babblers(faults: Sequence[FaultPlan], messages: Sequence[MessagePlan]) -> tuple[MessagePlan, ...]:
    """Return the frames of each fault that babbles as a message without signals, which nobody samples."""
    settings = {message.bus: message.settings for message in messages}
    found = []
    for plan in faults:
        if isinstance(fault := plan.fault, Babble):
            senders = (plan.node or plan.message,)
            message = Message("", plan.message, fault.id, fault.extended, fault.length, senders=senders)
            own = settings[plan.bus]
            found.append(MessagePlan(plan.bus, message, own, (), {}, 1, 0, None, framing=Framing()))
    return tuple(found)


def described(faults: Sequence[FaultPlan], frames: Mapping[int, int]) -> list[dict[str, object]]:
    """Return what each fault is, for JSON, with the number of `frames` that it hit, by its place."""
    return [
        {"action": found.fault.action, "on": target_of(found.fault), "frames": frames.get(i, 0)}
        | found.fault.model_dump(exclude_none=True, exclude={"action", "message", "node", "bus"})
        for i, found in enumerate(faults)
    ]
