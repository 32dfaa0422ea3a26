"""Connections over a bus: a signal's route from its sender into the mailboxes of its receivers."""

from __future__ import annotations

from collections.abc import Sequence

from ..can.as_sent import as_sent
from ..can.channel import SignalRoute
from ..can.database import Message, Signal, check_signal
from ..can.limits import notes_on
from ..can.resolution import with_resolution
from ..errors import ConfigError, nearest
from ..system.scaling import Scaling
from ..system.system import Connection
from ..units.definition import names_difference
from ..units.measure import Affine
from .buses import check_one_sender
from .network import Carried, Connecting, Ends
from .unit_maps import End, converts, with_unit


def find_signal(ends: Ends, via: str, place: str, replayed: bool = False) -> tuple[Message, Signal]:
    """Return message and signal of "bus.message.signal"; what to know of it goes to the network's warnings.

    `replayed`: its frames come from a log. Raises ConfigError when there is none.
    """
    bus, message_name, signal_name = via.split(".", 2)  # some long names of signals have a dot
    databases, known = ends.network.databases, ends.network.warnings
    if bus not in databases:
        raise ConfigError(f"{place}: there is no bus '{bus}'{nearest(bus, databases)}")
    settings = ends.system.file.buses[bus]
    message = as_sent(databases[bus].require(message_name, place), settings)
    signal = message.require(signal_name, place)
    known += [note for note in notes_on(message, signal, via, settings, replayed) if note not in known]
    return message, with_unit(signal, settings.units)


def bus_maps(
    work: Connecting,
    connection: Connection,
    source: tuple[str, str],
    sinks: Sequence[tuple[str, str]],
    signal: Signal,
    place: str,
) -> tuple[Affine, list[Affine]]:
    """Return the map from the sender to the bus signal, and those from there to the receivers.

    A factor stands where the quantity changes: at the sender if its unit does not convert to the signal's, or
    there is no receiver; else at the receivers.
    """
    sender = work.end(source)
    bus = str(connection.via).split(".")[0]
    difference = sender.difference or names_difference(sender.unit)
    on_bus = End(connection.via or "", signal.unit, difference=difference, bus=bus)
    before, after = Scaling(), Scaling()
    if not sinks or not converts(sender, on_bus, work.definitions):
        before = connection
    else:
        after = connection
    to_bus = work.map(sender, on_bus, before, place)
    return to_bus, [work.map(on_bus, work.end(sink), after, place) for sink in sinks]


def over_bus(
    work: Connecting,
    connection: Connection,
    source: tuple[str, str],
    sinks: Sequence[tuple[str, str]],
    message: Message,
    signal: Signal,
    place: str,
) -> None:
    """Resolve a connection over a bus: a signal's route into mailboxes, and routes from them.

    Raises ConfigError when the signal has a sender already, a receiver another driver, or a receiver that is
    not Real cannot receive the signal's values.
    """
    bus = str(connection.via).split(".")[0]
    key = (bus, message.name)
    senders = work.senders.setdefault(key, {})
    if signal.name in senders:
        first = senders[signal.name]
        more = "; name all its receivers in the `to` of that connection" if first == connection.source else ""
        raise ConfigError(f"{place}: {connection.via} is sent already, by {first}{more}")
    for other, sender in senders.items():
        check_one_sender(work.system, message, (source[0], sender.split(".")[0]), (signal.name, other), place)
    senders[signal.name] = connection.source
    to_bus, to_receivers = bus_maps(work, connection, source, sinks, signal, place)
    signal = _coarser(work, bus, message, signal, [source, *sinks], place)
    via = connection.via or ""
    carried = Carried(signal, via, f"{connection.source} via {via}", work.variable(source))
    ends = [
        work.receive(sink, carried, map_, connection.initial, place)
        for sink, map_ in zip(sinks, to_receivers, strict=True)
    ]
    route = SignalRoute(signal=signal, source=work.slots.valid[source], to_bus=to_bus, sinks=tuple(ends))
    work.signal_routes.setdefault(key, []).append(route)


def _coarser(
    work: Connecting,
    bus: str,
    message: Message,
    signal: Signal,
    ends: Sequence[tuple[str, str]],
    place: str,
) -> Signal:
    """Return the signal in the resolution of the bus.

    A state or a count, which stands behind a variable that is not Real, has no resolution.
    """
    resolution = work.system.file.buses[bus].resolution
    if resolution == 1.0 or any(work.variable(end).type != "Real" for end in ends):
        return signal
    changed = with_resolution(signal, resolution)
    check_signal(message, changed, f"{place}: with resolution = {resolution!r}")
    return changed
