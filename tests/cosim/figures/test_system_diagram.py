"""The picture of a system has every unit, connection and signal; no text lies on another or on a line."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from evcosim.cosim.figures.system_diagram import draw_diagram
from evcosim.cosim.system.system import load_system, system_names

from ...support.diagrams import UNITS, system_of


def inked(figure):
    """Return texts and lines of a drawing: [(text, box)], and segments ((x, y), (x, y)), both in pixels."""
    axes = figure.axes[0]
    renderer = FigureCanvasAgg(figure).get_renderer()
    shown = [text for text in axes.texts if text.get_text()]
    texts = [(text.get_text(), text.get_window_extent(renderer)) for text in shown]
    paths = [line.get_xydata() for line in axes.lines]
    paths += [np.array([text.xyann, text.xy]) for text in axes.texts if not text.get_text()]
    segments = [pair for path in paths for pair in pairwise(axes.transData.transform(path))]
    return texts, segments


def crosses(box, segment):
    """Return whether an upright or level line passes through a box."""
    (x0, y0), (x1, y1) = segment
    return min(x0, x1) < box.x1 and max(x0, x1) > box.x0 and min(y0, y1) < box.y1 and max(y0, y1) > box.y0


def assert_legible(system):
    figure = draw_diagram(system)
    texts, segments = inked(figure)
    overlaps = [
        (a, b) for (a, first), (b, second) in combinations(texts, 2) if first.padded(-1.0).overlaps(second)
    ]
    assert not overlaps
    assert not [text for text, box in texts for line in segments if crosses(box.padded(-1.0), line)]
    width, height = figure.canvas.get_width_height()
    for text, box in texts:
        assert box.x0 >= 0 and box.x1 <= width, text
        assert box.y0 >= 0 and box.y1 <= height, text


@pytest.mark.parametrize("name", system_names())
def test_everything_is_on_it_and_legible(name):
    system = load_system(name).file
    texts, _ = inked(draw_diagram(system))
    shown = "\n".join(text for text, _ in texts)
    for unit, entry in system.units.items():
        assert unit in shown
        assert entry.fmu in shown
    for connection in system.connect:
        wanted = connection.via.split(".")[2] if connection.via else connection.source.split(".", 1)[1]
        assert wanted in shown
    assert_legible(system)


CROWDED = [
    ("a", "e", None),
    ("a", "a", None),
    ("e", "c", None),
    ("a", "e", "can1"),
    ("c", "a", "can1"),
    ("b", "d", "can0"),
]


def test_long_names_between_many_lines_are_legible():
    assert_legible(system_of([(*ends, "speed_of_the_left_wheel_\u202e_and_more") for ends in CROWDED]))


def test_a_picture_is_as_large_as_its_content():
    one, two = (draw_diagram(system_of([], UNITS[:n], buses=())).get_figwidth() for n in (1, 2))
    assert one < two < draw_diagram(load_system("scooter").file).get_figwidth()
