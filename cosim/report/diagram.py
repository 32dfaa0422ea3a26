"""The units of a run and what connects them, as a picture in a page: SVG whose texts are text.

Its places are those of the picture that `evcosim info --diagram` draws (`figures.diagram_layout`).
"""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping
from typing import Any

from ..figures.diagram_content import Content, Wire, bus_title, content
from ..figures.diagram_layout import BOX, LINE, NAME, TITLE, UNIT, Arc, Box, Drop, Layout, laid_out
from .manifest_facts import items_of, records_of, texts_of

MOST = 60  # names: a picture with more shows nothing, and takes long
_INCH = 115.2  # px: names of 12 px
_EDGE = 0.12  # inches around the picture
_DIRECT, _BUS = "#0072B2", "#D55E00"


def diagram(manifest: Mapping[str, Any]) -> str:
    """Return the diagram as SVG; "" without a connection, or where there are too many."""
    shown = _content(manifest)
    names = [*shown.arcs.values(), *(names for bus in shown.buses for names in bus.names.values())]
    if not 0 < sum(map(len, names)) <= MOST:
        return ""
    layout = laid_out(shown)
    width, height = layout.right - layout.left + 2.0 * _EDGE, layout.top - layout.bottom + 2.0 * _EDGE
    size = f"{_INCH * width:.0f} {_INCH * height:.0f}"
    return (
        f'<div class="wide"><svg class="diagram" viewBox="0 0 {size}" width="{size.split()[0]}" role="img" '
        f'aria-label="units and connections">{"".join(_Pen(layout).drawn(shown))}</svg></div>'
    )


def _content(manifest: Mapping[str, Any]) -> Content:
    """Return what the picture shows: without a bus, all connections of an ideal run are direct."""
    files = {
        name: str(dict(items_of(about)).get("fmu", "")) for name, about in items_of(manifest.get("units"))
    }
    ideal = bool(manifest.get("ideal"))
    buses = {name: _title(name, dict(items_of(about))) for name, about in items_of(manifest.get("buses"))}
    wires = [
        Wire(str(c.get("from", "")), texts_of(c.get("to")), "" if ideal else str(c.get("via") or ""))
        for c in records_of(manifest.get("connect"))
    ]
    order = dict.fromkeys(texts_of(manifest.get("order")))
    return content({unit: files.get(unit, "") for unit in order}, {} if ideal else buses, wires)


def _title(name: str, about: Mapping[str, Any]) -> str:
    dbc, bitrate = about.get("dbc"), about.get("bitrate")
    return (
        bus_title(name, dbc, bitrate) if isinstance(dbc, str) and isinstance(bitrate, int | float) else name
    )


class _Pen:
    """Draws a layout; its places in inches, upward, become pixels, downward."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout

    def drawn(self, shown: Content) -> Iterator[str]:
        layout = self._layout
        for box, (name, fmu) in zip(layout.boxes, shown.units, strict=True):
            yield from self._unit(box, name, fmu)
        for arc in layout.arcs:
            yield from self._arc(arc)
        for bar, bus in zip(layout.bars, shown.buses, strict=True):
            yield (
                f'<path d="M{self._x(bar.left)} {self._y(bar.y)} H{self._x(bar.right)}" stroke="{_BUS}" '
                'stroke-width="6" stroke-linecap="round" fill="none"/>'
            )
            yield self._text(bar.left, bar.y - 0.19, bus.title, TITLE, "bus", "start")
        for drop in layout.drops:
            yield from self._drop(drop)

    def _x(self, x: float) -> str:
        return f"{_INCH * (x - self._layout.left + _EDGE):.1f}"

    def _y(self, y: float) -> str:
        return f"{_INCH * (self._layout.top + _EDGE - y):.1f}"

    def _text(self, x: float, y: float, text: str, size: float, kind: str, anchor: str) -> str:
        """Return a text whose letters stand on the height y."""
        return (
            f'<text x="{self._x(x)}" y="{self._y(y)}" class="{kind}" font-size="{size / 72.0 * _INCH:.1f}" '
            f'text-anchor="{anchor}">{html.escape(text)}</text>'
        )

    def _unit(self, box: Box, name: str, fmu: str) -> Iterator[str]:
        yield (
            f'<rect x="{self._x(box.x - box.width / 2.0)}" y="{self._y(BOX / 2.0)}" '
            f'width="{_INCH * box.width:.1f}" height="{_INCH * BOX:.1f}" rx="6" fill="#f6f8fa" '
            'stroke="#1a1a1a"/>'
        )
        yield self._text(box.x, 0.04, name, UNIT, "unit", "middle")
        yield self._text(box.x, -0.135, fmu, NAME, "small", "middle")

    def _arc(self, arc: Arc) -> Iterator[str]:
        top, begin, end = self._y(arc.y), self._x(arc.begin), self._x(arc.end)
        yield self._line(f"M{begin} {self._y(BOX / 2.0)} V{top} H{end} V{self._y(BOX / 2.0 + 0.06)}", _DIRECT)
        yield self._head(arc.end, BOX / 2.0, _DIRECT, down=True)
        for i, name in enumerate(reversed(arc.names)):
            yield self._text(arc.label, arc.y + 0.055 + LINE * i, name, NAME, "name", "middle")

    def _drop(self, drop: Drop) -> Iterator[str]:
        tip = drop.y + 0.03 if drop.sends else -BOX / 2.0
        ends = (-BOX / 2.0, tip + 0.06) if drop.sends else (drop.y, tip - 0.06)
        yield self._line(f"M{self._x(drop.x)} {self._y(ends[0])} V{self._y(ends[1])}", _BUS)
        yield self._head(drop.x, tip, _BUS, down=drop.sends)
        aside, anchor = (-0.05, "end") if drop.sends else (0.05, "start")
        for i, name in enumerate(drop.names):
            yield self._text(drop.x + aside, drop.top - 0.1 - LINE * i, name, NAME, "name", anchor)

    def _line(self, way: str, color: str) -> str:
        return f'<path d="{way}" stroke="{color}" stroke-width="2" fill="none"/>'

    def _head(self, x: float, y: float, color: str, *, down: bool) -> str:
        """Return the head of an arrow that ends at (x, y)."""
        back = -10 if down else 10
        return f'<path d="M{self._x(x)} {self._y(y)} l-4.5 {back} h9 z" fill="{color}"/>'
