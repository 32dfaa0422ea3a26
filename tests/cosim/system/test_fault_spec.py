"""Faults as a scenario gives them: each action has its keys, and no others."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.fault_spec import target_of
from evcosim.cosim.system.scenario import ScenarioFile
from evcosim.cosim.system.toml import validate


def fault(**keys: object):
    content = {"fault": [{"time": 0.0} | keys]}
    return validate(content, ScenarioFile, "s.toml").faults[0]


@pytest.mark.parametrize(
    ("keys", "target"),
    [
        ({"action": "lose", "message": "can0.A"}, "can0.A"),
        ({"action": "delay", "node": "can0.N", "by": 0.01}, "can0.N"),
        ({"action": "bus_off", "node": "can0.N"}, "can0.N"),
        ({"action": "babble", "bus": "can0"}, "can0"),
        ({"action": "babble", "node": "can0.N", "id": 0x12345, "extended": True}, "can0.N"),
    ],
)
def test_what_a_fault_acts_on(keys, target):
    assert target_of(fault(**keys)) == target


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"action": "loose", "message": "can0.A"}, "fault 1.action"),
        ({"action": "lose"}, "a fault has a 'message' or a 'node', and not both"),
        ({"action": "lose", "message": "can0.A", "byte": 1}, 'byte: unknown key with action = "lose"'),
        ({"action": "corrupt", "message": "can0.A"}, "fault 1.byte"),
        ({"action": "delay", "message": "can0.A"}, "fault 1.by"),
        ({"action": "delay", "message": "can0.A", "by": 0.0}, "fault 1.by"),
        ({"action": "delay", "message": "can0.A", "by": -0.1}, "fault 1.by"),
        ({"action": "delay", "message": "can0.A", "by": 1e9}, "fault 1.by"),
        ({"action": "bus_off", "message": "can0.A"}, "fault 1"),
        ({"action": "bus_off", "node": "can0.N", "probability": 0.5}, "probability: unknown key with action"),
        ({"action": "babble"}, "'babble' has a 'bus' or a 'node', and not both"),
        ({"action": "babble", "bus": "can0", "node": "can0.N"}, "a 'bus' or a 'node', and not both"),
        ({"action": "babble", "bus": "can0", "id": 0x800}, "0x7FF"),
        ({"action": "babble", "bus": "can0", "id": 2**29, "extended": True}, "fault 1.id"),
        ({"action": "babble", "bus": "can0", "length": 9}, "fault 1.length"),
        ({"action": "babble", "bus": "can0", "period": 0.0}, "fault 1.period"),
        ({"action": "lose", "message": "can0.A", "duration": -1.0}, "fault 1.duration"),
        ({"action": "lose", "message": "can0.A", "probability": -0.1}, "fault 1.probability"),
        ({"action": "lose", "message": "can0.A", "time": float("nan")}, "fault 1.time"),
    ],
)
def test_what_does_not_fit_is_refused(keys, reason):
    with pytest.raises(ConfigError) as error:
        fault(**keys)
    assert reason in str(error.value)
