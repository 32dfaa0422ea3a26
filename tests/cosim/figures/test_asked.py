"""The figure that `Results.plot` is asked for: a file or signals as the first argument."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from evcosim.cosim.system.figure_spec import FigureSpec

T = np.linspace(0.0, 1.0, 11)
VARIABLES = [
    ResultVariable("vehicle.speed", "km/h"),
    ResultVariable("ecu.reference", "m/s", causality="input"),
    ResultVariable("ecu.state", type="Enumeration", items=((0, "off"), (1, "on"))),
    ResultVariable("driver.throttle", "%"),
    ResultVariable("camera.png", "rad"),
]


@pytest.fixture
def results() -> Results:
    data = np.column_stack([T, 3.0 + 0.0 * T, T > 0.5, 10.0 * T, T])
    texts = TextTable([ResultVariable("ecu.message", type="String")], [(0, ("",))])
    return Results(T, data, VARIABLES, {"system": "car"}, texts=texts)


def test_signals_stand_first_or_by_name(results):
    for figure in (results.plot(["driver.throttle"]), results.plot(signals=["driver.throttle"])):
        assert [len(axes.lines) for axes in figure.axes] == [1]
        assert np.array_equal(figure.axes[0].lines[0].get_ydata(), results["driver.throttle"])
    assert len(results.plot("driver.throttle").axes) == 1
    assert len(results.plot(("driver.throttle", "driver.throttle")).axes[0].lines) == 1


def test_what_measures_the_same_shares_a_panel_though_it_is_constant(results):
    """The figure without signals leaves a constant input to the note; here it is asked for."""
    figure = results.plot(["vehicle.speed", "driver.throttle", "ecu.reference"])
    assert [len(axes.lines) for axes in figure.axes] == [2, 1]
    reference = figure.axes[0].lines[1].get_ydata()
    assert reference == pytest.approx(np.full(len(reference), 3.0 * 3.6))  # in the unit of the panel


def test_an_enumeration_that_is_asked_for_is_a_panel(results):
    assert len(results.plot(["ecu.state", "vehicle.speed"]).axes) == 2


def test_a_path_is_a_path(results, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    results.plot("figure.svg")
    results.plot(Path("other.png"), "a title")
    results.plot("camera.png")  # the ending says that it is a file, though a variable has this name
    results.plot("signals.png", signals="vehicle.speed")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "camera.png",
        "figure.svg",
        "other.png",
        "signals.png",
    ]
    assert len(results.plot(["camera.png"]).axes) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"path": "vehicle.sped"}, r"'vehicle\.sped' is no variable.*did you mean 'vehicle\.speed'"),
        ({"path": ["vehicle.sped"]}, r"no variable 'vehicle\.sped' \(did you mean 'vehicle\.speed'"),
        ({"path": "figure.xyz"}, r"'xyz' is not a format of figures; use one of .*png"),
        ({"path": []}, "no signal to draw is named"),
        ({"signals": ["ecu.message"]}, "is a String, which has no numbers"),
        ({"path": ["vehicle.speed"], "signals": "ecu.state"}, "given twice"),
        ({"signals": "ecu.state", "spec": FigureSpec(panels=[{"signals": ["ecu.state"]}])}, "one of the two"),
    ],
)
def test_what_does_not_fit_is_refused(results, arguments, message):
    with pytest.raises(ConfigError, match=message):
        results.plot(**arguments)
