"""The frames of a message by what they hold of the signals that somebody receives.

A frame of a multiplexed message holds those that its multiplexers' raw values select. Frames that hold the
same of them are of one variant; each variant has a number, in the order in which they come up.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..database import Message, Signal
from ..overlaps import conditions
from ..wire.payload import raw_value

Key = tuple[int, bool]
"""Identifier of a message, and True for an extended one."""


def key_of(message: Message) -> Key:
    """Return identifier and kind of a message."""
    return message.frame_id, message.extended


@dataclasses.dataclass(frozen=True)
class Variant:
    """Frames of a message that hold these signals of those that are received.

    `page` are the raw values of its multiplexers in the first such frame.
    """

    message: str
    names: tuple[str, ...]
    page: Mapping[str, int]


class Variants:
    """The variants of messages, each given with the names of its signals that are received."""

    def __init__(self, wanted: Sequence[tuple[Message, Sequence[str]]]) -> None:
        self.found: list[Variant] = []
        self._wanted = {key_of(message): (message, tuple(names)) for message, names in wanted}
        self._selecting: dict[Key, list[str]] = {}
        self._known: dict[tuple[Key, tuple[int, ...]], int] = {}
        self._by_names: dict[tuple[Key, tuple[str, ...]], int] = {}
        for key, (message, names) in self._wanted.items():
            selecting = (name for each in names for name, _ in conditions(message.signals, each))
            self._selecting[key] = list(dict.fromkeys(selecting))
            if not self._selecting[key]:
                self._known[key, ()] = self._number(key, tuple(names), {})

    @property
    def wanted(self) -> list[tuple[Message, tuple[str, ...]]]:
        """The messages, each with the names of its signals that are received."""
        return list(self._wanted.values())

    @property
    def messages(self) -> dict[Key, Message]:
        """The messages by identifier."""
        return {key: message for key, (message, _) in self._wanted.items()}

    @property
    def words(self) -> int:
        """The number of whole 8 bytes that hold the longest message."""
        return max((-(-message.length // 8) for message, _ in self._wanted.values()), default=1) or 1

    def numbers(self, key: Key, data: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Return the variants of frames of a message, -1 for those that hold no signal that is received.

        `data` are their bytes, shape (n, 64).
        """
        message, _ = self._wanted[key]
        selecting = self._selecting[key]
        if not selecting:
            return np.full(len(data), self._known[key, ()], dtype=np.int64)
        first, which = _alike(data, [message.signals[name] for name in selecting])
        numbers = [self._of_frame(key, data[i].tobytes()[: message.length]) for i in first.tolist()]
        found: NDArray[np.int64] = np.array(numbers, dtype=np.int64)[which]
        return found

    def _of_frame(self, key: Key, data: bytes) -> int:
        message, names = self._wanted[key]
        raws = tuple(raw_value(message.signals[name], data) for name in self._selecting[key])
        if (key, raws) not in self._known:
            page = dict(zip(self._selecting[key], raws, strict=True))
            held = tuple(name for name in names if _is_held(message, name, page))
            self._known[key, raws] = self._number(key, held, page) if held else -1
        return self._known[key, raws]

    def _number(self, key: Key, names: tuple[str, ...], page: Mapping[str, int]) -> int:
        if (key, names) not in self._by_names:
            self._by_names[key, names] = len(self.found)
            self.found.append(Variant(self._wanted[key][0].name, names, page))
        return self._by_names[key, names]


def _alike(data: NDArray[np.uint8], signals: Sequence[Signal]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the places of the first frames whose bits of some signals differ, in their order, and which of
    them each frame is like."""
    mask = np.zeros(data.shape[1] * 8, dtype=np.uint8)
    for signal in signals:
        mask[list(signal.bits)] = 1
    masked = data & np.packbits(mask, bitorder="little")
    used = masked[:, np.flatnonzero(np.packbits(mask))]
    whole = np.ascontiguousarray(used).view(np.dtype((np.void, used.shape[1])))[:, 0]
    _, first, which = np.unique(whole, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    return first[order], place[which]


def _is_held(message: Message, name: str, raws: Mapping[str, int]) -> bool:
    """Return True if a frame with these raw values of its multiplexers holds a signal."""
    return all(
        any(low <= raws[multiplexer] <= high for low, high in ranges)
        for multiplexer, ranges in conditions(message.signals, name)
    )
