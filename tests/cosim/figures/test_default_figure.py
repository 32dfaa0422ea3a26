"""The figure of a system that names none."""

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.default_figure import default_spec, title_of
from evcosim.cosim.results.results import Results, ResultVariable
from support.outlined_scooter import scooter


def test_the_default_figure_groups_by_what_is_measured() -> None:
    spec = default_spec(scooter())
    assert spec.shade == "ecu.state"
    assert [(p.unit, [s.name for s in p.signals]) for p in spec.panels] == [
        ("%", ["rider.throttle", "ecu.throttle"]),  # the request repeats the rider's throttle
        ("km/h", ["ecu.speed_estimate", "vehicle.speed", "ecu.speed_measured", "ecu.speed_bound"]),
    ]
    assert spec.panels[1].label == "speed"
    assert spec.note == "Constant: vehicle.road_grade = 0 rad"


def test_inputs_that_never_change_are_said_and_not_drawn() -> None:
    variables = [
        ResultVariable("a.limit", "m/s2", causality="input"),
        ResultVariable("a.mode", type="Enumeration", causality="input", items=((1, "off"), (2, "on"))),
        ResultVariable("a.idle", "W"),
        ResultVariable("a.y", "m"),
    ]
    results = Results([0.0, 1.0], [[1e12, 2, 0.0, 1.0], [1e12, 2, 0.0, 2.0]], variables)
    spec = default_spec(results)
    assert [[signal.name for signal in panel.signals] for panel in spec.panels] == [["a.idle"], ["a.y"]]
    assert spec.note == "Constant: a.limit = 1e+12 m/s², a.mode = on"
    alone = default_spec(results.part(slice(None), ["a.limit", "a.mode"]))
    assert [s.name for p in alone.panels for s in p.signals] == ["a.limit", "a.mode"] and alone.note is None


def test_the_default_figure_has_an_end() -> None:
    units = ("m/s", "W", "V", "A", "N", "N.m", "kg", "K")
    variables = [ResultVariable(f"{u[0]}{i}.x{j}", u) for i, u in enumerate(units) for j in range(10)]
    data = np.random.default_rng(3).normal(size=(20, len(variables)))
    data[:, :10] = 1.0  # the speeds do not change: others are shown first
    spec = default_spec(Results(np.arange(20), data, variables))
    assert [p.unit for p in spec.panels] == list(units[1:7])
    assert all(len(p.signals) == 8 for p in spec.panels)
    assert spec.note is not None
    assert spec.note.startswith("Not shown: m0.x0, m0.x1") and spec.note.endswith("and 24 more")


def test_a_figure_is_named_by_what_was_run() -> None:
    def named(**manifest: object) -> str:
        return title_of(Results([0.0], [[1.0]], [ResultVariable("a.x")], manifest))

    assert named(system="scooter", scenario="fig8") == "scooter · fig8"
    assert named(system="scooter", scenario=None) == "scooter"
    assert named(system="Scooter", scenario="") == "Scooter"
    assert named() == ""


def test_a_figure_for_any_results_can_be_drawn_of_them() -> None:
    variables = [
        ResultVariable("a.n", type="Integer"),
        ResultVariable("a.odd", "parsecond"),
        ResultVariable("a.small"),
        ResultVariable("a.large"),
        ResultVariable("a.share", "%"),
    ]
    data = np.array([[1, 2.0, 0.01, 5e6, 3.0], [2, 3.0, 0.02, 6e6, 4.0]])
    spec = default_spec(Results([0.0, 1.0], data, variables))
    shown = [[signal.name for signal in panel.signals] for panel in spec.panels]
    assert shown == [["a.n"], ["a.odd"], ["a.small"], ["a.large"], ["a.share"]]


def test_without_a_variable_there_is_nothing_to_draw() -> None:
    with pytest.raises(ConfigError, match="no variable to draw"):
        default_spec(Results([0.0], np.empty((1, 0)), []))
