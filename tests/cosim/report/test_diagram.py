"""The diagram of a page: a box for each unit, a line for each connection, and no name that is markup."""

from __future__ import annotations

import re

import pytest

from evcosim.cosim.report.diagram import MOST, diagram
from support.pages import HOSTILE, hostile_run

ABOUT = {
    "order": ["ecu", "car"],
    "units": {"ecu": {"fmu": "Controller"}, "car": {"fmu": "fmus/Car.fmu"}},
    "buses": {"can0": {}, "can1": {}},
    "connect": [
        {"from": "ecu.throttle", "to": ["car.throttle"], "via": "can0.Request.Throttle"},
        {"from": "car.speed", "to": ["ecu.speed"]},
    ],
}


def texts(svg):
    return re.findall(r"<text[^>]*>(.*?)</text>", svg)


def test_units_variables_and_buses_have_their_names():
    assert texts(diagram(ABOUT)) == [
        "1  ecu", "Controller", "throttle", "Throttle", "speed",
        "2  car", "Car.fmu", "throttle", "Throttle", "speed", "can0",
    ]  # fmt: skip # a box on each line


def test_an_ideal_run_has_no_bus():
    found = texts(diagram(ABOUT | {"ideal": True}))
    assert "can0" not in found and "Throttle" not in found and found.count("throttle") == 2


def test_no_text_lies_on_a_line():
    """Lines run outside the boxes, texts within them, but for the names of the buses above."""
    svg = diagram(ABOUT)
    left, right = (
        float(x) for x in re.search(r'<rect x="([\d.]+)" y="[\d.]+" width="([\d.]+)"', svg).groups()
    )
    right += left
    names = re.findall(r'<text x="([\d.]+)" y="([\d.]+)" class="(\w+)" text-anchor="(\w+)">', svg)
    assert all(left < float(x) < right for x, y, *_ in names if float(y) > 20.0)
    for x, y in re.findall(r"M([\d.]+) ([\d.]+) H[\d.]+", svg):
        assert float(y) > 20.0 and not left < float(x) < right


def test_what_is_too_much_or_nothing_is_left_out():
    many = [{"from": f"ecu.a{i}", "to": ["car.b"]} for i in range(MOST)]
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
