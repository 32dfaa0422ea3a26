"""The inputs that receive the frames of a log: those of messages that no unit of the run sends."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from ..can.channel import SignalRoute
from ..can.database import Message
from ..can.logs.variants import Key, key_of
from ..errors import ConfigError, nearest
from ..interface import Value
from ..system.can_log_spec import CanLogEntry
from ..system.scaling import Scaling
from ..units.measure import Affine
from .bus_connections import find_signal
from .network import Carried, Ends
from .type_rules import check_no_text
from .unit_maps import End, converts

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
class LogReceivers(Ends):
    """The receivers of frames of a log, which no unit of a run sends; `network` has what the units send.

    `ideal`: there are no buses.
    """

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
            name = receiver.signal.partition(".")[0]
            of_file = receiver.place.startswith(place)
            if name in taken and of_file:
                raise ConfigError(
                    f"{receiver.place}: {entry.bus}.{name} is sent by a unit of this run already"
                )
            if of_file and entry.messages is not None and name not in entry.messages:
                raise ConfigError(
                    f"{receiver.place}: {', '.join(receiver.to)} would receive {receiver.signal}, and "
                    f"`messages` leaves {name} out; name it there, or not here"
                )
            if name in taken or (entry.messages is not None and name not in entry.messages):
                continue
            via = f"{entry.bus}.{receiver.signal}"
            messages[name], signal = find_signal(self, via, receiver.place, replayed=True)
            self._drive(
                Carried(signal, via, f"{via} of {entry.can_log}"), receiver, routes.setdefault(name, [])
            )
        wanted = [(messages[name], found) for name, found in routes.items() if found]
        if not wanted:
            raise ConfigError(
                f"{place}: no input receives a message of bus {entry.bus} that no unit sends"
                f"{', of those in `messages`' if entry.messages is not None else ''}; `leave_out` the unit "
                "that sends it, or name inputs and signals in `to`"
            )
        self.network.warnings += [
            f"{place}.messages: nothing receives {entry.bus}.{name}: it is not replayed; an input in `to`, "
            "or a connection whose sender is left out, would receive it"
            for name in entry.messages or ()
            if name not in routes
        ]
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

    def _drive(self, carried: Carried, receiver: _Receiver, routes: list[SignalRoute]) -> None:
        """Let a signal drive the inputs of a receiver, and add its route. Raises ConfigError."""
        sinks = []
        for full in receiver.to:
            sink = self.network.input_of(full, self.interfaces, receiver.place)
            check_no_text(full, self.variable(sink), carried.via, receiver.place)
            map_ = self._map(carried, sink, receiver)
            sinks.append(self.receive(sink, carried, map_, receiver.initial, receiver.place))
        same = next((route for route in routes if route.signal == carried.signal), None)
        if same is not None:
            routes.remove(same)
            sinks = [*same.sinks, *sinks]
        routes.append(SignalRoute(signal=carried.signal, source=0, to_bus=Affine(), sinks=tuple(sinks)))

    def _map(self, carried: Carried, sink: tuple[str, str], receiver: _Receiver) -> Affine:
        """Return the map from a signal's unit to an input's.

        A factor of the connection stands here where the units of measure do not convert, else at the sender.
        """
        end, bus = self.end(sink), carried.via.partition(".")[0]
        on_bus = End(carried.via, carried.signal.unit, bus=bus, difference=end.difference)
        scaling = Scaling() if converts(on_bus, end, self.definitions) else receiver.scaling
        return self.map(on_bus, end, scaling, receiver.place)
