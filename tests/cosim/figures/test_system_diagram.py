"""The picture of a system: every unit, connection and signal is on it, and no text lies on another."""

from __future__ import annotations

from itertools import combinations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from evcosim.cosim.figures.system_diagram import draw_diagram
from evcosim.cosim.system.system import load_system, system_names


@pytest.mark.parametrize("name", system_names())
def test_everything_is_on_it_and_legible(name):
    system = load_system(name).file
    figure = draw_diagram(system)
    texts = [text for text in figure.axes[0].texts if text.get_text()]
    shown = "\n".join(text.get_text() for text in texts)
    for unit, entry in system.units.items():
        assert unit in shown
        assert entry.fmu in shown
    for connection in system.connect:
        wanted = connection.via.split(".")[2] if connection.via else connection.source.split(".", 1)[1]
        assert wanted in shown
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = [(text.get_text(), text.get_window_extent(renderer).padded(-2.0)) for text in texts]
    overlaps = [(a, b) for (a, first), (b, second) in combinations(boxes, 2) if first.overlaps(second)]
    assert not overlaps
