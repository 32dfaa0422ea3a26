"""CAN logs of a scenario, from their files to the messages whose frames they replay."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path

import numpy as np

from ..can.channel import SignalRoute
from ..can.database import Database, Message
from ..can.framing import Framing, framing_of
from ..can.logs.kept import recorded_once
from ..can.logs.recording import Recording, chosen_channel
from ..can.logs.replay import Replayed
from ..can.logs.variants import Key, Variant, Variants, key_of
from ..can.send_steps import send_steps
from ..can.send_types import Sending, check_send_type, send_type_of
from ..clock import Clock
from ..errors import ConfigError
from ..system.can_log_spec import CanLogEntry
from ..system.scenario import Scenario
from ..system.system import System
from ..system.toml import data_file
from .log_receivers import LogReceivers
from .plan import MessagePlan, ReplayPlan
from .steps import steps_in

_MOST = 8  # names in a sentence
_COARSE = 0.02  # of a step; times that are rounded to more of it are told
_LATEST = 4.6e9  # seconds; LATEST of the readers


def with_replays(
    system: System, scenario: Scenario, received: LogReceivers, clock: Clock
) -> list[ReplayPlan]:
    """Return the replays of a scenario; add their messages, and what to know of them, to the network.

    Raises ConfigError, which names the place in the scenario or in the log, for all that does not fit.
    """
    network, plans = received.network, []
    for number, entry in scenario.file.can_logs:
        place = f"{scenario.path}: stimulus {number}" if scenario.path else f"stimulus {number}"
        if received.ideal:
            raise ConfigError(f"{place}: with ideal buses there are no frames, and so none of a log")
        path = data_file(entry.can_log, scenario.path, place) if scenario.path else Path(entry.can_log)
        wanted = received.wanted(entry, place)
        variants = Variants([(m, [r.signal.name for r in routes]) for m, routes in wanted])
        recording = recorded_once(path, variants)
        channel = chosen_channel(recording, entry.channel, entry.bus, place)
        if channel in recording.backward:
            raise ConfigError(
                f"{path}: channel {channel}: {recording.backward[channel]}: a log is replayed in its order"
            )
        database, sent = network.databases[entry.bus], received.sent(entry.bus)
        _check_matches(recording, channel, wanted, database, place)
        first = len(network.messages)
        replayed = _timed(system, entry, recording, channel, first, clock, place)
        status = {m.name: received.status_inputs(f"{entry.bus}.{m.name}") for m, _ in wanted}
        routed = _routed(recording.variants, wanted)
        made = [_message(system, entry.bus, each, clock, status) for each in routed]
        plan = _plan(entry.bus, replayed, made, wanted, clock, place)
        network.messages += made
        network.warnings += _unscaled(system, entry.bus)
        network.warnings += _notes(plan, wanted, database, sent, clock)
        plans.append(plan)
    return plans


@dataclasses.dataclass(frozen=True)
class _Routed:
    """A variant of a message, as its frames hold it, with the routes of its signals."""

    message: Message
    routes: Sequence[SignalRoute]
    page: Mapping[str, int]


def _routed(
    variants: Sequence[Variant], wanted: Sequence[tuple[Message, Sequence[SignalRoute]]]
) -> list[_Routed]:
    by_name = {message.name: (message, routes) for message, routes in wanted}
    found = []
    for variant in variants:
        message, routes = by_name[variant.message]
        held = [route for route in routes if route.signal.name in variant.names]
        found.append(_Routed(message, held, variant.page))
    return found


def _timed(
    system: System,
    entry: CanLogEntry,
    recording: Recording,
    channel: str,
    first: int,
    clock: Clock,
    place: str,
) -> Replayed:
    """Return the frames in the run's time; those of variant i are of the message with number first + i."""
    if entry.time_offset is not None:
        offset = _nanoseconds(entry.time_offset, f"{place}.time_offset")
    else:
        offset = recording.first
    numbers = first + np.arange(len(recording.variants), dtype=np.int64)
    return Replayed(recording, channel, offset, clock, system.file.buses[entry.bus].delay, numbers)


def _nanoseconds(time: float, place: str) -> int:
    """Return a time of a log [s] in ns. Raises ConfigError, with `place`, for one that no log has."""
    if abs(time) > _LATEST:
        raise ConfigError(
            f"{place} = {time:g} s: no log has such a time: it is from -{_LATEST:g} to {_LATEST:g} s, and "
            "the year 2115 is the last one, counted from 1970; is it in ms?"
        )
    return int(Decimal(repr(time)) * 10**9)


def _message(
    system: System, bus: str, variant: _Routed, clock: Clock, status: Mapping[str, tuple[int, ...]]
) -> MessagePlan:
    """Return the plan of a message, or of a page of it, whose frames come from a log.

    `status` are the mailboxes of each message's status.
    """
    settings, message = system.file.buses[bus], variant.message
    names = [route.signal.name for route in variant.routes]
    place, folder = f"{system.path}: buses.{bus}", str(system.path.parent)
    own = settings.of_message(message.name)
    check_send_type(message, settings, 2 if variant.page else 1, place)
    framing = framing_of(message, settings, names, place, folder) or Framing()
    framing = dataclasses.replace(framing, status=status[message.name])
    # pages are sent at each cycle
    sending = Sending() if variant.page else Sending(send_type_of(message, own)[0])
    every, first = 1, 0
    if sending.regular and framing.watched(own):
        every, first = send_steps(message, clock.step, str(system.path), bus)
        every *= settings.cycle
        if settings.timing == "instant":
            first += steps_in(settings.delay, clock.step, f"{system.path}: buses.{bus}.delay")
    protection = framing.protection.signals if framing.protection is not None else []
    signals = {signal.name: signal for signal in protection}
    signals |= {route.signal.name: route.signal for route in variant.routes}
    return MessagePlan(
        bus=bus,
        message=dataclasses.replace(message, signals=signals),
        settings=settings,
        routes=tuple(variant.routes),
        senders={},
        every=every,
        first=first,
        after=None,
        framing=framing,
        page=variant.page,
        sending=sending,
        replayed=True,
    )


def _unscaled(system: System, bus: str) -> list[str]:
    resolution = system.file.buses[bus].resolution
    if resolution == 1.0:
        return []
    shown = f'"{resolution}"' if isinstance(resolution, str) else f"{resolution:g}"
    return [
        f"{system.path}: buses.{bus}.resolution = {shown} does not act on frames of a log, which are decoded "
        "by the database"
    ]


def _check_matches(
    recording: Recording,
    channel: str,
    wanted: Sequence[tuple[Message, Sequence[SignalRoute]]],
    database: Database,
    place: str,
) -> None:
    """Raise ConfigError where no frame of the log is one of the wanted messages."""
    seen = recording.seen[channel]
    good = [m for m, _ in wanted if (one := seen.get(key_of(m))) is not None and one.frames > one.short]
    if good:
        return
    names = ", ".join(f"{m.name} ({_identifier(key_of(m))}, {m.length} bytes)" for m, _ in wanted[:_MOST])
    known = {key_of(m) for m in database.messages.values()}
    matching = sum(one.frames for key, one in seen.items() if key in known)
    short = [(m, seen[key_of(m)]) for m, _ in wanted if key_of(m) in seen]
    lengths = "".join(f"; {m.name} has {one.least} bytes there, not {m.length}" for m, one in short[:_MOST])
    raise ConfigError(
        f"{place}.can_log: {recording.path}: of the {recording.count(channel)} frames of channel {channel} "
        f"none is one of the messages that would be replayed: {names}{lengths}; {matching} frames have an "
        f"identifier of {database.path}: is it the log of another bus, or of another database?"
    )


def _identifier(key: Key) -> str:
    return f"{key[0]:#x}{' extended' if key[1] else ''}"


def _plan(
    bus: str,
    replayed: Replayed,
    made: Sequence[MessagePlan],
    wanted: Sequence[tuple[Message, Sequence[SignalRoute]]],
    clock: Clock,
    place: str,
) -> ReplayPlan:
    """Return the plan of a replay with its counts. Raises ConfigError where no frame of it is in the run."""
    counts = {m.name: 0 for m, _ in wanted}
    within, before, after = np.zeros(len(made), dtype=np.int64), 0, 0
    for variants, steps in replayed.steps():
        inside = (steps >= 0) & (steps < clock.steps)
        within += np.bincount(variants[inside], minlength=len(made))
        before += int((steps < 0).sum())
        after += int((steps >= clock.steps).sum())
    for plan, count in zip(made, within.tolist(), strict=True):
        counts[plan.message.name] += count
    path = replayed.recording.path
    of_channel = replayed.recording.spans[replayed.channel]
    first, last = ((time - replayed.offset) * 1e-9 for time in (of_channel.first, of_channel.last))
    if not within.any():
        raise ConfigError(
            f"{place}: none of the {before + after} frames that would be replayed of {path} is within the "
            f"run, from {clock.start:g} s to {clock.stop:g} s: its frames are from {first:.6g} s to "
            f"{last:.6g} s of the run's time; `time_offset` is the time of the log at which the run's clock "
            "shows 0 s"
        )
    return ReplayPlan(
        bus=bus,
        path=path,
        frames=replayed,
        counts=counts,
        span=(first, last),
        resolution=of_channel.resolution * 1e-9,
        before=before,
        after=after,
    )


def _notes(
    plan: ReplayPlan,
    wanted: Sequence[tuple[Message, Sequence[SignalRoute]]],
    database: Database,
    sent: Mapping[Key, str],
    clock: Clock,
) -> Iterator[str]:
    """Yield a sentence for each kind of frames of the log that is not replayed, and for what is missing."""
    recording = plan.frames.recording
    seen = recording.seen[plan.frames.channel]
    by_units = {name: seen[key].frames for key, name in sent.items() if key in seen}
    if by_units:
        yield (
            f"{plan.path}: {sum(by_units.values())} frames are of messages that units of the run send, and "
            f"not replayed: {_first(by_units)}"
        )
    yield from (f"{plan.path}: {note}" for note in recording.notes)
    known = {key_of(m) for m in database.messages.values()}
    unknown = {_identifier(key): one.frames for key, one in seen.items() if key not in known}
    if unknown:
        yield (
            f"{plan.path}: {sum(unknown.values())} frames have {len(unknown)} identifiers that "
            f"{database.path} does not have: {_first(unknown)}"
        )
    for message, _ in wanted:
        one = seen.get(key_of(message))
        if one is not None and one.short:
            yield (
                f"{plan.path}: {one.short} of {one.frames} frames of {message.name} have fewer than its "
                f"{message.length} bytes, {one.least} at least, and are not replayed"
            )
        if not plan.counts[message.name]:
            yield (
                f"{plan.path}: no frame of {plan.bus}.{message.name} is replayed: its receivers keep their "
                "first values"
            )
    if (share := plan.resolution / clock.step) >= _COARSE:
        early = f"about {50 * share:.2g} % of its frames are" if share <= 1.0 else "most of its frames may be"
        yield (
            f"{plan.path}: its times are rounded to {plan.resolution:.3g} s, and a step takes "
            f"{clock.step:.3g} s: {early} seen in another step than those of exact times would be"
        )
    if (late := _ends_early(plan, clock)) > 0.0:
        yield (
            f"{plan.path} ends at {plan.span[1]:.6g} s of the run's time, {late:.3g} s before the stop time: "
            "the last values hold"
        )


def _first(counts: Mapping[str, int]) -> str:
    shown = [f"{name} ({count})" for name, count in list(counts.items())[:_MOST]]
    return ", ".join(shown) + (f" and {len(counts) - _MOST} more" if len(counts) > _MOST else "")


def _ends_early(plan: ReplayPlan, clock: Clock) -> float:
    """Return by how much [s] a log ends before the run; 0 where its messages may just not be due again."""
    left = clock.stop - plan.span[1]
    longest = max((clock.stop - clock.start) / count for count in plan.counts.values() if count)
    return left if left > 2.0 * longest else 0.0
