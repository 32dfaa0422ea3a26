"""The receivers of frames of a bus whose senders take no part in a run."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

from ..can.as_sent import as_sent
from ..can.channel import SignalRoute
from ..can.database import Message, Signal
from ..can.logs.recording import Key, key_of
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value
from ..system.can_log_spec import CanLogEntry
from ..system.scaling import Scaling
from ..system.system import System
from ..units.measure import Affine
from .initials import initial_of
from .network import Network, status_inputs
from .plan import InputPlan
from .slots import Slots
from .type_rules import check_no_text, check_whole
from .unit_maps import Definitions, End, converts, scaled_map, with_unit

Wanted = list[tuple[Message, list[SignalRoute]]]
"""Messages, each with the routes from its signals to their receivers."""


@dataclasses.dataclass(frozen=True)
class _Receiver:
    """A signal, the inputs that receive it, and what a connection says of it."""

    signal: str
    to: Sequence[str]
    scaling: Scaling
    initial: Value | None
    place: str


@dataclasses.dataclass
class Received:
    """The receivers of frames that no unit of a run sends; `network` has what the units send.

    `ideal`: there are no buses.
    """

    system: System
    interfaces: Mapping[str, UnitInterface]
    network: Network
    slots: Slots
    ideal: bool

    def sent(self, bus: str) -> dict[Key, str]:
        """Return the names of the messages of a bus that units send, by identifier."""
        return {
            key_of(m.message): m.message.name
            for m in self.network.messages
            if m.bus == bus and not m.replayed
        }

    def wanted(self, entry: CanLogEntry, place: str) -> Wanted:
        """Return the messages that a log replays; their receivers are driven then.

        Raises ConfigError, which starts with `place`, for a bus, a message, a signal or an input that there
        is not, that is sent or driven already, or where nothing receives any message.
        """
        buses = self.system.file.buses
        if entry.bus not in buses:
            raise ConfigError(f"{place}.bus: there is no bus '{entry.bus}'{nearest(entry.bus, buses)}")
        database = self.network.databases[entry.bus]
        taken = {m.message.name for m in self.network.messages if m.bus == entry.bus}
        for name in entry.messages or ():
            database.require(name, f"{place}.messages")
            if name in taken:
                raise ConfigError(
                    f"{place}.messages: {entry.bus}.{name} is sent by a unit of this run already"
                )
        routes: dict[str, list[SignalRoute]] = {}
        messages: dict[str, Message] = {}
        for receiver in (*self._of_file(entry, place), *self._of_connections(entry.bus)):
            name, _, signal_name = receiver.signal.partition(".")
            if name in taken and receiver.place.startswith(place):
                raise ConfigError(
                    f"{receiver.place}: {entry.bus}.{name} is sent by a unit of this run already"
                )
            if name in taken or (entry.messages is not None and name not in entry.messages):
                continue
            message = as_sent(database.require(name, receiver.place), buses[entry.bus])
            signal = with_unit(message.require(signal_name, receiver.place), buses[entry.bus].units)
            messages[name] = message
            self._drive(entry, receiver, signal, routes.setdefault(name, []))
        wanted = [(messages[name], found) for name, found in routes.items() if found]
        if not wanted:
            raise ConfigError(
                f"{place}: no input receives a message of bus {entry.bus} that no unit sends"
                f"{', of those in `messages`' if entry.messages is not None else ''}; `leave_out` the unit "
                "that sends it, or name inputs and signals in `to`"
            )
        return wanted

    def _of_file(self, entry: CanLogEntry, place: str) -> Iterator[_Receiver]:
        for name, signal in entry.to.items():
            yield _Receiver(signal, [name], Scaling(), None, f"{place}.to")

    def _of_connections(self, bus: str) -> Iterator[_Receiver]:
        """Yield the receivers of connections over a bus whose sender takes no part."""
        for connection in self.system.file.connect:
            of_bus, _, signal = (connection.via or "").partition(".")
            if of_bus != bus or connection.source.partition(".")[0] in self.interfaces:
                continue
            to = [name for name in connection.to if name.partition(".")[0] in self.interfaces]
            place = f"{self.system.path}: connect {connection.source} -> {', '.join(connection.to)}"
            if to:
                yield _Receiver(signal, to, connection, connection.initial, place)

    def _drive(
        self, entry: CanLogEntry, receiver: _Receiver, signal: Signal, routes: list[SignalRoute]
    ) -> None:
        """Let a signal drive the inputs of a receiver, and add its route. Raises ConfigError."""
        via, place, sinks = f"{entry.bus}.{receiver.signal}", receiver.place, []
        for full in receiver.to:
            unit, name = self.network.input_of(full, self.interfaces, place)
            variable = self.interfaces[unit].variables[name]
            check_no_text(full, variable, via, place)
            check_whole(full, variable, signal, place)
            slot = self.slots.valid[unit, name]
            self.network.drive(full, InputPlan(slot, None, ""), place)
            mailbox = self.network.add_mailbox(unit, name, self.slots, f"{via} of {entry.can_log}")
            map_ = self._map(signal, via, entry.bus, unit, name, receiver)
            initial = initial_of(receiver.initial, via, map_, variable, self.system, place)
            if initial is not None:
                self.network.initial[full] = initial
            sinks.append((mailbox, map_))
        same = next((route for route in routes if route.signal == signal), None)
        if same is not None:
            routes.remove(same)
            sinks = [*same.sinks, *sinks]
        routes.append(SignalRoute(signal=signal, source=0, to_bus=Affine(), sinks=tuple(sinks)))

    def _map(self, signal: Signal, via: str, bus: str, unit: str, name: str, receiver: _Receiver) -> Affine:
        """Return the map from a signal's unit to an input's.

        A factor of the connection stands here where the units of measure do not convert, else at the sender.
        """
        interface = self.interfaces[unit]
        variable = interface.variables[name]
        on_bus = End(via, signal.unit, bus=bus, difference=variable.difference)
        end = End(f"{unit}.{name}", variable.unit, interface.units_of_measure, variable.difference)
        others: list[Definitions] = [each.units_of_measure for each in self.interfaces.values()]
        scaling = Scaling() if converts(on_bus, end, others) else receiver.scaling
        return scaled_map(on_bus, end, scaling, others, receiver.place, self.network.warnings)

    def status_inputs(self, bus: str, message: str) -> tuple[int, ...]:
        """Return the mailboxes of the inputs that receive a message's status. Raises ConfigError."""
        return status_inputs(self.network, self.system, self.interfaces, self.slots, f"{bus}.{message}")
