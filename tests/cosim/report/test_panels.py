"""Panels as data: the figure's lines in its units, strokes and steps, states with where they begin."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.style import COLORS, Stroke
from evcosim.cosim.report.columns import Columns
from evcosim.cosim.report.panels import any_signals, figure_panels, line_data, states_data
from evcosim.cosim.report.recorded import recorded
from evcosim.cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from support.pages import small_run

RUN = small_run()
FOUND = recorded(RUN, [], Columns())


def spec(*signals, **panel):
    return FigureSpec(panels=[PanelSpec(signals=[SignalSpec(name=n) for n in signals], **panel)])


def test_lines_are_converted_and_held_as_in_the_figure():
    wanted = spec("car.speed", "car.wind", label="speed", unit="km/h", limits=(0.0, 5.0))
    (panel,) = figure_panels(RUN, wanted, FOUND)
    assert (panel["title"], panel["unit"], panel["limits"]) == ("speed", "km/h", (0.0, 5.0))
    speed, wind = panel["lines"]
    assert (speed["scale"], wind["scale"], speed["held"]) == (pytest.approx(3.6), 1.0, False)
    assert (speed["color"], wind["color"]) == COLORS[:2]
    assert (speed["dash"], len(wind["dash"])) == ([], 2)
    (torque,) = figure_panels(RUN, spec("ecu.torque", unit="N.m"), FOUND)
    assert (torque["title"], torque["unit"]) == ("ecu.torque", "N·m")
    assert torque["lines"][0]["held"]


def test_a_panel_of_other_quantities_is_refused():
    with pytest.raises(ConfigError, match=r"car\.speed"):
        figure_panels(RUN, spec("car.speed", unit="N"), FOUND)


def test_names_of_values_where_all_lines_have_the_same():
    assert figure_panels(RUN, spec("ecu.state"), FOUND)[0]["items"][2] == (5, "failed")
    assert figure_panels(RUN, spec("ecu.state", "ecu.ready"), FOUND)[0]["items"] == []


def test_each_signal_has_a_panel_with_its_description():
    found = {about["title"]: about for about in any_signals(RUN, FOUND)}
    assert set(found) == {*RUN.names, *RUN.texts}
    assert (found["car.speed"]["about"], found["car.speed"]["unit"]) == ("Speed over ground", "m/s")
    assert found["ecu.count"]["unit"] == ""
    assert found["ecu.mode"]["items"] == [(0, "warm-up"), (1, "</script>")]
    assert found["ecu.mode"]["lines"][0]["held"]


def test_dashes_are_in_pixels():
    assert line_data(0, "x", False, Stroke("#000", (0, (5, 1.5)), 2.0))["dash"] == [10.0, 3.0]
    assert line_data(0, "x", False, Stroke("#000", (0, (5, 1.5)), 2.0), 1.0)["dash"] == [5.0, 1.5]


def test_states_begin_where_they_change():
    states = states_data(RUN, "ecu.state", FOUND.items)
    assert states["values"] == [0, 1, 5, 5]
    assert states["times"] == [0.0, pytest.approx(1.01), pytest.approx(3.01), 4.0]
    assert [item[:2] for item in states["items"]] == [(0, "off"), (1, "on"), (5, "failed")]
    assert states_data(RUN, None, FOUND.items) is None
    assert states_data(small_run(1), "ecu.state", FOUND.items)["values"] == [0]
