"""The steps at which messages are sent, from settings and from the attributes of a DBC."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.can.send_types import Sending
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.plan import MessagePlan, Plan
from support.databases import write
from support.mocks import MockUnit, plan_of, real

SIGNALS = ('S : 0|8@1+ (1,0) [0|0] "" X', 'T : 8|8@1- (1,0) [0|0] "" X')
TAIL = """BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","OnChange","CyclicIfActive","NoMsgSendType","BAF";
BA_DEF_ BO_ "GenMsgDelayTime" INT 0 10000;
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_ BO_ "GenMsgCycleTimeFast" INT 0 10000;
BA_DEF_ SG_ "GenSigSendType" ENUM "Cyclic","OnWrite","OnChangeWithRepetition","NoSigSendType";
BA_DEF_ SG_ "GenSigInactiveValue" INT -100 100;
BA_DEF_DEF_ "GenMsgSendType" "Cyclic";
BA_DEF_DEF_ "GenSigSendType" "NoSigSendType";
BA_DEF_DEF_ "GenMsgDelayTime" 0;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "GenMsgCycleTimeFast" 0;
"""


def made(folder: Path, attributes: str = "", units: Any = None, sent: str = "c.M.S", **own: Any) -> Plan:
    bus: dict[str, Any] = {"dbc": str(write(folder, *SIGNALS, tail=TAIL + attributes))}
    bus |= {"messages": {"M": own}} if own else {}
    connect = [{"from": "a.y", "via": sent}]
    return plan_of(
        [MockUnit("a", [real("y", "output")])],
        {"connect": connect, "buses": {"c": bus}, **({"units": units} if units else {})},
    )


def times(plan: Plan) -> tuple[int, int, Sending]:
    message: MessagePlan = plan.messages[0]
    return message.every, message.first, message.sending


def attribute(name: str, value: int, of: str = "BO_ 1") -> str:
    return f'BA_ "{name}" {of} {value};\n'


@pytest.mark.parametrize(
    ("own", "every", "first", "sending"),
    [
        ({"cycle_time": 0.05}, 5, 0, Sending()),
        ({"send_type": "on_change"}, 1, 0, Sending("on_change")),
        ({"send_type": "on_change", "min_interval": 0.03}, 1, 0, Sending("on_change", 0, 3)),
        ({"send_type": "on_change", "start_delay": 0.02}, 1, 2, Sending("on_change")),
        ({"send_type": "cyclic_and_on_change", "cycle_time": 0.1}, 1, 0, Sending("cyclic_and_on_change", 10)),
        ({"send_type": "if_active", "cycle_time": 0.1}, 1, 0, Sending("if_active", 10)),
        ({"send_type": "on_write"}, 4, 3, Sending("on_write")),
        ({"send_type": "on_write", "start_delay": 0.04}, 4, 7, Sending("on_write")),
    ],
)  # fmt: skip # rows
def test_the_steps_of_each_send_type(tmp_path, own, every, first, sending):
    units = {"a": {"period": 0.04, "offset": 0.03}}
    assert times(made(tmp_path, units=units, **own)) == (every, first, sending)


@pytest.mark.parametrize("period", [1, 2, 3, 10])
@pytest.mark.parametrize("interval", [1, 2, 3, 4, 15, 20])
def test_a_write_within_the_interval_is_sent_when_that_ends(tmp_path, period, interval):
    """As AUTOSAR COM defers it with a minimum delay time: a write waits, and a later one joins it."""
    own = {"send_type": "on_write", "min_interval": round(interval * 0.01, 2)}
    every, first, sending = times(made(tmp_path, units={"a": {"period": round(period * 0.01, 2)}}, **own))
    sent: list[int] = []
    waits = False
    for k in range(200):
        waits |= k % period == 0
        if waits and (not sent or k - sent[-1] >= interval):
            sent.append(k)
            waits = False
    assert list(range(first, 200, every)) == sent
    assert sending == Sending("on_write", 0, interval)


def test_the_attributes_of_a_database(tmp_path):
    change = attribute("GenMsgSendType", 1) + attribute("GenMsgDelayTime", 25)
    assert times(made(tmp_path, change)) == (1, 0, Sending("on_change", 0, 3))  # 25 ms are three steps
    active = attribute("GenMsgSendType", 2) + attribute("GenMsgCycleTime", 500)
    assert times(made(tmp_path, active))[2] == Sending("if_active", 50)
    active += attribute("GenMsgCycleTimeFast", 20) + attribute("GenSigInactiveValue", -1, "SG_ 1 T")
    plan = made(tmp_path, active)
    assert times(plan)[2] == Sending("if_active", 2)
    assert plan.messages[0].message.signals["T"].inactive_raw == -1
    assert times(made(tmp_path, active, cycle_time=0.1)) == (10, 0, Sending())  # a setting makes it cyclic
    signals = attribute("GenMsgSendType", 3) + attribute("GenSigSendType", 1, "SG_ 1 S")
    assert times(made(tmp_path, signals))[2].kind == "on_write"


def test_what_of_a_database_is_not_simulated_is_said(tmp_path):
    cycle = attribute("GenMsgCycleTime", 10)
    silent = attribute("GenMsgSendType", 3)
    for attributes, said in (
        (attribute("GenMsgSendType", 4), "c.M has the send type BAF, which is not simulated"),
        (silent + attribute("GenSigSendType", 2, "SG_ 1 S"), "OnChangeWithRepetition, whose repetitions"),
    ):  # fmt: skip # rows
        (found,) = (w for w in made(tmp_path, cycle + attributes).warnings if "send type" in w)
        assert said in found
    for attributes in ("", silent, attribute("GenMsgSendType", 0)):
        assert not [w for w in made(tmp_path, cycle + attributes).warnings if "send type" in w]


def test_a_cyclic_message_needs_a_cycle_time_and_one_on_change_does_not(tmp_path):
    for kind in ("cyclic", "cyclic_and_on_change", "if_active"):
        with pytest.raises(ConfigError, match="message 'M' has no cycle time"):
            made(tmp_path, send_type=kind)


def test_the_bus_factor_of_cycles_is_one_of_all_times(tmp_path):
    plan = made(tmp_path, send_type="cyclic_and_on_change", cycle_time=0.1, min_interval=0.02)
    assert times(plan)[2] == Sending("cyclic_and_on_change", 10, 2)
    assert plan.messages[0].cycle == 10
