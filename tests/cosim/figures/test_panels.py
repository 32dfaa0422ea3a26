"""A panel: lines that are told apart, states by their names."""

import numpy as np

from evcosim.cosim.figures.default_figure import default_spec
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec
from support.outlined_scooter import STATES


def test_no_two_lines_of_a_panel_look_alike() -> None:
    n = 8
    names = [f"a.x{j}" for j in range(n)]
    results = Results(
        [0.0, 1.0], np.vstack([np.arange(n), np.ones(n)]), [ResultVariable(x, "W") for x in names]
    )
    signals = [{"name": x, "style": "dotted"} if j == 5 else x for j, x in enumerate(names)]
    spec = FigureSpec.model_validate({"panels": [{"unit": "W", "signals": signals}]})
    lines = draw(results, spec).axes[0].get_lines()
    assert len({line.get_color() for line in lines}) == n
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == n


def test_enumerations_beside_the_shading_one_and_booleans_have_a_panel_with_their_names() -> None:
    variables = [
        ResultVariable("ecu.state", type="Enumeration", items=STATES),
        ResultVariable("abs.mode", type="Enumeration", items=((1, "off"), (2, "on"))),
        ResultVariable("abs.ready", type="Boolean"),
        ResultVariable("bare.number"),
    ]
    data = np.array([[0, 1, 0, 1e3], [1, 2, 1, 2e3], [2, 1, 0, 3e3]], dtype=float)
    results = Results([0.0, 1.0, 2.0], data, variables)
    spec = default_spec(results)
    assert spec.shade == "ecu.state"
    ticks = [[t.get_text() for t in axes.get_yticklabels()] for axes in draw(results).axes]
    assert ticks[:2] == [["off", "on"], ["false", "true"]]
    alone = Results(results.time, data[:, :1], variables[:1])
    assert [t.get_text() for t in draw(alone).axes[0].get_yticklabels()] == [name for _, name in STATES]


def test_counts_have_no_unit_at_their_axis_and_ratios_have() -> None:
    kinds = [ResultVariable("a.count", "1", type="Integer"), ResultVariable("a.slip", "1")]
    results = Results([0.0, 1.0], np.zeros((2, 2)), kinds)
    panels = [{"label": v.name, "unit": "1", "signals": [v.name]} for v in kinds]
    panels.append({"label": "both", "unit": "1", "signals": [v.name for v in kinds]})
    axes = draw(results, FigureSpec.model_validate({"panels": panels})).axes
    assert [each.get_ylabel() for each in axes] == ["a.count", "a.slip [1]", "both [1]"]
