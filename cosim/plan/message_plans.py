"""The messages that carry the connected signals of a system: when each is sent, and as what."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from ..can.as_sent import as_sent
from ..can.channel import SignalRoute
from ..can.framing import bare_framing, check_jitter, framing_of
from ..can.pages import pages
from ..system.system import Algorithm
from .network import Connecting
from .plan import MessagePlan
from .sendings import send_times
from .slots import Slots
from .steps import steps_in


def message_plans(
    work: Connecting,
    bus: str,
    name: str,
    routes: list[SignalRoute],
    step_size: float,
    algorithm: Algorithm,
    order: list[str],
) -> Iterator[MessagePlan]:
    """Yield the plan of each page of a message. Raises ConfigError when its times do not fit the step.

    Under `gauss_seidel` it is sent after the last of its senders, by `order`, with a sampled output.
    """
    settings = work.system.file.buses[bus]
    message = as_sent(work.network.databases[bus].require(name), settings)
    path, connected = str(work.system.path), [route.signal.name for route in routes]
    where = f"{path}: buses.{bus}"
    delay = steps_in(settings.delay, step_size, f"{where}.delay") if settings.timing == "instant" else 0
    framing = framing_of(message, settings, connected, where, str(work.system.path.parent))
    if framing is not None:
        status = work.status_inputs(f"{bus}.{name}")
        framing = dataclasses.replace(framing, status=status)
    senders = work.senders[bus, name]
    after = None
    if algorithm == "gauss_seidel":
        sampled = [
            order.index(unit)
            for unit, variable in (sender.split(".", 1) for sender in senders.values())
            if work.interfaces[unit].variables[variable].sampled
        ]
        after = max(sampled, default=None)
    turns = pages(message, connected, path)
    units = (sender.split(".")[0] for sender in senders.values())
    times = send_times(message, settings, units, work.turns, step_size, path, bus, len(turns))
    if times.sending.kind != "cyclic":
        framing = framing or bare_framing(settings, where, f"the send type of {name} needs them")
    check_jitter(message, settings, times.apart * step_size, where)
    for i, page in enumerate(turns):
        arrivals: list[tuple[int, int]] = []
        of_page = [route for route in routes if route.signal.name in page.signals]
        if delay and framing is None:
            of_page = [_delayed(work.slots, route, arrivals) for route in of_page]
        sent = page.of(message)
        yield MessagePlan(
            bus=bus,
            message=dataclasses.replace(
                sent, signals=sent.signals | {route.signal.name: route.signal for route in of_page}
            ),
            settings=settings,
            routes=tuple(of_page),
            senders={route.signal.name: senders[route.signal.name] for route in of_page},
            every=times.every * len(turns),
            first=times.first + i * times.every,
            after=after,
            delay=delay,
            arrivals=tuple(arrivals),
            framing=framing,
            page=page.selected,
            sending=times.sending,
        )


def _delayed(slots: Slots, route: SignalRoute, arrivals: list[tuple[int, int]]) -> SignalRoute:
    """Return the route into slots of its own; add the pairs of these and the mailboxes to `arrivals`."""
    sinks = [(slots.take(1), mailbox, map_) for mailbox, map_ in route.sinks]
    arrivals += [(slot, mailbox) for slot, mailbox, _ in sinks]
    return dataclasses.replace(route, sinks=tuple((slot, map_) for slot, _, map_ in sinks))
