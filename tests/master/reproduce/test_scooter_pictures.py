"""The pictures of the scooter that its runs alone give."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim import simulate


@pytest.mark.parametrize("scenario", ["fig8", "fig9"])
def test_the_acceleration_is_the_true_one_beside_the_estimate(scenario):
    results = simulate("scooter", scenario, stop_time=2.0)
    figure = results.plot()
    assert len(figure.axes) == 3
    labels = [line.get_label() for line in figure.axes[-1].lines]
    assert labels[-3:] == ["bound", "true", "estimate"]
    true = next(line for line in figure.axes[-1].lines if line.get_label() == "true")
    assert np.max(true.get_ydata()) == np.max(results["vehicle.acceleration"])
