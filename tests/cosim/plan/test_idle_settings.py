"""Settings that do nothing are said with file, bus, key, value and what makes them count; others are not."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from support.mocks import MockUnit, plan_of, real

DBC = """VERSION ""
BS_:
BU_: A B
BO_ 256 M: 8 A
 SG_ Code : 0|8@1+ (1,0) [0|254] "" B
 SG_ Bare : 8|8@1+ (1,0) [0|0] "" B
 SG_ Also : 16|8@1+ (1,0) [0|0] "" B
 SG_ Switch : 24|2@1+ (1,0) [0|1] "" B
 SG_ Crc : 32|8@1+ (1,0) [0|255] "" B
 SG_ Counter : 40|4@1+ (1,0) [0|14] "" B
BO_ 257 Lonely: 8 A
 SG_ Alone : 0|8@1+ (1,0) [0|0] "" B
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 256 10;
VAL_ 256 Code 255 "SNA" ;
VAL_ 256 Switch 3 "SNA" ;
"""
BARE = {"from": "a.y", "to": ["b.u"], "via": "can0.M.Bare"}
CODE = {"from": "a.y", "to": ["b.v"], "via": "can0.M.Code"}
ALSO = {"from": "a.y", "to": ["b.w"], "via": "can0.M.Also"}
E2E = {"profile": "1A", "data_id": 1, "crc": "Crc", "counter": "Counter"}


def said(
    folder: Path, own: dict[str, Any], *connect: dict[str, Any], scenario: Any = None, **options: Any
) -> list[str]:
    """The warnings of a system of two units with these settings of the bus."""
    (folder / "m.dbc").write_text(DBC)
    flag = VariableInfo("flag", "Boolean", "input", "discrete", start=False)
    units = [
        MockUnit("a", [real("y", "output"), VariableInfo("on", "Boolean", "output", "discrete")]),
        MockUnit("b", [real("u", "input"), real("v", "input"), real("w", "input"), real("s", "input"), flag]),
    ]
    file = {
        "connect": list(connect) or [BARE],
        "buses": {"can0": {"dbc": str(folder / "m.dbc"), **own}},
        "experiment": {"stop_time": 0.1},
    }
    return list(plan_of(units, file, scenario, **options).warnings)


def of(message: str = "M", **keys: Any) -> dict[str, Any]:
    return {"messages": {message: keys}}


TIMED = {"timing": "frame"}


@pytest.mark.parametrize(
    ("bus", "connect", "warning"),
    [
        ({"jitter": 1e-3}, (), 'can0.jitter = 0.001 does nothing with timing = "instant"'),
        ({"bit_error_rate": 1e-6}, (), 'can0.bit_error_rate = 1e-06 does nothing with timing = "instant"'),
        ({"seed": 3}, (), 'can0.seed = 3 does nothing: .* `bit_error_rate` is given with timing = "frame"'),
        (TIMED | {"seed": 3}, (), "can0.seed = 3 does nothing: .* `jitter` or `bit_error_rate` is given$"),
        (of(jitter=1e-3), (), 'messages.M.jitter = 0.001 does nothing with timing = "instant"'),
        ({"data_bitrate": 2_000_000}, (), "can0.data_bitrate = 2000000 does nothing: .*`fd = true`"),
        ({"cycle_time": 0.02}, (), "can0.cycle_time = 0.02 does nothing: each message"),
        (
            {"resolution": "ideal", "rounding": "truncate"},
            (),
            'can0.rounding = "truncate" does nothing with resolution = "ideal"',
        ),
        ({"resolution": "ideal"} | of(e2e=E2E), (), 'messages.M.e2e does nothing with resolution = "ideal"'),
        ({"resolution": "ideal"} | of(timeout=3), (), "messages.M.timeout does nothing with resolution"),
        (of(status_optional=True), (), "messages.M.status_optional = true does nothing: there is no"),
        (of(timeout=3), ({**BARE, "to": []},), r"M.timeout = 3 does nothing: nobody receives .*in the `to`"),
        (
            of("Lonely", e2e=E2E, timeout=3),
            (),
            "messages.Lonely: `timeout` and `e2e` do nothing: .*via = \"can0.Lonely.SIGNAL",
        ),
        (of("Lonely", cycle_time=0.02), (), "messages.Lonely: `cycle_time` does nothing: no connection"),
        (
            of(timeout=3, on_timeout="sna"),
            (BARE, CODE, ALSO),
            'M.on_timeout = "sna" does nothing for Bare, Also, which have no "not available" code .* keep '
            "the last value",
        ),
        (of(timeout=3, on_timeout="sna"), (BARE, CODE), "for Bare, which has no"),
    ],
)  # fmt: skip # a table
def test_what_does_nothing_is_said_once(tmp_path, bus, connect, warning):
    (found,) = said(tmp_path, bus, *connect)
    assert re.search(warning, found), found
    assert found.startswith("mocks.toml: buses.can0.")


@pytest.mark.parametrize(
    ("bus", "connect"),
    [
        (TIMED | {"jitter": 1e-3, "seed": 3, "bit_error_rate": 1e-6}, ()),
        (TIMED | {"seed": 3} | of(jitter=1e-3), ()),
        (of(jitter=0.0), ()),
        ({"data_bitrate": 2_000_000, "fd": True}, ()),
        ({"cycle_time": 0.02}, ({**BARE, "via": "can0.Lonely.Alone"},)),
        (of(timeout=3, on_timeout="sna"), (CODE, {**BARE, "to": []})),
        (of(timeout=3, status=["b.s"]), ({**BARE, "to": []},)),
        ({"cycle_time": 0.02} | of("Lonely", timeout=3), ({**BARE, "via": "can0.Lonely.Alone"},)),
        ({"resolution": "ideal"}, ()),
    ],
)
def test_what_counts_is_not_said(tmp_path, bus, connect):
    assert said(tmp_path, bus, *connect) == []


def test_who_a_scenario_leaves_out_makes_no_setting_idle(tmp_path):
    bus = of(e2e=E2E, timeout=3, on_timeout="sna")
    for unit in ("a", "b"):
        assert said(tmp_path, bus, scenario={"leave_out": [unit]}) == []


def test_a_variation_is_named_and_its_seed_is_no_setting(tmp_path):
    # as `prepare` does it, the settings have the variation in them
    (found,) = said(tmp_path, {"jitter": 1e-3, "seed": 3}, bus=BusVariation(jitter=1e-3, seed=3))
    assert found.startswith("bus variation: jitter = 0.001 does nothing")


def test_an_ideal_run_has_no_bus_whose_settings_could_count(tmp_path):
    assert said(tmp_path, {"jitter": 1e-3}, ideal=True) == []


def test_a_boolean_has_no_code_of_its_signal_after_a_timeout(tmp_path):
    flag = {"from": "a.on", "to": ["b.flag"], "via": "can0.M.Switch"}
    reason = (
        r'messages.M.on_timeout = "sna": b.flag is a Boolean, 0 or 1, and the code of Switch is 3; "initial"'
    )
    with pytest.raises(ConfigError, match=reason):
        said(tmp_path, of(timeout=3, on_timeout="sna"), flag)
    assert said(tmp_path, of(timeout=3, on_timeout="initial"), flag) == []


def test_frames_of_a_log_have_its_times(tmp_path):
    (tmp_path / "m.log").write_text("(0.000000) can0 100#0301000000000000\n")
    entry = {"can_log": str(tmp_path / "m.log"), "bus": "can0"}
    scenario = {"leave_out": ["a"], "stimulus": [entry]}
    own = {"jitter": 1e-3, "start_delay": 0.01}
    found = said(tmp_path, of(**own), scenario=scenario)
    assert [text.partition(" does nothing: frames of this message come from a log")[0] for text in found] == [
        "mocks.toml: buses.can0.messages.M.start_delay = 0.01",
        "mocks.toml: buses.can0.messages.M.jitter = 0.001",
    ]  # fmt: skip # a list
    assert said(tmp_path, of(start_delay=0.01, timeout=3), scenario=scenario) == []
