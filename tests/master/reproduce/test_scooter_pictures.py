"""The pictures of the scooter that its runs alone give."""

from __future__ import annotations

import numpy as np

from evcosim import simulate
from evcosim.master.reproduce import scooter_pictures


def test_the_acceleration_is_the_true_one_beside_the_estimate():
    results = simulate("scooter", "fig8", stop_time=2.0)
    figure = results.plot(spec=scooter_pictures._with_acceleration(results))
    assert len(figure.axes) == 3
    labels = [line.get_label() for line in figure.axes[-1].lines]
    assert labels[-3:] == ["bound", "true", "estimate"]
    true = next(line for line in figure.axes[-1].lines if line.get_label() == "true")
    assert np.max(true.get_ydata()) == np.max(results["vehicle.acceleration"])
