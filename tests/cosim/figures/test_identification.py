"""Figures of an identification."""

from __future__ import annotations

import numpy as np
from matplotlib.text import Text

from evcosim.cosim.analysis.first_order import FirstOrder, fit_first_order, predict
from evcosim.cosim.analysis.frequency_response import frequency_response
from evcosim.cosim.figures import identification as identification_figures
from support.swept import BAND, RATE, swept


def test_figures_can_be_drawn(tmp_path):
    model = FirstOrder(-0.46, 0.03)
    u, y = swept(model)
    response = frequency_response(u, y, RATE)
    fit = fit_first_order(response, BAND)
    figure = identification_figures.bode(response, fit, (0.008, 0.6), "km/h per %", "a", (-0.46, 0.03))
    labels = {text.get_text() for axes in figure.axes for text in [axes.yaxis.label]}
    assert labels == {"Magnitude\n[km/h per %]", "Phase [deg]", "Coherence [1]"}
    time = np.arange(len(u)) / RATE
    for offset, panels in ((30.0, 2), (0.0, 1)):
        found = predict(model, time, u, y + offset, (0.0, offset))
        assert len(identification_figures.prediction(found, "km/h", "v", "b").axes) == panels
    over = identification_figures.over_working_points([30.0, 40.0], [fit, fit], "v [km/h]", "km/h per %", "c")
    assert len(over.axes) == 2


def test_numbers_of_a_short_sweep_are_no_formulas(tmp_path):
    """matplotlib writes those of a logarithmic axis as such, and texts of figures are taken as they are."""
    model = FirstOrder(-0.46, 0.03)
    response = frequency_response(*swept(model), RATE)
    figure = identification_figures.bode(
        response, fit_first_order(response, BAND), (0.02, 0.09), "$", "a$b$c"
    )
    figure.savefig(tmp_path / "x.svg")
    texts = [text.get_text() for text in figure.findobj(Text) if text.get_visible()]
    assert "a$b$c" in texts
    assert "Magnitude\n[$]" in texts
    assert not [text for text in texts if "math" in text]
    assert "0.05" in texts or "5e-02" in texts
