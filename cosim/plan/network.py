"""The resolved connections of a system, and the arguments of what resolves them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

from ..can.channel import SignalRoute
from ..can.database import Database, Signal
from ..errors import ConfigError, nearest
from ..interface import UnitInterface, Value, VariableInfo
from ..system.scaling import Scaling
from ..system.system import System
from ..units.measure import Affine
from .initials import initial_of
from .plan import InputPlan, Link, MessagePlan
from .sendings import Turns
from .slots import Slots
from .type_rules import check_boolean, check_status, check_whole
from .unit_maps import Definitions, End, scaled_map
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
        return split_name(name, ("input",), interfaces, place)


def split_name(
    name: str, causalities: Sequence[str], interfaces: Mapping[str, UnitInterface], place: str
) -> tuple[str, str]:
    """Return unit and variable of "unit.variable". Raises ConfigError where it has another causality."""
    unit, _, variable = name.partition(".")
    if unit not in interfaces:
        raise ConfigError(f"{place}: there is no unit '{unit}'{nearest(unit, interfaces)}")
    interfaces[unit].require(unit, variable, causalities, place)
    return unit, variable


@dataclasses.dataclass(frozen=True)
class Carried:
    """A signal as inputs receive it: `via` is "bus.message.signal", `driver` what is said to drive them.

    `sender` is the variable behind it; None: its frames come from a log.
    """

    signal: Signal
    via: str
    driver: str
    sender: VariableInfo | None = None


@dataclasses.dataclass
class Ends:
    """The variables of the units of a run as ends of connections, which become the `network`."""

    system: System
    interfaces: Mapping[str, UnitInterface]
    slots: Slots
    network: Network

    def variable(self, name: tuple[str, str]) -> VariableInfo:
        """Return the variable (unit, name)."""
        return self.interfaces[name[0]].variables[name[1]]

    def end(self, name: tuple[str, str]) -> End:
        """Return a variable as an end of a connection."""
        v = self.variable(name)
        return End(".".join(name), v.unit, self.interfaces[name[0]].units_of_measure, v.difference)

    def map(self, source: End, target: End, scaling: Scaling, place: str) -> Affine:
        """Return the map between two ends; warnings go to the network. Raises ConfigError as scaled_map."""
        return scaled_map(source, target, scaling, self.definitions, place, self.network.warnings)

    @property
    def definitions(self) -> list[Definitions]:
        """The units of measure of all units."""
        return [interface.units_of_measure for interface in self.interfaces.values()]

    def receive(
        self, sink: tuple[str, str], carried: Carried, map_: Affine, initial: Value | None, place: str
    ) -> tuple[int, Affine]:
        """Let a signal drive an input, with what its connection says of its `initial` value.

        Return the input's mailbox with `map_`, from the signal's unit to the input's. Raises ConfigError,
        which starts with `place`, for an input that is driven already, or does not take the signal's values.
        """
        name, receiver = ".".join(sink), self.variable(sink)
        overflow = self.system.file.buses[carried.via.partition(".")[0]].overflow
        check_whole(name, receiver, carried.signal, place)
        check_boolean(carried.sender, name, receiver, carried.signal, overflow, place)
        self.network.drive(name, InputPlan(self.slots.valid[sink], None, ""), place)
        mailbox = self.network.add_mailbox(*sink, self.slots, carried.driver)
        value = initial_of(initial, carried.via, map_, receiver, self.system, place)
        if value is not None:
            self.network.initial[name] = value
        return mailbox, map_

    def status_inputs(self, via: str) -> tuple[int, ...]:
        """Return the mailboxes of inputs that receive the status of "bus.message".

        Those of units that were left out have none. Raises ConfigError for an input that there is not, that
        is driven already, or that takes no such number.
        """
        bus, _, message = via.partition(".")
        own = self.system.file.buses[bus].of_message(message)
        place, found = f"{self.system.path}: buses.{bus}.messages.{message}.status", []
        for full in own.status:
            if full.partition(".")[0] not in self.system.file.units:
                raise ConfigError(f"{place}: there is no unit of '{full}'{nearest(full, self.interfaces)}")
            if full.partition(".")[0] in self.interfaces:
                sink = self.network.input_of(full, self.interfaces, place)
                check_status(full, self.variable(sink), message, own.protected, place)
                self.network.drive(full, InputPlan(self.slots.valid[sink], None, ""), place)
                found.append(self.network.add_mailbox(*sink, self.slots, f"the status of {message}"))
        return tuple(found)


@dataclasses.dataclass
class Connecting(Ends):
    """The arguments of `connect` and what it has found so far, for what resolves them.

    By (bus, message): `senders` are the sending variables by signal, `signal_routes` the routes of the
    signals.
    """

    turns: Turns
    ideal: bool
    senders: dict[tuple[str, str], dict[str, str]] = dataclasses.field(default_factory=dict)
    signal_routes: dict[tuple[str, str], list[SignalRoute]] = dataclasses.field(default_factory=dict)
