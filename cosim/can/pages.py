"""The pages of a multiplexed message: which of its signals stand in one frame together.

A multiplexer's raw value selects the signals that the rest of a frame holds. The frames of a message go
through the pages that have a connected signal, one after the other, at the message's cycle: of P pages each
is sent every P cycles, and the multiplexers of a frame say which it is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Mapping

from ..errors import ConfigError
from .database import Message, Signal, prefix
from .overlaps import conditions


@dataclasses.dataclass(frozen=True)
class Page:
    """The frames of a message with certain raw values of its multiplexers.

    `selected` are the raw values of the multiplexers that no connection feeds, by name; `signals` are the
    names of all signals that such a frame holds, in the message's order.
    """

    selected: Mapping[str, int]
    signals: tuple[str, ...]

    def of(self, message: Message) -> Message:
        """Return the message as these frames have it."""
        signals = {name: message.signals[name] for name in self.signals}
        signals |= {
            name: dataclasses.replace(signals[name], start_raw=raw) for name, raw in self.selected.items()
        }
        return dataclasses.replace(message, signals=signals)


def pages(message: Message, connected: Iterable[str], place: str = "") -> tuple[Page, ...]:
    """Return the pages that hold the connected signals, in the order of the multiplexers' values.

    There is one if no connected signal is multiplexed. A signal that cannot be used (its `problem`) stands in
    none. Raises ConfigError, which starts with `place`, where a multiplexer is connected beside a signal that
    it selects.
    """
    names = list(connected)
    left = [name for name in names if message.signals[name].multiplexer]
    for name in left:
        _check_free(message, name, names, place)
    found = [_page(message, names, _chosen(message.signals, left, names))]
    while left := [name for name in left if name not in found[-1].signals]:
        found.append(_page(message, names, _chosen(message.signals, left, names)))
    return tuple(sorted(found, key=lambda page: list(page.selected.values())))


def _check_free(message: Message, name: str, connected: Collection[str], place: str) -> None:
    for multiplexer, _ in conditions(message.signals, name):
        if multiplexer in connected:
            raise ConfigError(
                f"{prefix(place)}{message.file}: {message.name}.{multiplexer} selects {message.name}.{name}, "
                "and both are connected; leave out the multiplexer: its frames go through the pages that are "
                "connected"
            )


def _chosen(
    signals: Mapping[str, Signal], left: Collection[str], connected: Collection[str]
) -> dict[str, int]:
    """Return the raw value of each multiplexer of the frame that holds the most of the signals `left`.

    The first of them is in it. By name, in the message's order; without those that are connected.
    """
    chosen: dict[str, int] = {}
    for name in left:
        wanted = dict(conditions(signals, name))
        if any(not _in(chosen[m], ranges) for m, ranges in wanted.items() if m in chosen):
            continue  # it is in another page
        for multiplexer, ranges in wanted.items():
            chosen.setdefault(multiplexer, _raw(signals, multiplexer, ranges, left))
    for name, signal in signals.items():
        if signal.is_multiplexer and not signal.problem and name not in connected:
            chosen.setdefault(name, _usual(signals, name))
    return {name: chosen[name] for name in signals if name in chosen}


def _raw(signals: Mapping[str, Signal], multiplexer: str, ranges: _Ranges, left: Collection[str]) -> int:
    """Return the raw value within the ranges that selects the most of the signals `left`: the least such."""
    others = [r for name in left for m, r in conditions(signals, name) if m == multiplexer]
    ends = {low for of_one in others for low, _ in of_one if _in(low, ranges)}
    return min(ends, key=lambda raw: (-sum(_in(raw, of_one) for of_one in others), raw))


def _usual(signals: Mapping[str, Signal], multiplexer: str) -> int:
    """Return the raw value of a multiplexer of which no signal is connected: one that it has a page for."""
    ranges = [
        s.multiplexer_ranges
        for s in signals.values()
        if s.multiplexer == multiplexer and s.multiplexer_ranges
    ]
    start = int(signals[multiplexer].start_raw)
    if not ranges or any(_in(start, of_one) for of_one in ranges):
        return start
    return min(low for of_one in ranges for low, _ in of_one)


def _page(message: Message, connected: Collection[str], chosen: dict[str, int]) -> Page:
    """Return the page of these raw values: without a multiplexed signal of which a connection decides."""
    held = tuple(
        name
        for name, signal in message.signals.items()
        if not signal.problem
        and all(m in chosen and _in(chosen[m], ranges) for m, ranges in conditions(message.signals, name))
    )
    return Page({name: raw for name, raw in chosen.items() if name in held}, held)


_Ranges = tuple[tuple[int, int], ...]


def _in(raw: int, ranges: _Ranges) -> bool:
    return any(low <= raw <= high for low, high in ranges)
