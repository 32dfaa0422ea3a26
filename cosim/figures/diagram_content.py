"""The names in the picture of a system: what each pair of units hands over directly, and by which buses."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

from ..system.system import SystemFile
from ..visible import on_one_line
from .text import broken

_LONGEST = 34  # characters in a line


@dataclasses.dataclass(frozen=True)
class BusContent:
    """A bus: its `title`, and the `names` of signals that a unit, by number, sends (True) and receives."""

    title: str
    names: Mapping[tuple[int, bool], tuple[str, ...]]


@dataclasses.dataclass(frozen=True)
class Content:
    """The `units` (name and FMU), the names on the `arcs` of each pair of units, and the `buses`."""

    units: tuple[tuple[str, str], ...]
    arcs: Mapping[tuple[int, int], tuple[str, ...]]
    buses: tuple[BusContent, ...]


@dataclasses.dataclass(frozen=True)
class Wire:
    """A connection: the variable at its begin, those at its ends, and "bus.message.signal" or ""."""

    source: str
    sinks: Sequence[str]
    via: str


def content_of(system: SystemFile) -> Content:
    """Return what the picture of a system shows: the pairs of near units first."""
    return content(
        {name: entry.fmu for name, entry in system.units.items()},
        {name: bus_title(name, bus.dbc, bus.bitrate) for name, bus in system.buses.items()},
        [Wire(c.source, c.to, c.via or "") for c in system.connect],
    )


def content(units: Mapping[str, str], buses: Mapping[str, str], wires: Iterable[Wire]) -> Content:
    """Return the content of a picture of `units` with their FMUs, and of `buses` with their titles.

    Ends of wires at other units are left out.
    """
    numbers = {unit: i for i, unit in enumerate(units)}
    heads = tuple(
        (f"{i}  {on_one_line(name)}", on_one_line(fmu.rsplit("/", 1)[-1]))
        for i, (name, fmu) in enumerate(units.items(), 1)
    )
    there = [
        Wire(w.source, [sink for sink in w.sinks if _unit(sink) in numbers], w.via)
        for w in wires
        if _unit(w.source) in numbers
    ]
    arcs: dict[tuple[int, int], list[str]] = defaultdict(list)
    for wire in there:
        for sink in () if wire.via else wire.sinks:
            pair = numbers[_unit(wire.source)], numbers[_unit(sink)]
            arcs[pair] += _lines(_text(wire.source, sink))
    near = sorted(arcs.items(), key=lambda item: abs(item[0][0] - item[0][1]))
    made = tuple(_bus(name, title, there, numbers) for name, title in buses.items())
    return Content(heads, {pair: tuple(names) for pair, names in near}, made)


def bus_title(name: str, dbc: str, bitrate: float) -> str:
    """Return the text at a bus; `bitrate` is in bit/s."""
    return f"{name}   {dbc.rsplit('/', 1)[-1]}, {bitrate / 1000:g} kbit/s"


def _unit(variable: str) -> str:
    return variable.split(".", 1)[0]


def _lines(text: str) -> list[str]:
    return [on_one_line(line) for line in broken(text, _LONGEST).split("\n")]


def _text(source: str, sink: str) -> str:
    sent, received = (name.partition(".")[2] for name in (source, sink))
    return sent if sent == received else f"{sent} → {received}"


def _bus(name: str, title: str, wires: Iterable[Wire], numbers: Mapping[str, int]) -> BusContent:
    signals: dict[tuple[int, bool], dict[str, None]] = defaultdict(dict)  # without doubles, in order
    for wire in wires:
        if not wire.via or wire.via.split(".")[0] != name:
            continue
        signal = wire.via.split(".", 2)[2]
        signals[numbers[_unit(wire.source)], True][signal] = None
        for sink in wire.sinks:
            signals[numbers[_unit(sink)], False][signal] = None
    names = {end: tuple(line for text in texts for line in _lines(text)) for end, texts in signals.items()}
    return BusContent(on_one_line(title), names)
