"""The connections of a system, resolved: routes within a step, messages on buses, a driver for each input."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

from ..can.as_sent import as_sent
from ..can.channel import SignalRoute
from ..can.database import Database, Message, Signal, check_signal
from ..can.framing import bare_framing, check_jitter, framing_of
from ..can.limits import notes_on
from ..can.pages import pages
from ..can.resolution import with_resolution
from ..clock import Clock
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, VariableInfo
from ..system.scaling import Scaling
from ..system.system import Algorithm, Connection, System
from ..units.definition import names_difference
from ..units.measure import Affine
from .buses import check_one_sender, foreign_senders, open_buses
from .initials import initial_of
from .plan import InputPlan, Link, MessagePlan
from .sendings import Turns, other_send_types, send_times, staged
from .slots import Slots
from .steps import steps_in
from .type_rules import check_boolean, check_no_text, check_types, check_whole
from .unit_maps import Definitions, End, converts, scaled_map, with_unit
from .unit_plan import Route


@dataclasses.dataclass
class Network:
    """The resolved connections: routes by receiving unit; `inputs` and `initial` by "unit.variable"."""

    routes: dict[str, list[Route]]
    links: list[Link] = dataclasses.field(default_factory=list)
    messages: list[MessagePlan] = dataclasses.field(default_factory=list)
    inputs: dict[str, InputPlan] = dataclasses.field(default_factory=dict)
    initial: dict[str, float] = dataclasses.field(default_factory=dict)
    warnings: list[str] = dataclasses.field(default_factory=list)
    databases: dict[str, Database] = dataclasses.field(default_factory=dict)

    def drive(self, name: str, plan: InputPlan, place: str) -> None:
        """Note the driver of an input. Raises ConfigError when something drives it already."""
        if name in self.inputs:
            raise ConfigError(f"{place}: {name} is driven already, by {self.inputs[name].driver}")
        self.inputs[name] = plan

    def add_mailbox(self, unit: str, name: str, slots: Slots, driver: str) -> int:
        """Give an input a mailbox and the route from it; return the mailbox's slot."""
        mailbox, slot = slots.take(1), slots.valid[unit, name]
        self.routes[unit].append(Route(mailbox, slot))
        self.inputs[f"{unit}.{name}"] = InputPlan(slot, mailbox, driver)
        return mailbox

    def input_of(self, name: str, interfaces: Mapping[str, UnitInterface], place: str) -> tuple[str, str]:
        """Return unit and variable of the input "unit.variable".

        Raises ConfigError with the nearest name when there is no such input.
        """
        return _split(name, ("input",), interfaces, place)


def _split(
    name: str, causalities: Sequence[str], interfaces: Mapping[str, UnitInterface], place: str
) -> tuple[str, str]:
    """Return unit and variable of "unit.variable". Raises ConfigError where it has another causality."""
    unit, _, variable = name.partition(".")
    if unit not in interfaces:
        raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, interfaces)}")
    interfaces[unit].require(unit, variable, causalities, place)
    return unit, variable


@dataclasses.dataclass
class _Connector:
    """The arguments of `connect` and what it has found so far, for its helpers.

    By (bus, message): `senders` are the sending variables by signal, `signal_routes` the routes of the
    signals.
    """

    system: System
    interfaces: Mapping[str, UnitInterface]
    slots: Slots
    network: Network
    turns: Turns
    ideal: bool
    senders: dict[tuple[str, str], dict[str, str]] = dataclasses.field(default_factory=dict)
    signal_routes: dict[tuple[str, str], list[SignalRoute]] = dataclasses.field(default_factory=dict)


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
    work = _Connector(system, interfaces, slots, Network({unit: [] for unit in interfaces}), turns, ideal)
    work.network.databases = open_buses(system, work.network.warnings)
    for connection in system.file.connect:
        _check_names(connection, system)
        _connect(work, connection)
    order = list(interfaces)
    for (bus, message), routes in work.signal_routes.items():
        work.network.messages += _message(work, bus, message, routes, clock.step, algorithm, order)
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


def _connect(work: _Connector, connection: Connection) -> None:
    """Resolve one connection, if its sender takes part."""
    place = _place(work.system, connection)
    if connection.source.partition(".")[0] not in work.interfaces:
        return  # the sender was left out: its receivers are free inputs
    source = _split(connection.source, ("output", "local"), work.interfaces, place)
    sinks = [
        _split(name, ("input",), work.interfaces, place)
        for name in connection.to
        if name.partition(".")[0] in work.interfaces
    ]
    if connection.via is None and not connection.to:
        raise ConfigError(f"{place}: a connection needs a receiver in 'to' or a signal in 'via'")
    # the signal is looked up with `ideal` too, so that a system file is right or wrong in both
    message, signal = _find_signal(work, connection.via, place) if connection.via else (None, None)
    for end in (source, *sinks) if connection.via else ():
        check_no_text(".".join(end), _variable(work, end), connection.via or "", place)
    _check_scalable(work, connection, source, sinks, place)
    if message is None or signal is None or work.ideal:
        for sink in sinks:
            if signal is None or not connection.written:
                map_ = _map(work, _end(work, source), _end(work, sink), connection, place)
            else:  # the factor stands at one of the two ends of the bus
                to_bus, (from_bus,) = _bus_maps(work, connection, source, [sink], signal, place)
                map_ = to_bus.then(from_bus)
            _direct(work, source, sink, map_, place)
        return
    _over_bus(work, connection, source, sinks, message, signal, place)


def _check_scalable(
    work: _Connector,
    connection: Connection,
    source: tuple[str, str],
    sinks: Sequence[tuple[str, str]],
    place: str,
) -> None:
    """Raise ConfigError for a factor where a value is no number, or the receiver's number no Real."""
    if connection.linear.identity:
        return
    for name in (source, *sinks):
        kind = _variable(work, name).type
        if kind == "String" or (name != source and kind != "Real"):
            raise ConfigError(
                f"{place}: {connection.in_words}: {'.'.join(name)} is of type {kind}; a number can be "
                "scaled, and goes into a Real"
            )


def _bus_maps(
    work: _Connector,
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
    sender = _end(work, source)
    bus = str(connection.via).split(".")[0]
    difference = sender.difference or names_difference(sender.unit)
    on_bus = End(connection.via or "", signal.unit, difference=difference, bus=bus)
    before, after = Scaling(), Scaling()
    if not sinks or not converts(sender, on_bus, _definitions(work)):
        before = connection
    else:
        after = connection
    to_bus = _map(work, sender, on_bus, before, place)
    return to_bus, [_map(work, on_bus, _end(work, sink), after, place) for sink in sinks]


def _direct(
    work: _Connector, source: tuple[str, str], sink: tuple[str, str], map_: Affine, place: str
) -> None:
    """Resolve a connection without a bus: a route within the step."""
    sender, receiver = _variable(work, source), _variable(work, sink)
    check_types(source, sender, sink, receiver, place)
    slot = work.slots.valid[sink]
    work.network.drive(".".join(sink), InputPlan(slot, None, ".".join(source)), place)
    work.network.routes[sink[0]].append(
        Route(work.slots.source(*source, work.turns[source[0]][0]), slot, map_)
    )
    work.network.links.append(Link(source, sink, map_))


def _over_bus(
    work: _Connector,
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
    to_bus, to_receivers = _bus_maps(work, connection, source, sinks, signal, place)
    signal = _coarser(work, bus, message, signal, [source, *sinks], place)
    settings = work.system.file.buses[bus]
    ends = []
    for sink, to_receiver in zip(sinks, to_receivers, strict=True):
        receiver = _variable(work, sink)
        check_whole(".".join(sink), receiver, signal, place)
        check_boolean(_variable(work, source), ".".join(sink), receiver, signal, settings.overflow, place)
        name = ".".join(sink)
        work.network.drive(name, InputPlan(work.slots.valid[sink], None, ""), place)
        mailbox = work.network.add_mailbox(*sink, work.slots, f"{connection.source} via {connection.via}")
        via = connection.via or ""
        initial = initial_of(connection.initial, via, to_receiver, receiver, work.system, place)
        if initial is not None:
            work.network.initial[name] = initial
        ends.append((mailbox, to_receiver))
    route = SignalRoute(signal=signal, source=work.slots.valid[source], to_bus=to_bus, sinks=tuple(ends))
    work.signal_routes.setdefault(key, []).append(route)


def _coarser(
    work: _Connector,
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
    if resolution == 1.0 or any(_variable(work, end).type != "Real" for end in ends):
        return signal
    changed = with_resolution(signal, resolution)
    check_signal(message, changed, f"{place}: with resolution = {resolution!r}")
    return changed


def _find_signal(work: _Connector, via: str, place: str) -> tuple[Message, Signal]:
    """Return message and signal of "bus.message.signal". Raises ConfigError when there is none."""
    bus, message_name, signal_name = via.split(".", 2)  # some long names of signals have a dot
    if bus not in work.network.databases:
        raise ConfigError(f"{place}: there is no bus '{bus}'{nearest(bus, work.network.databases)}")
    settings, known = work.system.file.buses[bus], work.network.warnings
    message = as_sent(work.network.databases[bus].require(message_name, place), settings)
    signal = message.require(signal_name, place)
    known += [note for note in notes_on(message, signal, via, settings) if note not in known]
    return message, with_unit(signal, settings.units)


def _message(
    work: _Connector,
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
        status = status_inputs(work.network, work.system, work.interfaces, work.slots, f"{bus}.{name}")
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
            of_page = [staged(work.slots, route, arrivals) for route in of_page]
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


def status_inputs(
    network: Network, system: System, interfaces: Mapping[str, UnitInterface], slots: Slots, via: str
) -> tuple[int, ...]:
    """Return the mailboxes of inputs that receive the status of "bus.message"; those left out have none."""
    bus, _, message = via.partition(".")
    place, found = f"{system.path}: buses.{bus}.messages.{message}.status", []
    for full in system.file.buses[bus].of_message(message).status:
        if full.partition(".")[0] not in system.file.units:
            raise ConfigError(f"{place}: there is no unit of '{full}'{nearest(full, interfaces)}")
        if full.partition(".")[0] in interfaces:
            unit, name = network.input_of(full, interfaces, place)
            check_no_text(full, interfaces[unit].variables[name], f"the status of {message}", place)
            network.drive(full, InputPlan(slots.valid[unit, name], None, ""), place)
            found.append(network.add_mailbox(unit, name, slots, f"the status of {message}"))
    return tuple(found)


def _variable(work: _Connector, name: tuple[str, str]) -> VariableInfo:
    return work.interfaces[name[0]].variables[name[1]]


def _end(work: _Connector, name: tuple[str, str]) -> End:
    """Return a variable as an end of a connection."""
    v = _variable(work, name)
    return End(".".join(name), v.unit, work.interfaces[name[0]].units_of_measure, v.difference)


def _map(work: _Connector, source: End, target: End, scaling: Scaling, place: str) -> Affine:
    return scaled_map(source, target, scaling, _definitions(work), place, work.network.warnings)


def _definitions(work: _Connector) -> list[Definitions]:
    return [interface.units_of_measure for interface in work.interfaces.values()]
