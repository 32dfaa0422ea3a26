"""The names in the picture of a system."""

from __future__ import annotations

from evcosim.cosim.figures.diagram_content import content_of

from ...support.diagrams import system_of


def test_connections_are_named_once_near_units_first():
    links = [("a", "c", None, "y"), ("b", "a", None, "x"), ("a", "b", "can0", "s"), ("c", "c", None, "z")]
    content = content_of(system_of(links, "abc"))
    assert content.units == (("1  a", "SomeModel.fmu"), ("2  b", "SomeModel.fmu"), ("3  c", "SomeModel.fmu"))
    assert list(content.arcs.items()) == [
        ((2, 2), ("z3 \u2192 u3",)),
        ((1, 0), ("x1 \u2192 u1",)),
        ((0, 2), ("y0 \u2192 u0",)),
    ]
    assert [dict(bus.names) for bus in content.buses] == [{(0, True): ("s2",), (1, False): ("s2",)}, {}]
    assert content.buses[0].title == "can0   a_long_name_of_a_database.dbc, 500 kbit/s"


def test_long_names_have_several_lines():
    content = content_of(system_of([("a", "b", None, "the_speed_of_the_left_wheel_of_the_front_axle")], "ab"))
    assert len(content.arcs[0, 1]) == 2
