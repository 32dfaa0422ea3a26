"""What receives the frames of a log; whole runs are in tests/master/test_replay.py."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from evcosim.cosim.can.database import Message
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.plan.log_receivers import LogReceivers
from evcosim.cosim.plan.plan import Plan
from support.mocks import MockUnit, plan_of, real

DBC = """VERSION ""
BS_:
BU_: ECU
BO_ 256 M: 8 ECU
 SG_ Byte : 0|8@1+ (1,0) [0|0] "" ECU
 SG_ Switch : 8|2@1+ (1,0) [0|1] "" ECU
 SG_ Wide : 16|8@1+ (1,0) [0|1000] "" ECU
BO_ 257 N: 8 ECU
 SG_ Other : 0|8@1+ (1,0) [0|0] "" ECU
"""


def test_messages_that_units_send_are_known_by_identifier() -> None:
    messages = [
        SimpleNamespace(bus="a", message=Message("f", "M", 5), replayed=False),
        SimpleNamespace(bus="a", message=Message("f", "N", 6, True), replayed=True),
        SimpleNamespace(bus="b", message=Message("f", "O", 7), replayed=False),
    ]
    received = LogReceivers(None, {}, None, SimpleNamespace(messages=messages), False)
    assert received.sent("a") == {(5, False): "M"}


def heard(folder: Path, signals: dict[str, str], messages: list[str] | None = None, **bus: Any) -> Plan:
    """The plan of a unit `b` with a Boolean `flag` and a number `x`, which hears signals of a log."""
    (folder / "m.dbc").write_text(DBC)
    (folder / "m.log").write_text("(0.000000) can0 100#0301000000000000\n")
    unit = MockUnit(
        "b", [VariableInfo("flag", "Boolean", "input", "discrete", start=False), real("x", "input")]
    )
    to = {f"b.{name}": f"M.{signal}" for name, signal in signals.items()}
    stimulus = {"can_log": str(folder / "m.log"), "bus": "can0", "to": to, "messages": messages}
    buses = {"can0": {"dbc": str(folder / "m.dbc"), "cycle_time": 0.01, **bus}}
    return plan_of([unit], {"buses": buses, "experiment": {"stop_time": 0.1}}, {"stimulus": [stimulus]})


@pytest.mark.parametrize("overflow", ["saturate", "wrap"])
def test_a_boolean_takes_no_byte_of_a_log(tmp_path: Path, overflow: str) -> None:
    said = r"stimulus 1.to: b.flag is a Boolean, 0 or 1, and the signal Byte carries numbers from 0 to 255"
    with pytest.raises(ConfigError, match=said):
        heard(tmp_path, {"flag": "Byte"}, overflow=overflow)
    made = heard(tmp_path, {"flag": "Switch"}, overflow=overflow)  # the database says that it is 0 or 1
    assert made.inputs["b.flag"].driver == f"can0.M.Switch of {tmp_path / 'm.log'}"


@pytest.mark.parametrize("overflow", ["saturate", "wrap", "error"])
def test_limits_that_no_frame_of_a_log_has_are_said(tmp_path: Path, overflow: str) -> None:
    (said,) = heard(tmp_path, {"x": "Wide"}, overflow=overflow).warnings
    assert "m.dbc: line 7: can0.M.Wide: its limits [0, 1000] mean raw 0 to 1000" in said
    assert said.endswith(": no frame of a log has 1000")
    assert heard(tmp_path, {"x": "Byte"}).warnings == ()


def test_messages_that_are_named_and_not_heard_are_said_and_heard_ones_that_are_not_named_refused(
    tmp_path: Path,
) -> None:
    assert heard(tmp_path, {"x": "Byte"}, ["M"]).warnings == ()
    (said,) = heard(tmp_path, {"x": "Byte"}, ["M", "N"]).warnings
    assert "stimulus 1.messages: nothing receives can0.N: it is not replayed; an input in `to`" in said
    reason = r"stimulus 1.to: b.x would receive M.Byte, and `messages` leaves M out"
    with pytest.raises(ConfigError, match=reason):
        heard(tmp_path, {"x": "Byte"}, ["N"])
