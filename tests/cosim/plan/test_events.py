"""Events: at which step each happens, and which ones are refused."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.events import check_event, scheduled
from evcosim.cosim.plan.plan import InputPlan
from evcosim.cosim.system.scenario import Bias, Override, Reset, Scenario, ScenarioFile, Set
from evcosim.cosim.texts import Texts

CLOCK = Clock.counted(0.0, 0.01, 1000)
INPUTS = {
    f"display.{name}": InputPlan(i, None, "") for i, name in enumerate(("level", "count", "state", "flag"))
}
TYPES = {"level": "Real", "count": "Integer", "state": "Enumeration", "flag": "Boolean"}
VARIABLES = {name: VariableInfo(name, kind, "input", max=9.0) for name, kind in TYPES.items()}
VARIABLES["state"] = dataclasses.replace(VARIABLES["state"], items=((0, "off"), (1, "on")))
VARIABLES["count"] = dataclasses.replace(VARIABLES["count"], limits=(-128, 127))
INTERFACES = {"display": UnitInterface("display.fmu", VARIABLES)}


def at_steps(*times: float, start: float = 0.0, step: float = 0.01) -> list[int]:
    """The steps at which resets at these times happen, in the order in which they happen."""
    events = [{"time": t, "action": "reset", "variable": "display.level"} for t in times]
    scenario = Scenario("s", Path("s.toml"), ScenarioFile.model_validate({"event": events}))
    clock = Clock.counted(start, step, 1000)
    return [step for step, _ in scheduled(scenario, INTERFACES, INPUTS, clock, Texts())]


def test_an_event_happens_at_the_first_point_at_or_after_its_time():
    assert at_steps(0.0, 0.01, 0.02, 0.025, 0.03) == [0, 1, 2, 3, 3]
    assert at_steps(*(k * 0.01 for k in range(1000))) == list(
        range(1000)
    )  # whatever the doubles' last bits say


def test_at_0_33_s_is_the_point_of_that_time_whatever_the_step():
    assert at_steps(0.33, 3 * 0.11, step=0.03) == [11, 11]
    assert at_steps(0.05, 49 / 60, step=1 / 60) == [3, 49]
    assert at_steps(1.03, 1.0300001, start=0.7) == [33, 34]


def test_what_lies_before_the_start_happens_at_the_start():
    assert at_steps(0.0, 1.0, 1.02, start=1.0) == [0, 0, 2]
    assert at_steps(-1.0, -0.5, -0.49, 0.0, start=-0.5) == [0, 0, 1, 50]


def test_events_happen_in_order_and_those_of_one_step_as_they_are_written():
    table = [(0.02, 1.0), (0.01, 2.0), (0.02, 3.0), (0.011, 4.0)]
    events = [{"time": t, "action": "override", "variable": "display.level", "value": v} for t, v in table]
    scenario = Scenario("s", Path("s.toml"), ScenarioFile.model_validate({"event": events}))
    found = scheduled(scenario, INTERFACES, INPUTS, CLOCK, Texts())
    assert [(step, event.value) for step, event in found] == [(1, 2.0), (2, 1.0), (2, 3.0), (2, 4.0)]


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ({"action": "override", "variable": "display.state", "value": 1.5}, r"value: display.state is an Enumeration, not 1.5$"),
        ({"action": "override", "variable": "display.flag", "value": 2}, r"value: display.flag is a Boolean, true or false, not 2$"),
        ({"action": "bias", "variable": "display.flag", "value": 1}, r"action: display.flag is a Boolean, to which nothing can be added$"),
        ({"action": "bias", "variable": "x.y", "value": 1}, r"variable: there is no input 'x.y'; bias acts on"),
        ({"action": "reset", "variable": "display.levle"}, r"variable: there is no input 'display.levle' \(did you mean"),
    ],
)  # fmt: skip # one case a line
def test_an_event_of_a_file_is_named_by_its_number_and_key(event, said):
    events = [{"time": 0.0, "action": "reset", "variable": "display.level"}, {"time": 0.0} | event]
    scenario = Scenario("s", Path("s.toml"), ScenarioFile.model_validate({"event": events}))
    with pytest.raises(ConfigError, match=rf"^s.toml: event 2\.{said}"):
        scheduled(scenario, INTERFACES, INPUTS, CLOCK, Texts())


def override(name: str, value: float | str) -> Override:
    return Override.model_construct(time=0.0, action="override", variable=name, value=value)


def bias(name: str, value: float) -> Bias:
    return Bias.model_construct(time=0.0, action="bias", variable=name, value=value)


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (override("display.levle", 1.0), "there is no input 'display.levle' (did you mean 'display.level'?); override acts on what a unit receives"),
        (Reset.model_construct(time=0.0, action="reset", variable="x.y"), "there is no input 'x.y'; reset acts on what a unit receives"),
        (override("display.level", float("nan")), "display.level is a finite Real number, not nan"),
        (bias("display.level", float("inf")), "display.level needs a finite number, not inf"),
        (override("display.flag", 2.0), "display.flag is a Boolean, true or false, not 2.0"),
        (bias("display.flag", 1.0), "display.flag is a Boolean, to which nothing can be added"),
        (override("display.state", 1.5), "display.state is an Enumeration, not 1.5"),
        (override("display.state", 3), "3 is no item of display.state: 0 off, 1 on"),
        (override("display.state", "of"), "display.state has no item 'of' (did you mean 'off'?): ['off', 'on']"),
        (override("display.count", 128), "128 is beyond the numbers of display.count, -128 to 127"),
        (override("display.level", True), "display.level is a finite Real number, not true"),
        (bias("display.count", 0.5), "display.count is an Integer; bias needs a whole number, not 0.5"),
    ],
)  # fmt: skip # one case a line
def test_an_event_that_cannot_act_is_refused(event, said):
    with pytest.raises(ConfigError) as caught:
        check_event(event, INTERFACES, INPUTS, Texts(), "here")
    assert str(caught.value) == f"here: {said}"


@pytest.mark.parametrize(
    "event",
    [
        override("display.level", 1e6),  # beyond its maximum: faults are what events are for
        bias("display.level", -1e6),
        override("display.flag", 1),
        override("display.flag", True),
        override("display.state", "on"),
        override("display.count", 3.0),
        Reset.model_construct(time=0.0, action="reset", variable="display.flag"),
    ],
)  # fmt: skip
def test_an_event_that_can_act_is_taken(event):
    taken = check_event(event, INTERFACES, INPUTS, Texts(), "here")
    if isinstance(event, Override):
        assert isinstance(taken.value, float) and taken.value == (1.0 if event.value == "on" else event.value)


SETTABLE = {
    "gain": VariableInfo("gain", "Real", "parameter", "tunable", unit="N", min=0.0),
    "title": VariableInfo("title", "String", "parameter", "tunable"),
    "mass": VariableInfo("mass", "Real", "parameter", "fixed"),
    "speed": VariableInfo("speed", "Real", "output"),
    "driven": VariableInfo("driven", "Real", "input"),
    "label": VariableInfo("label", "String", "input"),
}
OF_PLANT = {"plant": UnitInterface("plant.fmu", SETTABLE | VARIABLES)}
PLANT_INPUTS = {
    "plant.driven": InputPlan(0, None, "ecu.torque"), "plant.label": InputPlan(4, 5, ""),
    **{f"plant.{name}": InputPlan(i, i, "") for i, name in enumerate(VARIABLES, 1)},
}  # fmt: skip # beside each other


def set_to(name: str, value: object) -> Set:
    """The event as it is done, or what is wrong with it."""
    event = Set.model_construct(time=0.0, action="set", variable=name, value=value)
    found = check_event(event, OF_PLANT, PLANT_INPUTS, Texts(), "event 1", in_file=True)
    assert isinstance(found, Set)
    return found


def test_tunable_parameters_and_free_inputs_are_set_in_their_types():
    assert set_to("plant.gain", 3).value == 3.0
    assert set_to("plant.title", "a").value == "a"
    assert set_to("plant.level", 2).value == 2.0
    assert set_to("plant.flag", True).value == 1.0
    assert set_to("plant.state", "on").value == 1.0
    assert set_to("plant.gain", 3).needs == ("plant.gain",)


def test_the_value_of_a_text_is_its_number():
    texts = Texts()
    for action, event in (("override", Override), ("set", Set)):
        made = event.model_construct(time=0.0, action=action, variable="plant.label", value=f"after {action}")
        found = check_event(made, OF_PLANT, PLANT_INPUTS, texts, "event 1", in_file=True)
        assert isinstance(found.value, float) and texts.text(found.value) == f"after {action}"


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("plant.gain", -1.0, r"value: -1.0 N is below the minimum 0.0 N of plant.gain$"),
        ("plant.gain", "much", r"value: plant.gain is a finite Real number, not 'much'$"),
        ("plant.title", 3, r"value: plant.title is a String, not 3: a text stands in quotes$"),
        ("plant.level", 10.0, r"value: 10.0 is above the maximum 9.0 of plant.level$"),
        ("plant.mass", 1.0, r"variable: plant.mass is a fixed parameter, which no run changes; "),
        ("plant.speed", 1.0, r"variable: plant.speed is of causality output; "),
        ("plant.driven", 1.0, r"variable: plant.driven is driven by ecu.torque; use override to take its place$"),
        ("plant.label", 1.0, r"value: plant.label is a String, not 1.0: a text stands in quotes$"),
        ("plant.gian", 1.0, r"variable: unit 'plant' has no variable 'gian' \(did you mean 'gain'"),
        ("plnat.gain", 1.0, r"variable: there is no unit 'plnat' \(did you mean 'plant'"),
    ],
)  # fmt: skip # one case a line
def test_what_cannot_be_set_says_why(name, value, said):
    with pytest.raises(ConfigError, match=rf"^event 1\.{said}"):
        set_to(name, value)
