"""The values that receivers of a bus have before the first frame."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..can.database import Database, Signal
from ..can.resolution import physical_range
from ..errors import ConfigError
from ..interface import Value, VariableInfo
from ..system.system import System
from ..system.values import as_double, of_type
from ..texts import Texts
from ..units.measure import Affine
from .plan import MessagePlan
from .unit_maps import with_unit

_SLACK = 1e-9
"""Steps of a signal by which the end of a range, which is a product, may be another than its decimals say."""


def initial_of(
    own: Value | None, via: str, map_: Affine, variable: VariableInfo, system: System, place: str
) -> float | None:
    """Return the value of a receiver before the first frame: the connection's `own`, else its message's.

    `via` is the signal, "bus.message.signal", and `map_` takes its values to the receiver's unit. None:
    nobody gives one. Raises ConfigError for one that the receiver does not take.
    """
    if own is None:
        bus, message, signal = via.split(".", 2)
        given = system.file.buses[bus].of_message(message).initial.get(signal)
        if given is None:
            return None
        own, place = map_(given), f"{system.path}: buses.{bus}.messages.{message}.initial.{signal}: {place}"
    place = f"{place}: initial"
    return as_double(variable, of_type(own, variable, place), place, Texts())


def check_initials(
    system: System, databases: Mapping[str, Database], messages: Iterable[MessagePlan]
) -> list[str]:
    """Return a sentence for each initial value of a message's signal that nothing receives.

    `messages` are those of the run. Raises ConfigError for a signal that its message does not have or that
    cannot be used, and for a value that it cannot have.
    """
    heard = {
        f"{plan.bus}.{plan.message.name}.{route.signal.name}"
        for plan in messages
        for route in plan.routes
        if route.sinks
    } | {connection.via for connection in system.file.connect if connection.to}
    found = []
    for bus, settings in system.file.buses.items():
        for name, own in settings.messages.items():
            place = f"{system.path}: buses.{bus}.messages.{name}.initial"
            for signal_name, value in own.initial.items():
                signal = databases[bus].require(name, place).require(signal_name, place)
                _check_range(with_unit(signal, settings.units), value, f"{place}.{signal_name}")
                if f"{bus}.{name}.{signal_name}" not in heard:
                    found.append(f"{place}.{signal_name}: nothing receives this signal")
    return found


def _check_range(signal: Signal, value: float, place: str) -> None:
    low, high = physical_range(signal)
    slack = 0.0 if signal.is_float else _SLACK * abs(signal.scale)
    if not low - slack <= value <= high + slack:
        unit = f" {signal.unit}" if signal.unit else ""
        raise ConfigError(f"{place}: {value:g}{unit} is no value of the signal: [{low:g}, {high:g}]{unit}")
