"""Signals of a frame that nothing fills: neither a connection nor a protection, nor the turn of its pages."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from typing import Literal

from .database import Message, Signal
from .framing import Framing

Reason = Literal["not available", "start value", "zero"]


@dataclasses.dataclass(frozen=True)
class Unfilled:
    """A signal that nothing fills, the raw value that is sent in its place, and what this one is."""

    signal: Signal
    raw: float | int
    reason: Reason


def unfilled(message: Message, connected: Collection[str], framing: Framing | None = None) -> list[Unfilled]:
    """Return the signals of a message that neither the `connected` ones nor a protection are.

    A multiplexer is none of them: it says which page a frame is. Nor is a signal that no frame holds.
    """
    filled = set(connected)
    if framing is not None and framing.protection is not None:
        filled |= {signal.name for signal in framing.protection.signals}
    return [
        _sent(signal)
        for name, signal in message.signals.items()
        if name not in filled and _held(signal) and not signal.is_multiplexer
    ]


def raw_values(message: Message) -> dict[str, float | int]:
    """Return the raw value that each signal has where nothing fills it; a multiplexer's is that of the page.

    Signals that no frame holds are left out.
    """
    return {
        name: signal.start_raw if signal.is_multiplexer else _sent(signal).raw
        for name, signal in message.signals.items()
        if _held(signal)
    }


def _held(signal: Signal) -> bool:
    """Return True where a frame holds the signal: with a `problem` its bits may be another's, or beyond."""
    return not signal.problem and not (signal.is_float and signal.length not in (32, 64))


def _sent(signal: Signal) -> Unfilled:
    code = signal.not_available
    low, high = signal.raw_type_range
    if code is not None and not signal.is_float and low <= code <= high:
        return Unfilled(signal, code, "not available")
    return Unfilled(signal, signal.start_raw, "start value" if signal.start_raw else "zero")
