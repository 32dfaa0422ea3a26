"""Two runs over each other."""

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.comparison import draw_comparison
from evcosim.cosim.figures.default_figure import MAX_PANELS
from evcosim.cosim.results.results import Results, ResultVariable
from support.outlined_scooter import scooter


def test_a_comparison_shows_what_differs_most() -> None:
    a, b = scooter(), scooter(301)
    other = Results(b.time, b.data * 1.01, b.variables)
    figure = draw_comparison(a, other, ["vehicle.speed", "ecu.state"], labels=("old", "new"))
    assert [axes.get_ylabel() for axes in figure.axes] == ["vehicle.speed [m/s]", "[m/s]", "ecu.state", ""]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["old", "new"]
    changed = scooter()
    changed.data[50, changed.names.index("vehicle.speed")] += 1.0
    overlay, beside = draw_comparison(a, changed).axes
    assert overlay.get_ylabel() == "vehicle.speed [m/s]"
    (line,) = beside.get_lines()
    assert sorted(line.get_ydata())[-2:] == pytest.approx([0.0, 1.0])
    nothing = Results(a.time, a.data[:, :1], [ResultVariable("x.y")])
    with pytest.raises(ConfigError, match="no variable in common"):
        draw_comparison(a, nothing)


def test_a_run_beside_itself_differs_by_nothing() -> None:
    figure = draw_comparison(scooter(), scooter())
    assert len(figure.axes) == 2 * MAX_PANELS
    for axes in figure.axes[1::2]:
        (line,) = axes.get_lines()
        assert not np.any(line.get_ydata())
    assert figure._suptitle.get_text() == "scooter · fig8"


def test_a_variable_that_one_of_them_lacks_is_named() -> None:
    with pytest.raises(ConfigError, match=r"no variable 'vehicle.sped'"):
        draw_comparison(scooter(), scooter(), ["vehicle.sped"])
