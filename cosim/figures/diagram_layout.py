"""Places of all that is in the picture of a system, in inches: no name lies on a line or on another name.

Units stand in a row, the direct connections of a pair of units go over them as an arc, and lines go down to
the buses. Arcs of near units stand below those of far ones and end outside of them, so that the line of an
arc crosses no lower one of the same unit. Where a name has no room between the lines that pass at its height,
the units beside it move apart.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence

from .diagram_content import Content
from .letter_widths import width

Measure = Callable[[str], float]

NAME, UNIT, TITLE = 7.5, 9.5, 9.0  # sizes of the texts in points; units and buses are bold
_ROUNDING = 1.04  # how much wider a text may be drawn, by hinting
LINE = 0.13  # height of a line of names
BOX = 0.42  # height of a unit
_INSET = 0.14  # from a corner of a unit to the first line
_PORT = 0.11  # between two lines that end at a unit
_GAP = 0.4  # between two units, the least
_MARGIN = 0.06  # between a name and a line
_STEP = 0.16  # between an arc and the names of the one below


@dataclasses.dataclass(frozen=True)
class Box:
    """A unit: its middle `x`, and its `width`; its middle is at the height 0."""

    x: float
    width: float


@dataclasses.dataclass(frozen=True)
class Arc:
    """The line from a unit at `begin` up to the height `y`, and down at `end`; its names stand at `label`."""

    begin: float
    end: float
    y: float
    label: float
    names: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Drop:
    """The line at `x` between a unit and the bus at height `y`, and the names beside it, from `top` down."""

    x: float
    y: float
    sends: bool
    top: float
    names: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Bar:
    """A bus: a line from `left` to `right` at the height `y`."""

    left: float
    right: float
    y: float


@dataclasses.dataclass(frozen=True)
class Layout:
    """All places, and the edges of the picture."""

    boxes: tuple[Box, ...]
    arcs: tuple[Arc, ...]
    drops: tuple[Drop, ...]
    bars: tuple[Bar, ...]
    left: float
    right: float
    bottom: float
    top: float


def laid_out(content: Content) -> Layout:
    """Return the places of a picture's content, for a font that is as wide as DejaVu Sans or less."""

    def wide(text: str, size: float = NAME, *, bold: bool = False) -> float:
        return _ROUNDING * width(text, size, bold=bold)

    headings = [max(wide(name, UNIT, bold=True), wide(fmu)) for name, fmu in content.units]
    titles = [wide(bus.title, TITLE, bold=True) for bus in content.buses]
    return lay_out(content, wide, headings, titles)


def lay_out(content: Content, measure: Measure, headings: Sequence[float], titles: Sequence[float]) -> Layout:
    """Return the places of a picture's content.

    `measure` gives the width of a name; `headings` are those of the texts of each unit, `titles` of each bus.
    """
    row = _Row(content, headings)
    levels = _levels(content, row)
    for pair, names in content.arcs.items():
        row.make_room_above(pair, levels, max(map(measure, names)) + 2.0 * _MARGIN)
    for bus in range(len(content.buses)):
        row.make_room_below(bus, measure)
    arcs = tuple(
        Arc(*row.ends(pair), levels[pair], _middle(row.free(pair, levels)), names)
        for pair, names in content.arcs.items()
    )
    drops, bars = _below(content, row, measure, titles)
    edges = [
        *(x for i in range(len(content.units)) for x in row.sides(i)),
        *(x for bar in bars for x in (bar.left, bar.right)),
    ]
    top = max((arc.y + LINE * len(arc.names) for arc in arcs), default=BOX / 2.0)
    bottom = bars[-1].y - 2.0 * LINE if bars else -BOX / 2.0
    boxes = tuple(Box(row.x(i), width) for i, width in enumerate(row.widths))
    return Layout(boxes, arcs, drops, bars, min(edges), max(edges), bottom, top)


Pair = tuple[int, int]


class _Row:
    """The row of units, with the places at which lines end at them; it grows as names need room."""

    def __init__(self, content: Content, headings: Sequence[float]) -> None:
        self._content = content
        self._ports: dict[tuple[Pair, bool], tuple[int, bool, int]] = {}
        counts: dict[tuple[int, bool], int] = {}
        # an arc from a unit to itself is inside of all others
        for pair in sorted(content.arcs, key=lambda pair: pair[0] == pair[1]):
            for begins in (True, False):
                unit, right = pair[0 if begins else 1], (pair[1] >= pair[0]) == begins
                self._ports[pair, begins] = unit, right, counts.get((unit, right), 0)
                counts[unit, right] = counts.get((unit, right), 0) + 1
        needed = [
            2.0 * _INSET + _PORT * (counts.get((i, False), 0) + counts.get((i, True), 0))
            for i in range(len(headings))
        ]
        self.widths = [max(text + 0.2, ports) for text, ports in zip(headings, needed, strict=True)]
        self._gaps = [_GAP] * (len(headings) - 1)

    def x(self, unit: int) -> float:
        return sum(self.widths[:unit]) + sum(self._gaps[:unit]) + self.widths[unit] / 2.0

    def sides(self, unit: int) -> tuple[float, float]:
        half = self.widths[unit] / 2.0
        return self.x(unit) - half, self.x(unit) + half

    def _port(self, pair: Pair, begins: bool) -> float:
        unit, right, place = self._ports[pair, begins]
        low, high = self.sides(unit)
        return high - _INSET - _PORT * place if right else low + _INSET + _PORT * place

    def ends(self, pair: Pair) -> tuple[float, float]:
        return self._port(pair, True), self._port(pair, False)

    def free(self, pair: Pair, levels: Mapping[Pair, float]) -> tuple[float, float]:
        """Return the widest part of an arc that no line of a higher one crosses."""
        spans = self._parts(pair, levels)
        return max(((low, high) for low, high, _ in spans), key=lambda span: span[1] - span[0])

    def _parts(self, pair: Pair, levels: Mapping[Pair, float]) -> Iterator[tuple[float, float, Pair]]:
        """Yield the parts of an arc between the lines of higher ones, with the units at both sides."""
        crossing = [
            (other, begins) for other in levels if levels[other] > levels[pair] for begins in (True, False)
        ]
        own = [(pair, True), (pair, False)]
        low, high = sorted(self.ends(pair))
        lines = sorted(
            (self._port(*port), self._ports[port][0])
            for port in crossing + own
            if low <= self._port(*port) <= high
        )
        for (a, left), (b, right) in itertools.pairwise(lines):
            yield a, b, (left, right)

    def make_room_above(self, pair: Pair, levels: Mapping[Pair, float], width: float) -> None:
        """Move units apart until a part of an arc has the room for its names."""
        low, high = self.free(pair, levels)
        if high - low >= width:
            return
        if pair[0] == pair[1]:
            self.widths[pair[0]] += width - (high - low)
            return
        between = [part for part in self._parts(pair, levels) if part[2][0] != part[2][1]]
        low, high, (left, _) = max(between, key=lambda part: part[1] - part[0])
        self._gaps[left] += width - (high - low)

    def drop(self, unit: int, bus: int, sends: bool) -> float:
        """Return where the line between a unit and a bus stands: those of nearer buses are the outer ones."""
        buses = [b for b in range(len(self._content.buses)) if (unit, sends) in self._content.buses[b].names]
        away = 0.06 + _PORT * (len(buses) - 1 - buses.index(bus))
        return self.x(unit) + (-away if sends else away)

    def passing(self, unit: int, bus: int) -> list[float]:
        """Return the lines of a unit that there are above a bus and below the one before."""
        buses = range(bus, len(self._content.buses))
        return [
            self.drop(unit, b, sends)
            for b in buses
            for sends in (True, False)
            if (unit, sends) in self._content.buses[b].names
        ]

    def make_room_below(self, bus: int, measure: Measure) -> None:
        """Move units apart until no line passes through the names of a bus's signals."""
        for (unit, sends), names in self._content.buses[bus].names.items():
            room = max(map(measure, names)) + 2.0 * _MARGIN
            others = range(unit) if sends else range(unit + 1, len(self.widths))
            for other in others:
                for line in self.passing(other, bus):
                    lacking = room - abs(self.drop(unit, bus, sends) - line)
                    if lacking > 0.0:
                        self._gaps[unit - 1 if sends else unit] += lacking


def _levels(content: Content, row: _Row) -> dict[Pair, float]:
    """Return the height of each arc: above all placed before it that it passes over."""
    levels: dict[Pair, float] = {}
    for pair in content.arcs:
        low, high = sorted(row.ends(pair))
        under = [
            levels[other] + LINE * len(content.arcs[other])
            for other in levels
            if max(low, min(row.ends(other))) <= min(high, max(row.ends(other)))
        ]
        levels[pair] = max(under, default=BOX / 2.0 + 0.04) + _STEP
    return levels


def _middle(span: tuple[float, float]) -> float:
    return (span[0] + span[1]) / 2.0


def _below(
    content: Content, row: _Row, measure: Measure, titles: Sequence[float]
) -> tuple[tuple[Drop, ...], tuple[Bar, ...]]:
    """Return the lines to the buses and the buses, from the upper to the lower one."""
    drops: list[Drop] = []
    bars: list[Bar] = []
    edge = -BOX / 2.0
    for number, bus in enumerate(content.buses):
        sent, received = (
            max((len(names) for (_, sends), names in bus.names.items() if sends is way), default=0)
            for way in (True, False)
        )
        top = edge - _MARGIN
        y = top - LINE * (sent + received) - 0.26
        reach = [row.sides(0)[0], row.sides(len(row.widths) - 1)[1]]
        for (unit, sends), names in bus.names.items():
            x = row.drop(unit, number, sends)
            # names of received signals stand below those of sent ones, which reach the same columns
            drops.append(Drop(x, y, sends, top if sends else top - LINE * sent, names))
            room = max(map(measure, names)) + _MARGIN
            reach.append(x - room if sends else x + room)
        later = [x for unit in range(len(row.widths)) for x in row.passing(unit, number + 1)]
        title = min(later) - titles[number] - 2.0 * _MARGIN if later else reach[0]
        left = min(*reach, title)
        bars.append(Bar(left, max(*reach, left + titles[number]), y))
        edge = y - 1.6 * LINE
    return tuple(drops), tuple(bars)
