"""Limits of a signal that no frame holds: what they mean, and what arrives in their place."""

from __future__ import annotations

import dataclasses
import re

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message, Signal, check_signal
from evcosim.cosim.can.limits import limits_note, notes_on
from evcosim.cosim.can.quantization import reference
from evcosim.cosim.errors import ConfigError

PLAIN = BusSettings()


def of(low: float | None, high: float | None, **keys) -> Signal:
    return Signal("S", 0, **({"length": 8} | keys), minimum=low, maximum=high)


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        (of(0.4, 2.6), "[0.4, 2.6] mean raw 0.4 to 2.6, and 8 unsigned bits have the whole raw values 0 to "
                       "255: 0 arrives for 0.4, and 3 arrives for 2.6"),
        (of(0, 1000), "[0, 1000] mean raw 0 to 1000, and 8 unsigned bits have the whole raw values 0 to 255: "
                      "255 arrives for 1000"),
        (of(-40, 100), "mean raw -40 to 100, and 8 unsigned bits have the whole raw values 0 to 255: "
                       "0 arrives for -40"),
        (of(-200, 200, signed=True), "8 signed bits have the whole raw values -128 to 127: -128 arrives for "
                                     "-200, and 127 arrives for 200"),
        (of(0, 100, scale=0.3, unit="%"), "[0, 100] % mean raw 0 to 333.333333, and 8 unsigned bits have the "
                                          "whole raw values 0 to 255: 76.5 arrives for 100"),
        (of(0, 1.25, scale=0.5), "1.5 arrives for 1.25"),
        (of(-2.5, 0, scale=-1), "-3 arrives for -2.5"),
        (of(None, 999), "[none, 999] mean raw 999,"),
        (of(1, 1000, offset=1), "256 arrives for 1000"),
    ],
)  # fmt: skip # a table
def test_what_limits_mean_and_what_arrives(signal, said):
    check_signal(Message("f", "M", 1, signals={"S": signal}), signal)
    assert said in limits_note(signal, PLAIN)


@pytest.mark.parametrize(
    "signal",
    [
        of(0, 255), of(None, None), of(-40, 215, offset=-40), of(0, 102, scale=0.4),
        of(0, 10, is_float=True, length=32),
        of(0, 250.996, scale=1 / 256, length=16),  # written with few digits: raw 64254.976
        of(float("-inf"), float("inf")),
    ],
)  # fmt: skip # a list
def test_limits_that_are_raw_values_are_no_news(signal):
    assert limits_note(signal, PLAIN) == ""


def test_the_settings_of_the_bus_decide_what_arrives():
    signal = of(0.6, 1000)
    assert "1 arrives for 0.6, and 255 arrives for 1000" in limits_note(signal, PLAIN)
    assert "0 arrives for 0.6" in limits_note(signal, BusSettings(rounding="truncate"))
    assert "the run ends with an error for 1000" in limits_note(signal, BusSettings(overflow="error"))
    ideal = limits_note(signal, BusSettings(resolution="ideal"))
    assert "255 arrives for 1000" in ideal and "for 0.6" not in ideal  # which arrives as it is
    assert limits_note(signal, BusSettings(overflow="wrap")) == ""  # limits are left out


@pytest.mark.parametrize("overflow", ["saturate", "wrap", "error"])
def test_frames_of_a_log_have_no_such_limit_whatever_the_bus_does(overflow):
    said = limits_note(of(0.6, 1000), BusSettings(overflow=overflow), replayed=True)
    assert said.endswith("raw values 0 to 255: no frame of a log has 0.6, and no frame of a log has 1000")
    assert limits_note(of(0, 255), BusSettings(overflow=overflow), replayed=True) == ""


@given(
    st.integers(1, 16), st.booleans(), st.sampled_from([1, 2, 0.1, 0.5, -1, -0.25]),
    st.sampled_from([0, -40, 0.5]),
    st.floats(-500, 500, width=16), st.floats(-500, 500, width=16),
)  # fmt: skip # six arguments
def test_a_limit_that_is_not_named_arrives_but_for_a_tenth_of_a_step(
    length, signed, scale, offset, low, high
):
    signal = of(min(low, high), max(low, high), length=length, signed=signed, scale=scale, offset=offset)
    try:
        check_signal(Message("f", "M", 1, signals={"S": signal}), signal)
    except ConfigError:
        assume(False)
    named = set(re.findall(r"arrives for (-?[\d.e+-]+)", limits_note(signal, PLAIN)))
    for limit in {signal.minimum, signal.maximum}:
        _, arriving = reference(signal, PLAIN, limit)
        if f"{limit:.9g}" not in named:
            assert abs(arriving - limit) <= 0.1 * abs(scale) + 1e-9
        else:
            assert f"{arriving:.9g} arrives for {limit:.9g}" in limits_note(signal, PLAIN)


def test_notes_have_file_line_and_signal():
    signal = dataclasses.replace(of(0, 300), note="its file says so", line=7)
    message = Message("car.dbc", "M", 1, signals={"S": signal})
    first, second = notes_on(message, signal, "can0.M.S", PLAIN)
    assert first == "car.dbc: line 7: can0.M.S: its file says so"
    assert second.startswith("car.dbc: line 7: can0.M.S: its limits [0, 300] mean raw 0 to 300")
    (only,) = notes_on(message, of(0, 300), "can0.M.S", PLAIN)
    assert only.startswith("car.dbc: can0.M.S: its limits")  # a file that has no lines
