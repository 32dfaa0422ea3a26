"""A system file as a picture: units in the order of their steps, direct connections above, buses below."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from typing import TYPE_CHECKING, Any

from ..system.system import Connection, SystemFile
from ..visible import on_one_line
from .canvas import canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BOX = (2.8, 0.9)  # width and height of a unit
_PITCH = 4.4  # from unit to unit: room for the names between them
_LINE = 0.24  # height of a line of text
_INK, _DIRECT, _BUS = "#1a1a1a", "#0072B2", "#D55E00"


@dataclasses.dataclass(frozen=True)
class _Place:
    """The place of a unit's box: the middle `x`, the `top` and the `bottom`."""

    x: float
    top: float
    bottom: float


def draw_diagram(system: SystemFile) -> Figure:
    """Draw the units and connections of a system: direct ones as arrows above the units, messages below.

    A connection is named by the sender's variable, `variable > receiver's` where the names differ.
    """
    units = list(system.units)
    arcs = _arcs(system)
    top = _BOX[1] / 2 + 0.5 + sum(0.3 + _LINE * len(texts) for texts in arcs.values())
    depth = _depth(system)
    width = _PITCH * max(5, len(units))  # so that few units are not blown up
    left = (_PITCH * len(units) - width) / 2
    with canvas(height=max(3.0, (top + depth + 0.4) * 10.0 / width)) as (figure, grid):
        axes: Axes = grid[0, 0]
        axes.set_axis_off()
        axes.set_xlim(left - _PITCH / 2, left + width - _PITCH / 2)
        axes.set_ylim(-depth - 0.2, top + 0.2)
        axes.set_aspect("equal")
        places = {unit: _Place(i * _PITCH, _BOX[1] / 2, -_BOX[1] / 2) for i, unit in enumerate(units)}
        for i, (unit, entry) in enumerate(system.units.items(), 1):
            _draw_unit(axes, places[unit], f"{i}  {unit}", entry.fmu)
        _draw_arcs(axes, places, arcs)
        _draw_buses(axes, system, places)
    return figure


def _arcs(system: SystemFile) -> dict[tuple[str, str], list[str]]:
    """Return the texts of the direct connections of each pair of units, nearest pairs first."""
    order = list(system.units)
    texts = defaultdict(list)
    for connection in system.connect:
        for sink in connection.to if connection.via is None else ():
            texts[connection.source.split(".", 1)[0], sink.split(".", 1)[0]].append(_text(connection, sink))
    return dict(
        sorted(texts.items(), key=lambda item: abs(order.index(item[0][0]) - order.index(item[0][1])))
    )


def _text(connection: Connection, sink: str) -> str:
    sent, received = (name.split(".", 1)[1] for name in (connection.source, sink))
    return sent if sent == received else f"{sent} > {received}"


def _depth(system: SystemFile) -> float:
    return _BOX[1] / 2 + sum(1.1 + _LINE * sum(_lines(_bus_ends(system, bus))) for bus in system.buses)


def _lines(ends: dict[tuple[str, bool], list[str]]) -> tuple[int, int]:
    """Return the lengths of the longest list of sent signals, and of received ones, which stand below."""
    sent, received = (
        max((len(texts) for (_, sends), texts in ends.items() if sends is way), default=0)
        for way in (True, False)
    )
    return sent, received


def _bus_ends(system: SystemFile, bus: str) -> dict[tuple[str, bool], list[str]]:
    """Return the names of the signals that each unit sends to (True) and receives from (False) a bus."""
    ends: dict[tuple[str, bool], list[str]] = defaultdict(list)
    for connection in system.connect:
        if connection.via is None or connection.via.split(".")[0] != bus:
            continue
        signal = connection.via.split(".")[2]
        ends[connection.source.split(".", 1)[0], True].append(signal)
        for sink in connection.to:
            if signal not in ends[sink.split(".", 1)[0], False]:
                ends[sink.split(".", 1)[0], False].append(signal)
    return dict(ends)


def _draw_unit(axes: Axes, place: _Place, name: str, fmu: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    corner = (place.x - _BOX[0] / 2, place.bottom)
    style = "round,pad=0,rounding_size=0.12"
    axes.add_patch(FancyBboxPatch(corner, *_BOX, boxstyle=style, facecolor="#F4F6F8", edgecolor=_INK, lw=1.2))
    axes.text(
        place.x,
        0.16,
        on_one_line(name),
        ha="center",
        va="center",
        fontsize=9.5,
        fontweight="bold",
        color=_INK,
    )
    axes.text(
        place.x,
        -0.2,
        on_one_line(fmu.rsplit("/", 1)[-1]),
        ha="center",
        va="center",
        fontsize=7.5,
        color="#505050",
    )


def _draw_arcs(axes: Axes, places: dict[str, _Place], arcs: dict[tuple[str, str], list[str]]) -> None:
    y = _BOX[1] / 2 + 0.45
    fans: dict[tuple[str, bool], int] = defaultdict(int)
    paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
    for (source, sink), texts in arcs.items():
        rises = places[sink].x > places[source].x
        begin = places[source].x + _spread(fans, source, rises)
        end = places[sink].x + _spread(fans, sink, not rises)
        axes.plot([begin, begin, end], [places[source].top, y, y], color=_DIRECT, lw=1.4)
        _arrow(axes, (end, y), (end, places[sink].top), _DIRECT)
        # on the line, over whatever other line passes there
        label: dict[str, Any] = {
            "ha": "center",
            "va": "bottom",
            "fontsize": 7.5,
            "color": _INK,
            "zorder": 5.0,
            "bbox": paper,
        }
        axes.text((begin + end) / 2, y + 0.07, "\n".join(map(on_one_line, texts)), **label)
        y += 0.3 + _LINE * len(texts)


def _spread(fans: dict[tuple[str, bool], int], unit: str, right: bool) -> float:
    """Return the place on the edge of a box at which the next line ends, so that no two coincide."""
    fans[unit, right] += 1
    offset = _BOX[0] / 2 - 0.24 * fans[unit, right]
    return offset if right else -offset


def _draw_buses(axes: Axes, system: SystemFile, places: dict[str, _Place]) -> None:
    y = -_BOX[1] / 2
    for name, bus in system.buses.items():
        ends = _bus_ends(system, name)
        sent, received = _lines(ends)
        y -= 0.75 + _LINE * (sent + received)
        last = max(place.x for place in places.values()) + _PITCH * 0.45
        axes.plot([-_PITCH * 0.45, last], [y, y], color=_BUS, lw=4, solid_capstyle="round")
        about = f"{name}   {bus.dbc.rsplit('/', 1)[-1]}, {bus.bitrate // 1000} kbit/s"
        axes.text(
            -_PITCH * 0.45,
            y - 0.12,
            on_one_line(about),
            ha="left",
            va="top",
            fontsize=9,
            color=_BUS,
            fontweight="bold",
        )
        for (unit, sends), texts in ends.items():
            _draw_bus_end(axes, places[unit], y, sends, texts, first=0 if sends else sent)
        y -= 0.35


def _draw_bus_end(axes: Axes, place: _Place, y: float, sends: bool, texts: list[str], first: int) -> None:
    x = place.x - 0.12 if sends else place.x + 0.12
    high, low = (x, place.bottom), (x, y)
    _arrow(axes, high, low, _BUS) if sends else _arrow(axes, low, high, _BUS)
    side: dict[str, Any] = {"ha": "right" if sends else "left", "va": "top", "fontsize": 7.5, "color": _INK}
    for i, text in enumerate(texts, first):
        axes.text(x - 0.08 if sends else x + 0.08, place.bottom - 0.12 - _LINE * i, on_one_line(text), **side)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 1.4})
