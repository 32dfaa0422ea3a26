"""The scenario file: its records, and what its errors say."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest
from pydantic import TypeAdapter

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.scenario import Bias, Event, Override, Reset, ScenarioFile, load_scenario
from evcosim.cosim.system.system import load_system
from evcosim.cosim.system.toml import validate


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({"stimulus": [{"to": "a.b", "constant": 1.0}, {"to": "a.b", "sine": {"amplitude": math.nan, "period": 1}}]},
         "stimulus 2.sine.amplitude: Input should be a finite number, not nan"),
        ({"stimulus": [{"to": "a.b", "ramp": {"slope": math.inf}}]}, "stimulus 1.ramp.slope: Input should be a finite"),
        ({"event": [{"time": 1.0, "action": "bias", "variable": "a.b", "value": math.inf}]},
         "event 1.value: Input should be a finite number, not inf"),
        ({"experiment": {"step_size": math.inf}}, "experiment.step_size: Input should be a finite number"),
    ],
)  # fmt: skip
def test_numbers_of_a_scenario_are_finite(data, said):
    with pytest.raises(ConfigError, match=re.escape(said)):
        validate(data, ScenarioFile, "s.toml")


# ---- events


def event(**keys: Any) -> Event:
    """The event of a scenario file, at 1 s and of a.b unless `keys` say otherwise; None leaves a key out."""
    table = {"time": 1.0, "variable": "a.b"} | keys
    data = {"event": [{k: v for k, v in table.items() if v is not None}]}
    (read,) = validate(data, ScenarioFile, "s.toml").events
    return read


def test_the_action_chooses_the_record():
    assert event(action="override", value=2) == Override(
        time=1.0, action="override", variable="a.b", value=2.0
    )
    assert event(action="bias", value=-2) == Bias(time=1.0, action="bias", variable="a.b", value=-2.0)
    assert event(action="reset") == Reset(time=1.0, action="reset", variable="a.b")
    assert event(action="reset").needs == ("a.b",)


def test_every_record_is_found_by_its_action():
    schema = TypeAdapter(Event).json_schema()
    assert set(schema["discriminator"]["mapping"]) == {"override", "bias", "reset", "set"}


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"action": "overide", "value": 1}, "event 1.action: Input should be 'override', 'bias', 'reset' or 'set', not 'overide' (did you mean 'override'?)"),
        ({"action": 5}, "event 1.action: Input should be 'override', 'bias', 'reset' or 'set', not 5"),
        ({"action": ["reset"]}, "event 1.action: Input should be 'override', 'bias', 'reset' or 'set', not ['reset']"),
        ({"value": 1}, "event 1.action: this key is needed"),
        ({"acton": "reset"}, "event 1.acton: unknown key (did you mean 'action'?)"),
        ({"action": "override"}, 'event 1.value: this key is needed with action = "override"'),
        ({"action": "bias"}, 'event 1.value: this key is needed with action = "bias"'),
        ({"action": "reset", "value": 1.0}, 'event 1.value: unknown key with action = "reset"'),
        ({"action": "bias", "value": "x"}, "event 1.value: Input should be a valid number, not 'x'"),
        ({"action": "reset", "time": -2e12}, "event 1.time: Input should be greater than or equal to -1000000000000, not -2000000000000.0"),
        ({"action": "reset", "variable": "ab"}, "event 1.variable: a variable is written unit.variable, not 'ab'"),
        ({"action": "bias", "value": 1, "bias": 2}, 'event 1.bias: unknown key with action = "bias"'),
        ({"action": "override", "value": 1, "valeu": 2}, "event 1.valeu: unknown key with action = \"override\" (did you mean 'value'?)"),
    ],
)  # fmt: skip # one case a line
def test_a_wrong_event_is_named_by_its_key(keys, said):
    with pytest.raises(ConfigError) as caught:
        event(**keys)
    assert str(caught.value) == f"s.toml: {said}"


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(ConfigError) as caught:
        event(action="override", time=None, override=2.0)
    assert str(caught.value).splitlines() == [
        's.toml: event 1.time: this key is needed with action = "override"',
        's.toml: event 1.value: this key is needed with action = "override"',
        's.toml: event 1.override: unknown key with action = "override"',
    ]


def test_an_event_is_a_table():
    with pytest.raises(ConfigError, match=r"^s.toml: event 1: a table is needed, not 'reset'$"):
        validate({"event": ["reset"]}, ScenarioFile, "s.toml")


# ---- by name


def test_an_unknown_scenario_says_what_there_is():
    with pytest.raises(ConfigError, match=r"^system 'scooter' has no scenario 'fig7' \(did you mean 'fig"):
        load_scenario(load_system("scooter"), "fig7")
