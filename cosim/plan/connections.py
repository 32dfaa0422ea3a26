"""The connections of a system, resolved: routes within a step, messages on buses, a driver for each input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..clock import Clock
from ..errors import ConfigError, nearest
from ..interface import UnitInterface
from ..system.system import Algorithm, Connection, System
from ..units.measure import Affine
from .bus_connections import bus_maps, find_signal, over_bus
from .buses import foreign_senders, open_buses
from .message_plans import message_plans
from .network import Connecting, Network, split_name
from .plan import InputPlan, Link
from .sendings import Turns, other_send_types
from .slots import Slots
from .type_rules import check_no_text, check_types
from .unit_plan import Route


def connect(
    system: System,
    interfaces: Mapping[str, UnitInterface],
    slots: Slots,
    turns: Turns,
    clock: Clock,
    algorithm: Algorithm,
    ideal: bool,
) -> Network:
    """Return the resolved connections of the participating units; `turns` are the units' periods and offsets.

    A connection of a unit that was left out is dropped; with `ideal` a bus signal becomes a direct
    connection. Raises ConfigError naming the system file, the connection, the rule and the values.
    """
    work = Connecting(system, interfaces, slots, Network({unit: [] for unit in interfaces}), turns, ideal)
    work.network.databases = open_buses(system, work.network.warnings)
    for connection in system.file.connect:
        _check_names(connection, system)
        _connect(work, connection)
    order = list(interfaces)
    for (bus, message), routes in work.signal_routes.items():
        work.network.messages += message_plans(work, bus, message, routes, clock.step, algorithm, order)
    work.network.warnings += other_send_types(
        (m.bus, m.message, m.settings, bool(m.page)) for m in work.network.messages
    )
    work.network.warnings += foreign_senders(work.network.messages, system, work.network.databases)
    return work.network


def _check_names(connection: Connection, system: System) -> None:
    for name in (connection.source, *connection.to):
        unit = name.partition(".")[0]
        if unit not in system.file.units:
            raise ConfigError(
                f"{_place(system, connection)}: there is no unit '{unit}'{nearest(unit, system.file.units)}"
            )


def _place(system: System, connection: Connection) -> str:
    return f"{system.path}: connect {connection.source} -> {', '.join(connection.to) or connection.via}"


def _connect(work: Connecting, connection: Connection) -> None:
    """Resolve one connection, if its sender takes part."""
    place = _place(work.system, connection)
    if connection.source.partition(".")[0] not in work.interfaces:
        return  # the sender was left out: its receivers are free inputs
    source = split_name(connection.source, ("output", "local"), work.interfaces, place)
    sinks = [
        split_name(name, ("input",), work.interfaces, place)
        for name in connection.to
        if name.partition(".")[0] in work.interfaces
    ]
    if connection.via is None and not connection.to:
        raise ConfigError(f"{place}: a connection needs a receiver in 'to' or a signal in 'via'")
    # the signal is looked up with `ideal` too, so that a system file is right or wrong in both
    message, signal = find_signal(work, connection.via, place) if connection.via else (None, None)
    for end in (source, *sinks) if connection.via else ():
        check_no_text(".".join(end), work.variable(end), connection.via or "", place)
    _check_scalable(work, connection, source, sinks, place)
    if message is None or signal is None or work.ideal:
        for sink in sinks:
            if signal is None or not connection.written:
                map_ = work.map(work.end(source), work.end(sink), connection, place)
            else:  # the factor stands at one of the two ends of the bus
                to_bus, (from_bus,) = bus_maps(work, connection, source, [sink], signal, place)
                map_ = to_bus.then(from_bus)
            _direct(work, source, sink, map_, place)
        return
    over_bus(work, connection, source, sinks, message, signal, place)


def _check_scalable(
    work: Connecting,
    connection: Connection,
    source: tuple[str, str],
    sinks: Sequence[tuple[str, str]],
    place: str,
) -> None:
    """Raise ConfigError for a factor where a value is no number, or the receiver's number no Real."""
    if connection.linear.identity:
        return
    for name in (source, *sinks):
        kind = work.variable(name).type
        if kind == "String" or (name != source and kind != "Real"):
            raise ConfigError(
                f"{place}: {connection.in_words}: {'.'.join(name)} is of type {kind}; a number can be "
                "scaled, and goes into a Real"
            )


def _direct(
    work: Connecting, source: tuple[str, str], sink: tuple[str, str], map_: Affine, place: str
) -> None:
    """Resolve a connection without a bus: a route within the step."""
    sender, receiver = work.variable(source), work.variable(sink)
    check_types(source, sender, sink, receiver, place)
    slot = work.slots.valid[sink]
    work.network.drive(".".join(sink), InputPlan(slot, None, ".".join(source)), place)
    work.network.routes[sink[0]].append(
        Route(work.slots.source(*source, work.turns[source[0]][0]), slot, map_)
    )
    work.network.links.append(Link(source, sink, map_))
