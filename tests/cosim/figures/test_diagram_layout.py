"""Places in the picture of a system: whatever is connected, no name lies on a line or on another name."""

from __future__ import annotations

from itertools import combinations, pairwise

from hypothesis import example, given, settings
from hypothesis import strategies as st

from evcosim.cosim.figures.diagram_content import content_of
from evcosim.cosim.figures.diagram_layout import BOX, LINE, lay_out

from ...support.diagrams import BUSES, UNITS, system_of


def measure(text):
    return 0.06 * len(text)


def layout_of(links, units=UNITS):
    content = content_of(system_of(links, units))
    titles = [measure(bus.title) for bus in content.buses]
    return content, lay_out(content, measure, [0.9] * len(units), titles)


def names_of(content, layout):
    """Yield the edges (left, right, bottom, top) of every name."""
    for arc in layout.arcs:
        half = max(map(measure, arc.names)) / 2.0
        yield arc.label - half, arc.label + half, arc.y + 0.01, arc.y + LINE * len(arc.names)
    for drop in layout.drops:
        width = max(map(measure, drop.names))
        left = drop.x - 0.01 - width if drop.sends else drop.x + 0.01
        yield left, left + width, drop.top - LINE * len(drop.names), drop.top
    for bar, bus in zip(layout.bars, content.buses, strict=True):
        yield bar.left, bar.left + measure(bus.title), bar.y - 1.3 * LINE, bar.y - 0.01


def lines_of(layout):
    """Yield the edges (left, right, bottom, top) of every line and of every unit."""
    for arc in layout.arcs:
        yield arc.begin, arc.begin, BOX / 2.0, arc.y
        yield arc.end, arc.end, BOX / 2.0, arc.y
        yield *sorted((arc.begin, arc.end)), arc.y, arc.y
    for drop in layout.drops:
        yield drop.x, drop.x, drop.y, -BOX / 2.0
    for bar in layout.bars:
        yield bar.left, bar.right, bar.y, bar.y
    for box in layout.boxes:
        yield box.x - box.width / 2.0, box.x + box.width / 2.0, -BOX / 2.0, BOX / 2.0


def touch(a, b):
    return a[0] < b[1] and a[1] > b[0] and a[2] < b[3] and a[3] > b[2]


LINKS = st.lists(
    st.tuples(
        st.sampled_from(UNITS),
        st.sampled_from(UNITS),
        st.sampled_from([None, *BUSES]),
        st.sampled_from(["y", "speed_of_the_left_wheel", "a_name_that_is_longer_than_all_of_the_others"]),
    ),
    max_size=14,
)


@given(links=LINKS)
@example(links=[("a", "a", None, "speed_of_the_left_wheel"), ("b", "a", None, "y")])
@example(links=[("a", "e", None, "y"), ("b", "d", None, "speed_of_the_left_wheel"), ("e", "c", None, "y")])
@example(
    links=[("a", "e", "can1", "y"), ("a", "e", "can0", "y"), ("c", "a", "can1", "speed_of_the_left_wheel")]
)
@settings(deadline=None)
def test_nothing_lies_on_a_name(links):
    content, layout = layout_of(links)
    names = list(names_of(content, layout))
    assert not [pair for pair in combinations(names, 2) if touch(*pair)]
    assert not [(name, line) for name in names for line in lines_of(layout) if touch(name, line)]
    for left, right, bottom, top in (*names, *lines_of(layout)):
        assert layout.left <= left and right <= layout.right
        assert layout.bottom <= bottom and top <= layout.top


@given(links=LINKS)
@settings(deadline=None)
def test_units_stand_apart_in_their_order_and_no_two_lines_coincide(links):
    _, layout = layout_of(links)
    for a, b in pairwise(layout.boxes):
        assert a.x + a.width / 2.0 < b.x - b.width / 2.0
    upright = [x for arc in layout.arcs for x in (arc.begin, arc.end)]
    for places in (upright, [drop.x for drop in layout.drops]):
        assert all(b - a > 0.05 for a, b in pairwise(sorted(places)))


def test_a_name_without_room_moves_only_the_units_beside_it():
    _, short = layout_of([("b", "c", None, "y")])
    _, long = layout_of([("b", "c", None, "speed_of_the_left_wheel")])
    wider = [
        b - a for a, b in zip(*([box.x for box in layout.boxes] for layout in (short, long)), strict=True)
    ]
    assert wider[:2] == [0.0, 0.0]
    assert wider[2] > 0.3
    assert wider[3:] == [wider[2]] * 2
