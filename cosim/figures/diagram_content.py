"""The names in the picture of a system: what each pair of units hands over directly, and by which buses."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Mapping

from ..system.system import Connection, SystemFile
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


def content_of(system: SystemFile) -> Content:
    """Return what the picture of a system shows: the pairs of near units first."""
    numbers = {unit: i for i, unit in enumerate(system.units)}
    units = tuple(
        (f"{i}  {on_one_line(name)}", on_one_line(entry.fmu.rsplit("/", 1)[-1]))
        for i, (name, entry) in enumerate(system.units.items(), 1)
    )
    arcs: dict[tuple[int, int], list[str]] = defaultdict(list)
    for connection in system.connect:
        for sink in connection.to if connection.via is None else ():
            pair = numbers[_unit(connection.source)], numbers[_unit(sink)]
            arcs[pair] += _lines(_text(connection, sink))
    near = sorted(arcs.items(), key=lambda item: abs(item[0][0] - item[0][1]))
    buses = tuple(_bus(system, numbers, name) for name in system.buses)
    return Content(units, {pair: tuple(names) for pair, names in near}, buses)


def _unit(variable: str) -> str:
    return variable.split(".", 1)[0]


def _lines(text: str) -> list[str]:
    return [on_one_line(line) for line in broken(text, _LONGEST).split("\n")]


def _text(connection: Connection, sink: str) -> str:
    sent, received = (name.split(".", 1)[1] for name in (connection.source, sink))
    return sent if sent == received else f"{sent} → {received}"


def _bus(system: SystemFile, numbers: Mapping[str, int], name: str) -> BusContent:
    signals: dict[tuple[int, bool], dict[str, None]] = defaultdict(dict)  # without doubles, in order
    for connection in system.connect:
        if connection.via is None or connection.via.split(".")[0] != name:
            continue
        signal = connection.via.split(".")[2]
        signals[numbers[_unit(connection.source)], True][signal] = None
        for sink in connection.to:
            signals[numbers[_unit(sink)], False][signal] = None
    bus = system.buses[name]
    title = f"{name}   {bus.dbc.rsplit('/', 1)[-1]}, {bus.bitrate / 1000:g} kbit/s"
    names = {end: tuple(line for text in texts for line in _lines(text)) for end, texts in signals.items()}
    return BusContent(on_one_line(title), names)
