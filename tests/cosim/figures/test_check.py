"""A figure that cannot be drawn is refused before it is."""

import dataclasses
from functools import partial

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.check import check, check_specs, panel_conversion
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.scenario import load_scenario, scenario_names
from evcosim.cosim.system.selection import figure_spec
from evcosim.cosim.system.system import load_system, system_names
from support.outlined_scooter import scooter

WRONG = [
    (
        {"signals": ["vehicle.sped"]},
        r"^figure.panels 1.signals 1: no variable 'vehicle.sped' .*did you mean 'vehicle.speed'",
    ),
    (
        {"unit": "N", "signals": ["vehicle.speed"]},
        r"'vehicle.speed' \[m/s\] in \[N\]: .*different quantities",
    ),
    (
        {"signals": ["vehicle.speed"]},
        r"^figure.panels 1.signals 1: 'vehicle.speed' \[m/s\] stands in a panel without 'unit'$",
    ),
]


@pytest.mark.parametrize(("panel", "message"), WRONG)
def test_a_panel_that_cannot_be_drawn_is_refused(panel: dict, message: str) -> None:
    spec = FigureSpec.model_validate({"panels": [panel]})
    with pytest.raises(ConfigError, match=message):
        draw(scooter(), spec)


def test_only_an_enumeration_shades() -> None:
    spec = FigureSpec.model_validate({"shade": "vehicle.speed", "panels": [{"signals": ["ecu.state"]}]})
    with pytest.raises(ConfigError, match=r"'vehicle.speed' is not an enumeration, so it has no states"):
        draw(scooter(), spec)


def test_a_text_is_not_drawn() -> None:
    variables = {"ecu.mode": ResultVariable("ecu.mode", type="String")}
    panel = FigureSpec.model_validate({"panels": [{"signals": ["ecu.mode"]}]})
    with pytest.raises(ConfigError, match=r"^here.panels 1.signals 1: 'ecu.mode' is a String, which has no"):
        check(panel, variables, "here")
    table = TextTable(tuple(variables.values()), [(0, ("on",))])
    results = Results([0.0, 1.0], np.empty((2, 0)), [], texts=table)
    with pytest.raises(
        ConfigError, match=r"^figure.panels 1.signals 1: 'ecu.mode' is a String, which has no"
    ):
        draw(results, panel)
    with pytest.raises(ConfigError, match=r"^the results have no variable to draw: texts are not drawn$"):
        draw(results)


def test_the_unit_of_a_panel_is_that_of_its_lines() -> None:
    convert = panel_conversion(ResultVariable("a.v", "m/s"), "km/h", "here")
    assert convert(10.0) == pytest.approx(36.0)
    for unit in ("", "km/h"):
        assert panel_conversion(ResultVariable("a.v", unit), "km/h", "here").identity
    kelvin = ResultVariable("a.t", "K")
    assert panel_conversion(kelvin, "degC", "here")(273.15) == pytest.approx(0.0)
    assert panel_conversion(dataclasses.replace(kelvin, difference=True), "degC", "here").identity
    assert panel_conversion(ResultVariable("a.t", "delta_degC"), "K", "here").identity
    with pytest.raises(ConfigError, match=r"'a.t' \[K\] in \[delta_degC\]: .* means nothing to the other"):
        panel_conversion(kelvin, "delta_degC", "here")


@pytest.mark.parametrize("name", system_names())
def test_every_scenario_asks_for_what_its_system_records(name: str) -> None:
    """And for nothing else: without one of the variables, the file that asks for it is named."""
    system = load_system(name)
    for scenario in map(partial(load_scenario, system), scenario_names(system)):
        spec = figure_spec(system, scenario)
        assert spec is not None
        shown = [signal.name for panel in spec.panels for signal in panel.signals]
        with pytest.raises(ConfigError, match=r"\.toml"):
            check_specs(system, scenario, [ResultVariable(shown[0])])


def test_the_unit_of_an_end_whose_signal_has_none_is_told() -> None:
    """Its value is compared with numbers of which nobody knows the unit."""
    system = load_system("scooter")
    panels = [{"unit": "m/s", "signals": ["vehicle.speed"]}]
    for end, unit, said in (
        (
            {"unit": "m/s"},
            "",
            "'vehicle.speed' declares no unit of measure; 0.5 m/s is compared with its bare",
        ),
        ({"unit": "km/h"}, "m/s", ""),
        ({}, "", ""),
    ):
        until = {"signal": "vehicle.speed", "below": 0.5} | end
        figure = FigureSpec.model_validate({"panels": panels, "until": until})
        none = {"figure": figure, "metrics": []}
        given = dataclasses.replace(system, file=system.file.model_copy(update=none))
        scenario = load_scenario(given, "fig8")
        found = check_specs(given, scenario, [ResultVariable("vehicle.speed", unit)])
        assert len(found) == bool(said)
        assert all(said in text and "scooter.toml: figure.until: " in text for text in found)
