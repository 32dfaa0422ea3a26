"""Types along a connection: what a Boolean may receive over a bus, and what a direct connection takes."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.can.database import Signal
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.plan.type_rules import check_boolean, check_status, check_types, check_whole

FLAG = VariableInfo("b", "Boolean", "input")
SENDERS = {
    "Real": VariableInfo("y"),
    "Integer": VariableInfo("y", "Integer"),
    "Boolean": VariableInfo("y", "Boolean"),
    "Switch": VariableInfo("y", "Enumeration", items=((0, "off"), (1, "on"))),
    "State": VariableInfo("y", "Enumeration", items=((0, "off"), (2, "on"))),
}
BIT = Signal("s", 0, 1)
BYTE = Signal("s", 0, 8)


@pytest.mark.parametrize(
    ("sender", "signal", "overflow", "fits"),
    [
        ("Real", BIT, "saturate", True),
        ("Real", BYTE, "saturate", False),
        ("Integer", BYTE, "error", False),
        ("State", BYTE, "saturate", False),
        ("Boolean", BYTE, "wrap", True),
        ("Switch", BYTE, "wrap", True),
        ("Real", dataclasses.replace(BYTE, minimum=0, maximum=1), "saturate", True),
        ("Real", dataclasses.replace(BYTE, minimum=0, maximum=1), "error", True),
        ("Real", dataclasses.replace(BYTE, minimum=0, maximum=1), "wrap", False),
        ("Real", dataclasses.replace(BYTE, minimum=0, maximum=2), "saturate", False),
        ("Real", dataclasses.replace(BIT, signed=True), "saturate", False),
        ("Real", dataclasses.replace(BIT, signed=True, scale=-1), "saturate", True),
        ("Real", dataclasses.replace(BIT, offset=1), "saturate", False),
        ("a log", BIT, "wrap", True),
        ("a log", BYTE, "saturate", False),
        ("a log", dataclasses.replace(BYTE, minimum=0, maximum=1), "wrap", True),
    ],
)  # fmt: skip # one case a line
def test_a_boolean_receives_only_0_and_1_over_a_bus(sender, signal, overflow, fits) -> None:
    if fits:
        check_boolean(SENDERS.get(sender), "a.b", FLAG, signal, overflow, "here")
        return
    with pytest.raises(
        ConfigError, match=r"here: a.b is a Boolean, 0 or 1, and the signal s carries numbers from"
    ):
        check_boolean(SENDERS.get(sender), "a.b", FLAG, signal, overflow, "here")


def test_other_receivers_take_any_number() -> None:
    check_boolean(SENDERS["Real"], "a.n", VariableInfo("n", "Integer", "input"), BYTE, "saturate", "here")


def test_a_boolean_takes_the_status_of_a_timeout_alone() -> None:
    check_status("a.b", FLAG, "M", False, "here")
    check_status("a.n", VariableInfo("n", "Integer", "input"), "M", True, "here")
    with pytest.raises(ConfigError, match=r"here: a.b is a Boolean, 0 or 1, and the status of M is a number"):
        check_status("a.b", FLAG, "M", True, "here")
    with pytest.raises(ConfigError, match=r"here: a.t is a String, and the status of M is a number, which"):
        check_status("a.t", VariableInfo("t", "String", "input"), "M", False, "here")


TAKEN = {
    "Real": "Real Integer Enumeration Boolean",
    "Integer": "Integer Enumeration Boolean",
    "Enumeration": "Integer Enumeration Boolean",
    "Boolean": "Boolean",
    "String": "String",
}


@pytest.mark.parametrize("receiver", TAKEN)
@pytest.mark.parametrize("sender", TAKEN)
def test_a_direct_connection_takes_what_the_receiver_can_hold(sender: str, receiver: str) -> None:
    ends = ("a", "y"), VariableInfo("y", sender), ("b", "u"), VariableInfo("u", receiver), "here"
    if sender in TAKEN[receiver].split():
        check_types(*ends)
        return
    with pytest.raises(ConfigError, match=f"here: a.y is of type {sender}, b.u of type {receiver}"):
        check_types(*ends)


@pytest.mark.parametrize(("scale", "offset"), [(0.5, 0), (1, 0.5)])
def test_whole_receivers_take_whole_signals(scale: float, offset: float) -> None:
    parts = Signal("s", 0, 8, scale=scale, offset=offset)
    check_whole("u.x", VariableInfo("x", "Real"), parts, "here")
    check_whole("u.x", VariableInfo("x", "Integer"), Signal("s", 0, 8, scale=2, offset=-3), "here")
    said = f"here: u.x is of type Integer, the signal has scale {scale} and offset {offset}"
    with pytest.raises(ConfigError, match=said):
        check_whole("u.x", VariableInfo("x", "Integer"), parts, "here")
