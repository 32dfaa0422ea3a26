"""The units of a run and what connects them, as a picture in a page: SVG whose texts are text.

Units stand above each other in the order of their steps, and each connected variable has a line in the box of
its unit. Direct connections run at the right of the boxes, the buses stand at the left of them, so that no
line crosses a text.
"""

from __future__ import annotations

import dataclasses
import html
from collections.abc import Iterator, Mapping
from typing import Any

from ..figures.style import COLORS
from ..visible import on_one_line
from .manifest_facts import items_of, records_of, texts_of

MOST = 60  # variables: a picture with more lines shows nothing
_LINE, _HEAD, _GAP = 18, 24, 16  # px: a line of text, the head of a box, between two boxes
_LANE, _LETTER = 12, 6.6  # px: between two lines beside the boxes, the width of a letter
_EDGE, _PITCH = 16, 74  # px: left of the first bus, from bus to bus


@dataclasses.dataclass
class _Port:
    """A variable in a box: `end` is -1 where it sends, 1 where it receives; `lane` is its line's place."""

    unit: str
    text: str
    small: str
    sends: bool
    bus: str
    lane: int
    y: float = 0.0


def diagram(manifest: Mapping[str, Any]) -> str:
    """Return the diagram as SVG; "" without a connection, or where there are too many."""
    order = texts_of(manifest.get("order"))
    buses = [name for name, _ in items_of(manifest.get("buses"))] if not manifest.get("ideal") else []
    ports = [port for port in _ports(manifest, buses) if port.unit in order]
    if not ports or len(ports) > MOST:
        return ""
    lanes = 1 + max(port.lane for port in ports)
    left = _EDGE + _PITCH * len([bus for bus in buses if any(port.bus == bus for port in ports)])
    files = {
        name: str(dict(items_of(about)).get("fmu", "")) for name, about in items_of(manifest.get("units"))
    }
    heads = {
        unit: (f"{i}  {_short(unit)}", _short(files.get(unit, "").rsplit("/", 1)[-1]))
        for i, unit in enumerate(order, 1)
    }
    longest = [len(p.text) + len(p.small) + 6 for p in ports] + [
        len(a) + len(b) + 3 for a, b in heads.values()
    ]
    width = max(150.0, 24 + _LETTER * max(longest))
    right = left + width
    drawn, y = [], 28.0 if left > _EDGE else 8.0  # the names of the buses stand above
    for unit in order:
        inside = [port for port in ports if port.unit == unit]
        height = _HEAD + _LINE * len(inside) + (6 if inside else 0)
        drawn += list(_box(heads[unit], left, y, width, height))
        for i, port in enumerate(inside):
            port.y = y + _HEAD + _LINE * (i + 0.5)
            drawn += list(_row(port, left, right))
        y += height + _GAP
    drawn += _nets(ports, right)
    drawn += _buses(ports, manifest, left)
    size = f"{right + 24 + _LANE * lanes:.0f} {y:.0f}"
    return (
        f'<div class="wide"><svg class="diagram" viewBox="0 0 {size}" width="{size.split()[0]}" role="img" '
        f'aria-label="units and connections">{"".join(drawn)}</svg></div>'
    )


def _ports(manifest: Mapping[str, Any], buses: list[str]) -> Iterator[_Port]:
    """Yield the connected variables; those of one direct connection have one lane."""
    lane = 0
    for connection in records_of(manifest.get("connect")):
        bus, _, signal = str(connection.get("via") or "").partition(".")
        bus = bus if bus in buses else ""
        small = signal.rpartition(".")[2] if bus else ""
        for sends, name in (
            (True, str(connection.get("from", ""))),
            *((False, to) for to in texts_of(connection.get("to"))),
        ):
            unit, _, variable = name.partition(".")
            yield _Port(unit, _short(variable), _short(small), sends, bus, -1 if bus else lane)
        lane += 0 if bus else 1


def _short(text: str, most: int = 40) -> str:
    shown = on_one_line(text)
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"


def _text(x: float, y: float, text: str, kind: str, anchor: str = "start") -> str:
    return f'<text x="{x:g}" y="{y:g}" class="{kind}" text-anchor="{anchor}">{html.escape(text)}</text>'


def _box(head: tuple[str, str], x: float, y: float, width: float, height: float) -> Iterator[str]:
    yield (
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="4" '
        'fill="#f6f8fa" stroke="#808080"/>'
    )
    yield _text(x + 10, y + 17, head[0], "unit")
    yield _text(x + width - 10, y + 17, head[1], "small", "end")


def _row(port: _Port, left: float, right: float) -> Iterator[str]:
    """Yield the texts of a variable, at the side at which its line ends."""
    if port.bus:
        yield _text(left + 10, port.y + 4, port.text, "port")
        yield _text(right - 10, port.y + 4, port.small, "small", "end")
    else:
        yield _text(right - 10, port.y + 4, port.text, "port", "end")


def _nets(ports: list[_Port], right: float) -> Iterator[str]:
    """Yield the direct connections: from the sender to a lane at the right, and back to each receiver."""
    for lane in sorted({port.lane for port in ports if not port.bus}):
        ends = [port for port in ports if port.lane == lane and not port.bus]
        color = COLORS[lane % len(COLORS)]
        x = right + 20 + _LANE * lane
        heights = [port.y for port in ends]
        if len(ends) > 1:
            yield _path(f"M{x:g} {min(heights):g} V{max(heights):g}", color)
        for port in ends:
            yield _path(f"M{x:g} {port.y:g} H{right + (0 if port.sends else 6):g}", color)
            yield _dot(right, port.y, color) if port.sends else _arrow(right, port.y, -1, color)


def _buses(ports: list[_Port], manifest: Mapping[str, Any], left: float) -> Iterator[str]:
    used = [name for name, _ in items_of(manifest.get("buses")) if any(port.bus == name for port in ports)]
    for i, name in enumerate(used):
        ends = [port for port in ports if port.bus == name]
        color = ("#D55E00", "#0072B2", "#009E73")[i % 3]
        x = 24.0 + _PITCH * i
        low = max(port.y for port in ends) + 12
        yield f'<path d="M{x:g} 22 V{low:g}" stroke="{color}" stroke-width="5" fill="none"/>'
        yield _text(x - 4, 14, _short(name, 10), "unit")
        for port in ends:
            yield _path(
                f"M{x + (8 if port.sends else 0):g} {port.y:g} H{left - (0 if port.sends else 6):g}", color
            )
            yield _arrow(x + 2.5, port.y, -1, color) if port.sends else _arrow(left, port.y, 1, color)


def _path(way: str, color: str) -> str:
    return f'<path d="{way}" stroke="{color}" stroke-width="1.4" fill="none"/>'


def _dot(x: float, y: float, color: str) -> str:
    return f'<circle cx="{x:g}" cy="{y:g}" r="3" fill="{color}"/>'


def _arrow(x: float, y: float, way: int, color: str) -> str:
    """Return the head of an arrow that ends at (x, y) and points to the right (1) or to the left (-1)."""
    return f'<path d="M{x:g} {y:g} l{-8 * way} -4 v8 z" fill="{color}"/>'
