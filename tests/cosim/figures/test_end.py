"""A figure ends before its run where its table says so, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.figures.end import until
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import EndSpec, FigureSpec

TIME = 0.5 * np.arange(9)
SPEED = np.array([20.0, 15.0, 10.0, 5.0, 2.0, 1.0, 0.0, 3.0, 0.0])  # m/s
RUN = Results(TIME, np.column_stack([SPEED]), [ResultVariable("vehicle.speed", "m/s")])


@pytest.mark.parametrize(
    ("end", "last"),
    [
        ({"below": 2.0}, 1.5),  # at the value it is no longer shown
        ({"below": 1.5}, 2.0),
        ({"below": 7.2, "unit": "km/h"}, 1.5),
        ({"below": 0.0}, 2.5),  # what follows later does not count
        ({"below": -1.0}, 4.0),
        ({"below": 20.0}, 4.0),  # nothing would be left
        ({"below": 15.0}, 4.0),  # a point is no axis
    ],
    ids=str,
)
def test_the_rows_before_the_signal_is_low_are_shown(end: dict, last: float) -> None:
    shown = until(RUN, EndSpec.model_validate({"signal": "vehicle.speed"} | end))
    assert shown.time[-1] == last
    assert np.array_equal(shown["vehicle.speed"], SPEED[: len(shown)])
    assert shown.names == RUN.names


def test_no_axis_begins_before_the_run() -> None:
    table = {
        "until": {"signal": "vehicle.speed", "below": 15.0},
        "panels": [{"unit": "m/s", "signals": ["vehicle.speed"]}],
    }
    assert draw(RUN, FigureSpec.model_validate(table)).axes[0].get_xlim() == (0.0, 4.0)


def test_without_an_end_the_run_is_shown() -> None:
    assert until(RUN, None) is RUN


def test_the_axis_ends_there() -> None:
    table = {
        "until": {"signal": "vehicle.speed", "below": 1.5},
        "panels": [{"unit": "m/s", "signals": ["vehicle.speed"]}],
    }
    figure = draw(RUN, FigureSpec.model_validate(table))
    assert figure.axes[0].get_xlim() == (0.0, 2.0)


@pytest.mark.parametrize(
    ("end", "message"),
    [
        (
            {"signal": "vehicle.sped"},
            r"^figure.until: no variable 'vehicle.sped' .*did you mean 'vehicle.speed'",
        ),
        ({"signal": "vehicle.speed", "unit": "N"}, r"^figure.until: 'vehicle.speed' \[m/s\] in \[N\]"),
    ],
)
def test_an_end_that_cannot_be_is_refused(end: dict, message: str) -> None:
    table = {"until": {"below": 1.0} | end, "panels": [{"unit": "m/s", "signals": ["vehicle.speed"]}]}
    with pytest.raises(ConfigError, match=message):
        draw(RUN, FigureSpec.model_validate(table))


def test_a_figure_without_the_unit_ends_with_its_run() -> None:
    table = {"until": {"signal": "vehicle.speed", "below": 1.0}, "panels": [{"signals": ["ecu.state"]}]}
    spec = FigureSpec.model_validate(table)
    left = spec.without(lambda name: name.startswith("vehicle"))
    assert left is not None
    assert left.until is None
    assert spec.without(lambda name: False) == spec
