"""Signals as lines: held ones as steps, units of measure where they are known."""

import numpy as np
import pytest

from evcosim.cosim.figures.draw import draw
from evcosim.cosim.figures.lines import is_band
from evcosim.cosim.figures.style import Stroke
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec
from support.outlined_scooter import SPEC, scooter


def test_what_is_held_is_drawn_as_steps_unless_told_otherwise() -> None:
    lines = [line for axes in draw(scooter(), SPEC).axes for line in axes.get_lines()]
    styles = {line.get_label(): line.get_drawstyle() for line in lines}
    assert styles == {
        "rider.throttle": "default",
        "ecu.throttle": "steps-post",
        "true": "default",
        "measured": "default",
        "ecu.speed_bound": "steps-post",
    }


def test_a_signal_without_a_unit_says_so_in_the_legend() -> None:
    results = Results([0.0, 1.0], [[1.0], [2.0]], [ResultVariable("vendor.speed")])
    spec = FigureSpec.model_validate({"panels": [{"unit": "km/h", "signals": ["vendor.speed"]}]})
    text = draw(results, spec).axes[0].get_legend().get_texts()[0].get_text()
    assert text.replace("\n", " ") == "vendor.speed (no unit declared)"


@pytest.mark.parametrize(
    ("values", "band"),
    [
        (np.arange(1000) % 2, True),
        (np.sin(np.arange(1000) / 50), False),
        (np.full(1000, 3.0), False),
        (np.empty(0), False),
    ],
)
def test_what_fills_an_area_is_a_band_and_drawn_thin(values: np.ndarray, band: bool) -> None:
    assert is_band(values.astype(float)) is band
    if len(values):
        results = Results(np.arange(len(values)), values[:, None], [ResultVariable("a.x", "V")])
        widths = [line.get_linewidth() for line in draw(results).axes[0].get_lines()]
        assert (widths == [pytest.approx(0.6 * Stroke.of(0, "solid").width)]) is band
