"""Faults that change nothing, and keys of them, are said; whole runs with faults are in test_faults.py."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from support.mocks import MockUnit, plan_of, real

DBC = """VERSION ""
BS_:
BU_: A B
BO_ 256 M: 8 A
 SG_ S : 0|8@1+ (1,0) [0|0] "" B
 SG_ Crc : 32|8@1+ (1,0) [0|255] "" B
 SG_ Counter : 40|4@1+ (1,0) [0|14] "" B
BO_ 257 Lonely: 8 A
 SG_ Alone : 0|8@1+ (1,0) [0|0] "" B
"""
PROTECTED = {"M": {"e2e": {"profile": "1A", "data_id": 1, "crc": "Crc", "counter": "Counter"}}}
CORRUPT = {"action": "corrupt", "byte": 0}


def said(folder: Path, fault: dict[str, Any], messages: Any = None) -> list[str]:
    """The warnings of a system whose `a` sends M to `b`, and Lonely to nobody, each 20 ms, from 10 ms on."""
    (folder / "m.dbc").write_text(DBC)
    units = [MockUnit("a", [real("y", "output")]), MockUnit("b", [real("u", "input")])]
    own = {"start_delay": 0.01}
    messages = messages or {}
    file = {
        "connect": [
            {"from": "a.y", "to": ["b.u"], "via": "can0.M.S"},
            {"from": "a.y", "via": "can0.Lonely.Alone"},
        ],
        "buses": {
            "can0": {
                "dbc": str(folder / "m.dbc"),
                "cycle_time": 0.02,
                "messages": {name: own | messages.get(name, {}) for name in ("M", "Lonely")},
            }
        },
        "experiment": {"start_time": 1.0, "stop_time": 2.0},
    }
    given = {"time": 1.0, "message": "can0.M"} | fault
    return list(plan_of(units, file, {"fault": [given]}).warnings)


@pytest.mark.parametrize(
    ("fault", "warning"),
    [
        ({"action": "lose", "seed": 3}, "fault 1.seed = 3 does nothing: .* with a `probability` below 1"),
        ({"action": "lose", "probability": 0.0, "seed": 3}, "fault 1.probability = 0 hits no frame"),
        ({"action": "freeze", "counter": "frozen"}, 'fault 1.counter = "frozen" does nothing: .*`e2e`'),
        ({"action": "lose", "message": "can0.Lonely"}, "fault 1: nobody receives .*that frames are lost"),
        (
            {"action": "delay", "by": 0.01, "message": "can0.Lonely"},
            "fault 1: nobody receives .*that frames are late",
        ),
        (
            {"action": "silence", "time": 1.0, "duration": 0.01},
            "fault 1 hits no frame: none is sampled from 1 s on and before 1.01 s; give it a longer",
        ),
        (
            CORRUPT | {"time": 1.031, "duration": 0.019},
            "hits no frame: none is sampled from 1.031 s on and before 1.05 s",
        ),
    ],
)  # fmt: skip # a table
def test_what_changes_nothing_is_said(tmp_path, fault, warning):
    (found,) = said(tmp_path, fault)
    assert re.search(warning, found), found
    assert found.startswith("test.toml: fault 1")


@pytest.mark.parametrize(
    ("fault", "messages"),
    [
        ({"action": "lose", "seed": 3, "probability": 0.5}, None),
        ({"action": "freeze", "counter": "frozen"}, PROTECTED),
        ({"action": "silence", "message": "can0.Lonely"}, None),
        (CORRUPT | {"message": "can0.Lonely"}, None),
        ({"action": "lose", "node": "can0.A", "message": None}, None),
        (CORRUPT | {"time": 1.03, "duration": 0.001}, None),
        (CORRUPT | {"time": 1.031, "duration": 0.01901}, None),
        (CORRUPT | {"time": -5.0, "duration": 6.011}, None),
    ],
)  # fmt: skip # a table
def test_what_hits_a_frame_is_not_said(tmp_path, fault, messages):
    assert said(tmp_path, fault, messages) == []


def test_a_fault_that_is_over_before_the_run_is_told_by_others(tmp_path):
    assert said(tmp_path, {"action": "silence", "time": 0.5, "duration": 0.1}) == []
