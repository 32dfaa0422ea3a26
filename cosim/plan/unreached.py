"""Sentences on what stands outside the time of a run: events, stimuli and messages.

At the stop time no unit steps any more, so that what happens there has no effect either.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..clock import Clock, point
from ..csv_text import as_date
from ..system.fault_spec import target_of
from ..system.scenario import Event, Scenario, StimulusEntry
from ..system.stimuli import moves_between
from .plan import Drive, InputPlan, MessagePlan
from .turns import turn_from

_MOST = 3  # events, and faults, that are told one by one


def out_of_time(scenario: Scenario, drives: Sequence[Drive], clock: Clock) -> list[str]:
    """Return a sentence for each event before the start time, each table that ends there, and dates.

    `drives` are those of the scenario's stimuli, in their order.
    """
    start = f"the start time {_seconds(clock.start)}"
    said = [
        f"{place} is before {start}, at which it acts"
        for place, event in _events(scenario)
        if clock.step_at(event.time) < 0
    ]
    return (
        _first(said)
        + [
            f"{place} ends at {_seconds(end)}, before {start}: its last value holds throughout"
            for place, (_, end) in _stimuli(scenario, drives)
            if end < clock.start
        ]
        + _dates(scenario, drives, clock)
    )


def _dates(scenario: Scenario, drives: Sequence[Drive], clock: Clock) -> list[str]:
    """Return a sentence for each stimulus whose times look like dates, which the run does not reach."""
    span = f"from {_seconds(clock.start)} to {_seconds(clock.stop)}"
    return [
        f"{place} begins at {_seconds(begin)}, which looks like {date}: the run, {span}, has its first value "
        "throughout; write times from the start of the run on, or set start_time"
        for place, (begin, _) in _stimuli(scenario, drives)
        if begin >= clock.stop and (date := as_date(begin))
    ]


def after_stop(
    scenario: Scenario,
    drives: Sequence[Drive],
    messages: Sequence[MessagePlan],
    inputs: Mapping[str, InputPlan],
    turns: Mapping[str, tuple[int, int]],
    clock: Clock,
) -> list[str]:
    """Return a sentence for each event, stimulus and message that comes too late for any effect.

    `drives` are those of the scenario's stimuli, in their order; `turns` are the units' periods
    and offsets in communication steps: one takes its inputs at its offset, and then each period.
    """
    stop = f"the stop time {_seconds(clock.stop)}"
    events = []
    for place, event in _events(scenario):
        unit = event.variable.partition(".")[0]
        if (turn := turn_from(clock.step_at(event.time), *turns[unit])) >= clock.steps:
            at = point(turn, clock.start, clock.step)
            late = "" if turns[unit][0] == 1 else f"{unit} has its next turn at {_seconds(at)}, and "
            events.append(f"{place} never acts: {late}{stop} comes before it has an effect")
    return [
        *_first(events),
        *_first(_late_faults(scenario, clock), "faults"),
        *(
            f"{place} begins at {_seconds(begin)}, not before {stop}: it stays at its first value"
            for place, (begin, _) in _stimuli(scenario, drives)
            if begin >= clock.stop and not as_date(begin)
        ),
        *(said for each in messages if (said := _message(each, messages, inputs, clock, stop))),
    ]


def _message(
    message: MessagePlan,
    messages: Sequence[MessagePlan],
    inputs: Mapping[str, InputPlan],
    clock: Clock,
    stop: str,
) -> str:
    """Return the sentence on a message that never arrives; "" for one that does, or that nobody receives."""
    if message.first + message.delay < clock.steps:
        return ""
    reached = {m for each in messages if each.first + each.delay < clock.steps for m in _mailboxes(each)}
    ends = _mailboxes(message) - reached  # in another page of the message
    receivers = [name for name, plan in inputs.items() if plan.mailbox in ends]
    if not receivers:
        return ""
    at = _seconds(point(message.first + message.delay, clock.start, clock.step))
    keep = "keeps its first value" if len(receivers) == 1 else "keep their first values"
    return (
        f"{message.bus}.{message.message.name} first arrives at {at}, not before {stop}: "
        f"{', '.join(receivers)} {keep}"
    )


def _mailboxes(message: MessagePlan) -> set[int]:
    return {mailbox for _, mailbox in message.arrivals} or {m for r in message.routes for m, _ in r.sinks}


def _events(scenario: Scenario) -> list[tuple[str, Event]]:
    """Return the events, each with its place and what it does."""
    start = f"{scenario.path}: " if scenario.path else ""
    return [
        (f"{start}event {n}, {e.action} of {e.variable} at t = {_seconds(e.time)},", e)
        for n, e in enumerate(scenario.file.events, 1)
    ]


def _stimuli(scenario: Scenario, drives: Sequence[Drive]) -> list[tuple[str, tuple[float, float]]]:
    """Return for each stimulus its place, and the times [s] between which it can change."""
    start = f"{scenario.path}: " if scenario.path else ""
    return [
        (f"{start}stimulus {n}, the {_kind(entry)} of {entry.to},", moves_between(entry, drive.signal))
        for (n, entry), drive in zip(scenario.file.stimuli, drives, strict=True)
    ]


def _kind(entry: StimulusEntry) -> str:
    return next(
        kind for kind in ("constant", "sine", "ramp", "csv", "table") if getattr(entry, kind) is not None
    )


def _late_faults(scenario: Scenario, clock: Clock) -> list[str]:
    """Return a sentence for each fault whose time is over before the run, or comes after it."""
    said = []
    for n, fault in enumerate(scenario.file.faults, 1):
        place = (
            f"{scenario.path}: fault {n}, {fault.action} of {target_of(fault)} at t = {_seconds(fault.time)},"
        )
        if fault.time >= clock.stop:
            said.append(f"{place} never acts: the stop time {_seconds(clock.stop)} comes before it")
        elif fault.duration is not None and fault.time + fault.duration <= clock.start:
            said.append(f"{place} never acts: it ends before the start time {_seconds(clock.start)}")
    return said


def _first(said: list[str], what: str = "events") -> list[str]:
    """Return the first sentences, and how many more there are."""
    left = len(said) - _MOST
    return [*said[:_MOST], f"... and {left} more {what} of this kind"] if left > 0 else said


def _seconds(time: float) -> str:
    return f"{time:.10g} s"
