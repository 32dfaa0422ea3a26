"""The diagram of a page: a box for each unit, a line for each connection, and no name that is markup."""

from __future__ import annotations

import html
import re
from itertools import combinations

import pytest

from evcosim.cosim.figures.diagram_content import content_of
from evcosim.cosim.figures.diagram_layout import laid_out
from evcosim.cosim.figures.letter_widths import width
from evcosim.cosim.report.assets import text
from evcosim.cosim.report.diagram import MOST, diagram
from evcosim.cosim.system.system import load_system, system_names
from support.pages import HOSTILE, hostile_run

ABOUT = {
    "order": ["ecu", "car"],
    "units": {"ecu": {"fmu": "Controller"}, "car": {"fmu": "fmus/Car.fmu"}},
    "buses": {"can0": {}, "can1": {"dbc": "can/ev.dbc", "bitrate": 250000}},
    "connect": [
        {"from": "ecu.throttle", "to": ["car.throttle"], "via": "can0.Request.Throttle"},
        {"from": "car.speed", "to": ["ecu.speed"]},
    ],
}

INCH = 115.2  # px
TEXT = (
    r'<text x="([-\d.]+)" y="([-\d.]+)" class="(\w+)" font-size="([\d.]+)" text-anchor="(\w+)">(.*?)</text>'
)


def texts(svg):
    return re.findall(r"<text[^>]*>(.*?)</text>", svg)


def test_units_variables_and_buses_have_their_names():
    assert texts(diagram(ABOUT)) == [
        "1  ecu", "Controller", "2  car", "Car.fmu", "speed", "can0", "can1   ev.dbc, 250 kbit/s",
        "Throttle", "Throttle",
    ]  # fmt: skip # units, connections, buses, signals


def test_an_ideal_run_has_no_bus():
    found = texts(diagram(ABOUT | {"ideal": True}))
    assert "can0" not in found and "Throttle" not in found and found.count("throttle") == 1


def test_ends_at_units_that_take_no_part_are_left_out():
    found = texts(diagram(ABOUT | {"order": ["ecu"]}))
    assert "speed" not in found and found.count("Throttle") == 1


def test_it_is_the_picture_that_info_draws():
    """Boxes, arcs, lines to buses and buses stand where the layout of both has them."""
    system = load_system("scooter").file
    layout, svg = laid_out(content_of(system)), diagram(manifest_of(system))
    boxes = [float(width) for width in re.findall(r'<rect [^>]* width="([\d.]+)"', svg)]
    assert boxes == pytest.approx([INCH * box.width for box in layout.boxes], abs=0.06)
    counts = [len(re.findall(f'stroke="{color}" stroke-width="2"', svg)) for color in ("#0072B2", "#D55E00")]
    assert counts == [len(layout.arcs), len(layout.drops)]
    size = re.search(r'viewBox="0 0 (\d+) (\d+)"', svg).groups()
    edges = (layout.right - layout.left, layout.top - layout.bottom)
    assert [float(x) for x in size] == pytest.approx([INCH * (x + 0.24) for x in edges], abs=0.51)


@pytest.mark.parametrize("name", system_names())
def test_no_text_lies_on_a_line_or_on_another(name):
    svg = diagram(manifest_of(load_system(name).file))
    named = [(box_of(*found), found[-1]) for found in re.findall(TEXT, svg)]
    lines = [segment for way in re.findall(r'<path d="(M[^"]*)" stroke', svg) for segment in segments(way)]
    assert len(named) > 10 and len(lines) >= 5
    assert not [text for box, text in named for line in lines if meet(box, line)]
    assert not [(a, b) for (one, a), (two, b) in combinations(named, 2) if meet(one, two)]


def manifest_of(system):
    return {
        "order": list(system.units),
        "units": {name: {"fmu": unit.fmu} for name, unit in system.units.items()},
        "buses": {name: {"dbc": bus.dbc, "bitrate": bus.bitrate} for name, bus in system.buses.items()},
        "connect": [{"from": c.source, "to": c.to, "via": c.via} for c in system.connect],
    }


def box_of(x, y, kind, size, anchor, text):
    """Return left, top, right and bottom [px] of a text, a pixel smaller all round."""
    wide = INCH * width(html.unescape(text), float(size) / INCH * 72.0, bold=kind in ("unit", "bus"))
    left = float(x) - {"start": 0.0, "middle": wide / 2.0, "end": wide}[anchor]
    return left + 1.0, float(y) - 0.7 * float(size) + 1.0, left + wide - 1.0, float(y) - 1.0


def segments(way):
    """Return the straight parts of a path of M, H and V as boxes."""
    x = y = 0.0
    for letter, rest in re.findall(r"([MHV])([^MHV]*)", way):
        at = [float(number) for number in rest.split()]
        before = x, y
        x, y = (at[0], at[1]) if letter == "M" else (at[0], y) if letter == "H" else (x, at[0])
        if letter != "M":
            yield min(before[0], x), min(before[1], y), max(before[0], x), max(before[1], y)


def meet(one, two):
    return one[0] < two[2] and two[0] < one[2] and one[1] < two[3] and two[1] < one[3]


def test_what_is_too_much_or_nothing_is_left_out():
    many = [{"from": f"ecu.a{i}", "to": ["car.b"]} for i in range(MOST + 1)]
    assert diagram(ABOUT | {"connect": many}) == ""
    assert diagram(ABOUT | {"connect": []}) == ""
    assert diagram({}) == ""


@pytest.mark.parametrize("place", ["order", "units", "connect", "buses"])
def test_any_manifest_is_taken(place):
    for value in (None, 3, [3], {"a": 3}, "text"):
        diagram(ABOUT | {place: value})


def test_names_are_no_markup():
    svg = diagram(
        hostile_run().manifest
        | {"order": ["a", "b"], "connect": [{"from": f"a.{HOSTILE[1]}", "to": [f"b.{HOSTILE[3]}"]}]}
    )
    assert "<img" not in svg and "\u202e" not in svg and "&lt;img" in svg


def test_a_diagram_wider_than_the_page_has_a_shadow_where_it_goes_on():
    """The shadows stay at the sides of the box, and what hides them moves with its content."""
    rule = text("page.css").partition(".wide {")[2].partition("}")[0]
    assert "overflow-x: auto" in rule
    assert all(f"{side} / 3rem 100% no-repeat" in rule for side in ("local left", "local right"))
    assert all(f"{side} / 1rem 100% no-repeat" in rule for side in ("scroll left", "scroll right"))
