"""Signals that share bits in a frame: for each the first other one, without a look at every pair.

Multiplexers make a tree: a signal is in the frames of its own multiplexer's values, that one in those of the
multiplexer above, up to the root, which is in every frame. Some frame holds two signals where the ways to
them part at one multiplexer by values that meet. So each multiplexer keeps the bits that are taken in it,
by ranges of its values; of signals that were met already no more than the first one at each bit counts.
"""

from __future__ import annotations

import bisect
import dataclasses
from collections.abc import Iterator, Mapping, Sequence

from .database import Signal

Ranges = tuple[tuple[int, int], ...]
_ALWAYS: Ranges = ((0, 0),)
"""The one value of the root."""


def conditions(signals: Mapping[str, Signal], name: str) -> Iterator[tuple[str, Ranges]]:
    """Yield the multiplexers on the way to a signal with the raw values that select it."""
    signal = signals[name]
    while signal.multiplexer in signals:
        yield signal.multiplexer, signal.multiplexer_ranges
        signal = signals[signal.multiplexer]


def first_overlaps(signals: Mapping[str, Signal]) -> dict[str, tuple[str, str]]:
    """Return for each signal that overlaps another, by name, the first two that do, of which it is one.

    Pairs stand in the order of their second signals, and of their first bits that are shared, counted from
    the least significant one of the second; signals that have a problem are left out. All multiplexers on the
    way to the others are among `signals`.
    """
    names = [name for name, signal in signals.items() if not signal.problem]
    ways = [list(conditions(signals, name)) for name in names]
    tree = _tree(ways)
    pairs: list[tuple[int, int] | None] = []
    for i, (name, way) in enumerate(zip(names, ways, strict=True)):
        mask = _mask(signals[name])
        pairs.append(None)
        met = [each for each in _together(tree, way) if each.bits & mask]
        if met:
            shared = 0
            for each in met:
                shared |= each.bits & mask
            bit = next(bit for bit in signals[name].bits if shared >> bit & 1)
            pairs[i] = min(each.first(bit) for each in met if each.bits >> bit & 1), i
            for each in met:
                each.mark(mask, pairs, i)
        for each in _places(tree, way):
            each.add(i, mask, pairs[i] is None)
    return {
        name: (names[pair[0]], names[pair[1]])
        for name, pair in zip(names, pairs, strict=True)
        if pair is not None
    }


def _mask(signal: Signal) -> int:
    """Return the bits of a signal as those of a number."""
    if signal.little_endian:
        return (1 << signal.length) - 1 << signal.start
    return sum(1 << bit for bit in signal.bits)


@dataclasses.dataclass
class _Taken:
    """Bits that signals take, which have numbers in their order: `bits` are those of a number.

    `owners` has each signal that was the first one at some bits, with these; `alone` those that overlap
    nothing up to now, with all of theirs.
    """

    bits: int = 0
    owners: list[tuple[int, int]] = dataclasses.field(default_factory=list)
    alone: list[tuple[int, int]] = dataclasses.field(default_factory=list)
    bits_alone: int = 0

    def add(self, number: int, mask: int, alone: bool) -> None:
        """Take the bits of a signal."""
        if new := mask & ~self.bits:
            self.owners.append((number, new))
            self.bits |= new
        if alone:
            self.alone.append((number, mask))
            self.bits_alone |= mask

    def first(self, bit: int) -> int:
        """Return the number of the first signal at a bit that is taken."""
        return next(number for number, bits in self.owners if bits >> bit & 1)

    def mark(self, mask: int, pairs: list[tuple[int, int] | None], number: int) -> None:
        """Note for signals that were alone up to now that they overlap a signal of this number."""
        if not self.bits_alone & mask:
            return
        left, self.alone, self.bits_alone = self.alone, [], 0
        for other, bits in left:
            if pairs[other] is None and bits & mask:
                pairs[other] = other, number
            elif pairs[other] is None:
                self.alone.append((other, bits))
                self.bits_alone |= bits


@dataclasses.dataclass
class _Multiplexer:
    """Bits that are taken in the frames of a multiplexer, by the stretches of its values between `limits`.

    `own` are the signals that it selects itself, `below` the multiplexers; `whole` is of all below it.
    """

    limits: list[int] = dataclasses.field(default_factory=list)
    own: dict[int, _Taken] = dataclasses.field(default_factory=dict)
    below: dict[int, list[str]] = dataclasses.field(default_factory=dict)
    whole: _Taken = dataclasses.field(default_factory=_Taken)

    def stretches(self, ranges: Ranges) -> Iterator[int]:
        """Yield the numbers of the stretches that the ranges hold."""
        for low, high in ranges:
            yield from range(bisect.bisect_left(self.limits, low), bisect.bisect_left(self.limits, high + 1))


Way = Sequence[tuple[str, Ranges]]
_ROOT = ""


def _up(way: Way) -> list[tuple[str, Ranges]]:
    """Return the way to a signal from its own multiplexer to the root."""
    return [*way, (_ROOT, _ALWAYS)]


def _tree(ways: Sequence[Way]) -> dict[str, _Multiplexer]:
    """Return the multiplexers on the ways to signals, by name, with their stretches and those below them."""
    limits: dict[str, set[int]] = {}
    edges: dict[tuple[str, str], Ranges] = {}
    for way in map(_up, ways):
        below = None
        for name, ranges in way:
            limits.setdefault(name, set()).update(low for low, _ in ranges)
            limits[name].update(high + 1 for _, high in ranges)
            if below is not None:
                edges[name, below] = ranges
            below = name
    tree = {name: _Multiplexer(sorted(found)) for name, found in limits.items()}
    for (name, below), ranges in edges.items():
        for stretch in tree[name].stretches(ranges):
            tree[name].below.setdefault(stretch, []).append(below)
    return tree


def _together(tree: Mapping[str, _Multiplexer], way: Way) -> Iterator[_Taken]:
    """Yield what is taken in the frames that may hold a signal to which this is the way."""
    before = ""
    for name, ranges in _up(way):
        multiplexer, seen = tree[name], {before}
        for stretch in multiplexer.stretches(ranges):
            if own := multiplexer.own.get(stretch):
                yield own
            for below in multiplexer.below.get(stretch, ()):
                if below not in seen:
                    seen.add(below)
                    yield tree[below].whole
        before = name


def _places(tree: Mapping[str, _Multiplexer], way: Way) -> Iterator[_Taken]:
    """Yield where the bits of a signal to which this is the way are taken."""
    up = _up(way)
    name, ranges = up[0]
    for stretch in tree[name].stretches(ranges):
        yield tree[name].own.setdefault(stretch, _Taken())
    for name, _ in way:
        yield tree[name].whole
