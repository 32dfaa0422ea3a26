"""The types that a connection takes from a sender to a receiver.

What is certain before a step is refused here; whether a number is one of the receiver's type, a unit checks
when it is set.
"""

from __future__ import annotations

from ..can.bus_settings import Overflow
from ..can.database import Signal
from ..errors import ConfigError
from ..interface import VariableInfo


def check_types(
    source: tuple[str, str], sender: VariableInfo, sink: tuple[str, str], receiver: VariableInfo, place: str
) -> None:
    """Raise ConfigError unless a direct connection can take the sender's FMI type to the receiver's."""
    whole = ("Integer", "Enumeration")
    fits = (
        sender.type == receiver.type
        or (receiver.type == "Real" and sender.type != "String")
        or (receiver.type in whole and sender.type in (*whole, "Boolean"))
    )
    if not fits:
        raise ConfigError(
            f"{place}: {'.'.join(source)} is of type {sender.type}, {'.'.join(sink)} of type {receiver.type}"
        )


def check_no_text(name: str, variable: VariableInfo, via: str, place: str) -> None:
    """Raise ConfigError for a String at an end of a bus signal."""
    if variable.type == "String":
        raise ConfigError(
            f"{place}: {name} is a String, and the signal {via} carries numbers; texts are connected without "
            "'via'"
        )


def check_whole(name: str, receiver: VariableInfo, signal: Signal, place: str) -> None:
    """Raise ConfigError for a receiver of whole numbers of a signal that may carry others."""
    if receiver.type != "Real" and not (
        float(signal.scale).is_integer() and float(signal.offset).is_integer()
    ):
        raise ConfigError(
            f"{place}: {name} is of type {receiver.type}, the signal has scale {signal.scale} and "
            f"offset {signal.offset}"
        )


def check_boolean(
    sender: VariableInfo | None,
    name: str,
    receiver: VariableInfo,
    signal: Signal,
    overflow: Overflow,
    place: str,
) -> None:
    """Raise ConfigError for a Boolean receiver of a signal that may carry another number than 0 and 1.

    From a Boolean sender, or an enumeration of 0 and 1, it carries no other. Without a sender its frames come
    from a log, and have what the database says.
    """
    if receiver.type != "Boolean" or (sender is not None and sender.type == "Boolean"):
        return
    if sender is not None and sender.choices and set(sender.choices) <= {0, 1}:
        return
    low, high = signal.raw_type_range
    least, most = sorted((low * signal.scale + signal.offset, high * signal.scale + signal.offset))
    if overflow != "wrap" or sender is None:
        least = least if signal.minimum is None else max(least, signal.minimum)
        most = most if signal.maximum is None else min(most, signal.maximum)
    if least < 0.0 or most > 1.0:
        whose = (
            "of a log: give it the limits [0|1] in the database, where its sender has no others"
            if sender is None
            else f"of {sender.name}, which is of type {sender.type}"
        )
        raise ConfigError(
            f"{place}: {name} is a Boolean, 0 or 1, and the signal {signal.name} carries numbers from "
            f"{least:g} to {most:g} {whose}"
        )


def check_status(name: str, variable: VariableInfo, message: str, protected: bool, place: str) -> None:
    """Raise ConfigError for an input that does not take the status of a message, which may be `protected`."""
    takes = variable.type != "String" and not (protected and variable.type == "Boolean")
    if not takes:
        kind = "a Boolean, 0 or 1" if variable.type == "Boolean" else f"a {variable.type}"
        raise ConfigError(
            f"{place}: {name} is {kind}, and the status of {message} is a number"
            f"{' up to 64' if protected else ''}, which a Real, an Integer or an Enumeration takes"
        )
