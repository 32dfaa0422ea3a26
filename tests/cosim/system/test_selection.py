"""Figure and metrics of a run: the scenario's first, the system's without the units that are left out."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from evcosim.cosim.system.scenario import Scenario, ScenarioFile, load_scenario, scenario_names
from evcosim.cosim.system.selection import figure_spec, metric_specs, recorded_alone, without_undrawn
from evcosim.cosim.system.system import System, SystemFile, load_system, system_names

UNITS = {name: {"fmu": "F"} for name in ("a", "b")}
PANELS = [{"signals": ["a.x", "b.x"]}, {"signals": ["b.y"]}]
METRICS = [
    {"name": "of a", "signal": "a.x"},
    {"name": "of both", "signal": "a.x", "per": {"signal": "b.x"}},
]
SYSTEM = System(
    Path("s.toml"),
    SystemFile.model_validate(
        {"name": "s", "units": UNITS, "figure": {"panels": PANELS}, "metrics": METRICS}
    ),
)
CASES = [(s, name) for s in system_names() for name in scenario_names(load_system(s))]


def scenario(**keys: object) -> Scenario:
    return Scenario("t", Path("t.toml"), ScenarioFile.model_validate(keys))


def test_an_empty_scenario_leaves_all_as_it_is() -> None:
    assert figure_spec(SYSTEM, scenario()) == SYSTEM.file.figure
    assert metric_specs(SYSTEM, scenario()) == SYSTEM.file.metrics


def test_what_is_not_recorded_takes_metrics_and_lines_along() -> None:
    system, driven, said = recorded_alone(SYSTEM, scenario(), {"a.x"})
    figure = figure_spec(system, driven)
    assert figure is not None
    assert [[s.name for s in panel.signals] for panel in figure.panels] == [["a.x"]]
    assert [spec.name for spec in metric_specs(system, driven)] == ["of a"]
    assert said == (
        "left out for want of what `record` leaves out: the metrics of both and lines of the figure",
    )
    whole = recorded_alone(SYSTEM, scenario(), {"a.x", "b.x", "b.y"})
    assert (whole[0], whole[2]) == (SYSTEM, ())


def optional_in(*panels: list[str]) -> dict:
    """Return a figure in which the names with a question mark are optional."""
    signals = [[{"name": n.rstrip("?"), "optional": n.endswith("?")} for n in names] for names in panels]
    return {"panels": [{"signals": each} for each in signals]}


def test_an_optional_line_is_left_out_where_its_variable_is_not_recorded() -> None:
    own = scenario(figure=optional_in(["a.x", "b.x?"], ["b.y?"], ["b.z?", "b.z"]))
    system, driven, said = without_undrawn(SYSTEM, own, {"a.x"})
    figure = figure_spec(system, driven)
    assert figure is not None
    # what is needed elsewhere in the figure is refused later, by name
    assert [[s.name for s in panel.signals] for panel in figure.panels] == [["a.x"], ["b.z", "b.z"]]
    assert said == tuple(
        f"left out of the figure, since it is not recorded: {name}" for name in ("b.x", "b.y")
    )
    assert without_undrawn(SYSTEM, own, {"a.x", "b.x", "b.y"}) == (SYSTEM, own, ())
    assert without_undrawn(SYSTEM, scenario(), set()) == (SYSTEM, scenario(), ())


def test_a_figure_of_optional_lines_alone_may_be_none() -> None:
    own = scenario(figure=optional_in(["a.x?"]))
    assert without_undrawn(SYSTEM, own, set())[1].file.figure is None


def test_a_unit_that_is_left_out_takes_its_signals_along() -> None:
    spec = figure_spec(SYSTEM, scenario(leave_out=["b"]))
    assert spec is not None
    assert [[s.name for s in panel.signals] for panel in spec.panels] == [["a.x"]]
    assert [m.name for m in metric_specs(SYSTEM, scenario(leave_out=["b"]))] == ["of a"]
    assert figure_spec(SYSTEM, scenario(leave_out=["a", "b"])) is None
    assert metric_specs(SYSTEM, scenario(leave_out=["a"])) == []


def test_what_the_scenario_says_itself_takes_the_place() -> None:
    own = {"panels": [{"signals": ["b.z"]}]}
    spec = figure_spec(SYSTEM, scenario(leave_out=["b"], figure=own))
    assert spec is not None
    assert spec.panels[0].signals[0].name == "b.z"
    found = metric_specs(SYSTEM, scenario(metrics=[{"name": "of a", "signal": "a.z"}]))
    assert [(m.name, m.signal) for m in found] == [("of both", "a.x"), ("of a", "a.z")]


@pytest.mark.parametrize(("system", "name"), CASES)
def test_no_built_in_scenario_asks_for_a_unit_that_it_leaves_out(system: str, name: str) -> None:
    described = load_system(system)
    driven = load_scenario(described, name)
    spec = figure_spec(described, driven)
    shown = [s.name for panel in spec.panels for s in panel.signals] if spec else []
    measured = itertools.chain(*(m.all_signals for m in metric_specs(described, driven)))
    units = {signal.partition(".")[0] for signal in (*shown, *measured)}
    assert units <= set(described.file.units) - set(driven.file.leave_out)
