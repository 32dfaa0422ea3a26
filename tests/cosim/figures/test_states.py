"""States as a background: for as long as they last, however the run is read."""

import matplotlib
import numpy as np
import pytest

from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results import results as results_module
from evcosim.cosim.results.results import Results, ResultVariable
from support.outlined_scooter import SPEC, STATES, scooter


def test_the_states_shade_every_panel_for_as_long_as_they_last() -> None:
    figure = draw(scooter(), SPEC)
    for axes in figure.axes:
        spans = {
            tuple(round(float(x), 6) for x in (*path.get_extents().intervalx,))
            for collection in axes.collections
            for path in collection.get_paths()
        }
        assert spans == {(0.0, 1.5), (30.0, 40.0), (1.5, 10.0), (10.0, 30.0)}
    names = [text.get_text() for legend in _legends(figure.axes[0]) for text in legend.get_texts()]
    assert names[:4] == ["ecu.state:", "driver", "acceleration", "velocity"]


def _legends(axes):
    return [child for child in axes.get_children() if isinstance(child, matplotlib.legend.Legend)]


def test_states_that_chatter_to_the_end_are_drawn_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    state = (np.arange(9000) % 7 // 3).astype(float)
    variables = [ResultVariable("ecu.state", type="Enumeration", items=STATES), ResultVariable("a.x", "V")]
    results = Results(np.arange(9000.0), np.column_stack([state, state]), variables)
    few = Results(np.arange(20.0), results.data[:20], variables)
    found = []
    for rows in (100_000, 50):
        monkeypatch.setattr(results_module, "PIECE", rows)
        shades = [c for r in (results, few) for c in draw(r).axes[0].collections]
        found.append([[p.vertices.tolist() for p in bars.get_paths()] for bars in shades])
    assert found[0] == found[1]
    assert sum(map(len, found[0][:3])) > 100
