"""Settings of buses and messages that do nothing in a run, each said with what would make it count.

Left out are those that a default has, and messages whose sender or receivers a scenario leaves out.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

from ..can.as_sent import as_sent
from ..can.bus_settings import BusSettings, BusVariation
from ..can.database import Database, Message
from ..can.message_settings import MessageSettings
from ..can.quantization import decode
from ..errors import ConfigError
from ..interface import UnitInterface
from ..system.problems import shown
from ..system.system import System
from .network import Network
from .plan import MessagePlan

_MOST = 5  # signals in a sentence
_OF_FRAMES = ("e2e", "checksum", "timeout", "status")
_OF_SENDERS = ("start_delay", "send_type", "min_interval", "jitter")
_OF_WATCHES = ("start_delay", "send_type")  # which say when a frame should come, too


@dataclasses.dataclass(frozen=True)
class _Bus:
    """A bus, with its messages that a connection of the file or a log of the run has, as they are sent.

    `heard` are those that have receivers in the file, `plans` those of the run.
    """

    name: str
    place: str
    settings: BusSettings
    database: Database
    carried: Mapping[str, Message]
    heard: frozenset[str]
    plans: Mapping[str, Sequence[MessagePlan]]
    varied: BusVariation

    @property
    def timed(self) -> bool:
        """True where frames take time."""
        return self.settings.timing == "frame"


def idle_settings(system: System, network: Network, varied: BusVariation | None) -> list[str]:
    """Return a sentence for each key of a bus, or of a message, that has no effect in a run.

    `varied` is the variation of all buses that is in the settings already.
    """
    found: list[str] = []
    for name, settings in system.file.buses.items():
        bus = _bus(system, network, name, settings, varied or BusVariation())
        if bus.carried:
            found += _of_bus(bus)
        for message, own in settings.messages.items():
            found += _of_message(bus, message, own)
    return found


def _bus(system: System, network: Network, name: str, settings: BusSettings, varied: BusVariation) -> _Bus:
    database = network.databases[name]
    plans: dict[str, list[MessagePlan]] = {}
    for plan in network.messages:
        if plan.bus == name:
            plans.setdefault(plan.message.name, []).append(plan)
    via = [(c.via.split(".", 2), c) for c in system.file.connect if c.via is not None]
    connected: dict[str, object] = {parts[1]: None for parts, _ in via if parts[0] == name}
    return _Bus(
        name,
        f"{system.path}: buses.{name}",
        settings,
        database,
        {each: as_sent(database.require(each), settings) for each in {**connected, **plans}},
        frozenset(parts[1] for parts, connection in via if parts[0] == name and connection.to),
        plans,
        varied,
    )


# ---- buses


def _of_bus(bus: _Bus) -> Iterator[str]:
    settings = bus.settings
    for key in ("jitter", "bit_error_rate"):
        if getattr(settings, key) and not bus.timed:
            where = "bus variation: jitter" if key == "jitter" and bus.varied.jitter else f"{bus.place}.{key}"
            yield _untimed(where, getattr(settings, key))
    varied = bus.varied.seed or bus.varied.loss
    if settings.seed and not varied and not (bus.timed and _draws(bus)):
        frames = "" if bus.timed else ' with timing = "frame"'
        yield (
            f"{bus.place}.seed = {settings.seed} does nothing: nothing is drawn on this bus; it counts where "
            f"`jitter` or `bit_error_rate` is given{frames}"
        )
    if settings.data_bitrate is not None and not any(message.fd for message in bus.carried.values()):
        yield (
            f"{bus.place}.data_bitrate = {settings.data_bitrate} does nothing: no message that is sent on "
            "this bus is a CAN FD frame; `fd = true` makes them so"
        )
    of_file = [bus.database.require(name).cycle_time for name in bus.carried]
    own = [settings.of_message(name).cycle_time for name in bus.carried]
    if settings.cycle_time is not None and None not in [a or b for a, b in zip(own, of_file, strict=True)]:
        yield (
            f"{bus.place}.cycle_time = {settings.cycle_time:g} does nothing: each message that is sent on "
            "this bus has a cycle time, which counts before it; `cycle_time` of a message replaces that of "
            "the database"
        )
    if settings.rounding != "nearest" and settings.resolution == "ideal" and bus.varied.resolution != "ideal":
        yield (
            f'{bus.place}.rounding = "{settings.rounding}" does nothing with resolution = "ideal", in which '
            "values are not quantized"
        )


def _untimed(where: str, value: float) -> str:
    return (
        f'{where} = {value:g} does nothing with timing = "instant", in which frames take no time; it counts '
        'with timing = "frame"'
    )


def _draws(bus: _Bus) -> bool:
    return bus.settings.bit_error_rate > 0.0 or any(bus.settings.jitter_of(name) for name in bus.carried)


# ---- messages


def _of_message(bus: _Bus, name: str, own: MessageSettings) -> Iterator[str]:
    place = f"{bus.place}.messages.{name}"
    given = [key for key in MessageSettings.model_fields if getattr(own, key) != _plain(key)]
    if own.status_optional and not own.status:
        yield f"{place}.status_optional = true does nothing: there is no `status`"
    if name not in bus.carried:
        keys = [f"`{key}`" for key in given if key not in ("initial", "status_optional")]
        if keys:
            yield (
                f"{place}: {' and '.join(keys)} {'does' if len(keys) == 1 else 'do'} nothing: no connection "
                f'sends this message, and no log of this run has it; it counts with via = "{bus.name}.{name}.'
                'SIGNAL"'
            )
        return
    replayed = name in bus.plans and all(plan.replayed for plan in bus.plans[name])
    if own.jitter and not bus.timed and not replayed:
        yield _untimed(f"{place}.jitter", own.jitter)
    if own.fd and bus.carried[name].j1939:
        yield f"{place}.fd = true does nothing: a parameter group of J1939 is never a CAN FD frame"
    if own.timeout is not None and name not in bus.heard and not own.status and not _received(bus, name):
        yield (
            f"{place}.timeout = {own.timeout} does nothing: nobody receives this message; it counts with an "
            "input in the `to` of a connection, or in `status`"
        )
    if bus.settings.resolution == "ideal" and bus.varied.resolution != "ideal":
        for key in (key for key in _OF_FRAMES if key in given):
            yield (
                f'{place}.{key} does nothing with resolution = "ideal", in which values are not quantized '
                "and make no frames"
            )
    if replayed:
        yield from _replayed(place, own, bus.plans[name])
    if own.on_timeout == "sna":
        yield from _without_code(place, bus.plans.get(name, ()))


def _plain(key: str) -> object:
    return MessageSettings.model_fields[key].default


def _received(bus: _Bus, name: str) -> bool:
    return any(route.sinks for plan in bus.plans.get(name, ()) for route in plan.routes)


def _replayed(place: str, own: MessageSettings, plans: Sequence[MessagePlan]) -> Iterator[str]:
    """Yield a sentence for keys by which a unit would send a message whose frames come from a log."""
    watched = any(plan.framing is not None and plan.framing.watched(own) for plan in plans)
    for key in _OF_SENDERS:
        if getattr(own, key) and not (watched and key in _OF_WATCHES):
            yield (
                f"{place}.{key} = {shown(getattr(own, key))} does nothing: frames of this message come from "
                "a log, at its times"
            )


def _without_code(place: str, plans: Sequence[MessagePlan]) -> Iterator[str]:
    signals = {route.signal.name: route.signal for plan in plans for route in plan.routes if route.sinks}
    without = [name for name, signal in signals.items() if signal.not_available is None]
    if not without:
        return
    names = ", ".join(without[:_MOST]) + (f" and {len(without) - _MOST} more" if without[_MOST:] else "")
    has, its = ("has", "its") if len(without) == 1 else ("have", "their")
    yield (
        f'{place}.on_timeout = "sna" does nothing for {names}, which {has} no "not available" code in the '
        f"database: after a timeout {its} receivers keep the last value; it counts with a value of the "
        'signal named SNA, and on_timeout = "initial" needs none'
    )


def check_codes(system: System, network: Network, interfaces: Mapping[str, UnitInterface]) -> None:
    """Raise ConfigError where a timeout would give a Boolean the "not available" code of its signal."""
    inputs = {plan.mailbox: name for name, plan in network.inputs.items() if plan.mailbox is not None}
    for plan in network.messages:
        if plan.framing is None or plan.settings.of_message(plan.message.name).on_timeout != "sna":
            continue
        for route in plan.routes:
            if (code := route.signal.not_available) is None:
                continue
            for mailbox, map_ in route.sinks:
                unit, _, name = inputs[mailbox].partition(".")
                value = map_(decode(route.signal, code))
                if interfaces[unit].variables[name].type == "Boolean" and value not in (0.0, 1.0):
                    raise ConfigError(
                        f"{system.path}: buses.{plan.bus}.messages.{plan.message.name}.on_timeout = "
                        f'"sna": {inputs[mailbox]} is a Boolean, 0 or 1, and the code of {route.signal.name} '
                        f'is {value:g}; "initial" gives it the value before the first frame'
                    )
