"""Signals and messages: their ranges and bits, and the rules that a channel relies on."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal, check_signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.errors import ConfigError
from support.databases import EV, refusal, write

# ---- ranges and bits


def test_float_ranges_are_those_of_ieee_754() -> None:
    single, double = (Signal("S", 0, n, is_float=True).raw_type_range[1] for n in (32, 64))
    assert single == (2 - 2**-23) * 2.0**127
    assert math.nextafter(double, math.inf) == math.inf


@given(st.integers(1, 64), st.booleans())
def test_as_many_raw_values_as_the_bits_hold(length: int, signed: bool) -> None:
    low, high = Signal("S", 0, length, signed=signed).raw_type_range
    assert high - low + 1 == 2**length
    assert (low < 0) == signed


@given(st.integers(1, 16), st.booleans(), st.data())
def test_the_code_at_an_end_is_not_sent(length: int, signed: bool, data: st.DataObject) -> None:
    low, high = (int(end) for end in Signal("S", 0, length, signed=signed).raw_type_range)
    code = data.draw(st.integers(low, high))
    first, last = Signal("S", 0, length, signed=signed, not_available=code).raw_range
    assert (first, last) == (low + (code == low), high - (code == high))


@given(st.integers(0, 63), st.integers(1, 64), st.booleans())
def test_bits_are_as_many_as_the_length_and_each_once(start: int, length: int, little_endian: bool) -> None:
    bits = Signal("S", start, length, little_endian=little_endian).bits
    assert len(set(bits)) == len(bits) == length
    assert bits[0 if little_endian else -1] == start  # the start bit: the least or the most significant one


@given(st.integers(0, 7), st.integers(1, 8))
def test_within_one_byte_both_byte_orders_are_the_same_bits(low: int, length: int) -> None:
    assume(low + length <= 8)
    little = Signal("S", low, length).bits
    assert Signal("S", low + length - 1, length, little_endian=False).bits == little


# ---- the rules


def test_unknown_names_have_the_nearest() -> None:
    database = load_dbc(EV)
    with pytest.raises(
        ConfigError, match=r"^s\.toml: .*ev\.dbc: no message 'EMD_Statu' \(did you mean 'EMD_Status'"
    ):
        database.require("EMD_Statu", "s.toml")
    with pytest.raises(
        ConfigError, match=r"'EMD_Status' has no signal 'EMD_Speed'.*signals: EMD_VehicleSpeed, "
    ):
        database.require("EMD_Status").require("EMD_Speed", "s.toml")


@pytest.mark.parametrize(
    ("signal", "code", "says"),
    [
        (
            'S : 0|9@1+ (1,0) [0|0] "" B',
            255,
            "values in [None, None] are sent as raw 0 to 511, but raw 255 means",
        ),
        (
            'S : 0|8@1+ (1,0) [0|255] "" B',
            254,
            "values in [0, 255] are sent as raw 0 to 255, but raw 254 means",
        ),
        ('S : 0|8@1+ (0.5,-10) [0|100] "" B', 99, "values in [0, 100] are sent as raw 20 to 220, but raw 99"),
    ],
)
def test_a_code_in_the_middle_of_the_range(tmp_path: Path, signal: str, code: int, says: str) -> None:
    message = refusal(write(tmp_path, signal, tail=f'BA_ "GenSigSNA" SG_ 1 S {code};\n'))
    assert message.startswith("scooter.toml: ") and "test.dbc: line 7: M.S: " in message and says in message
    assert f"give the signal a minimum and maximum that leave {code} out" in message


def test_a_range_that_was_not_written_ends_before_the_code(tmp_path: Path) -> None:
    path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', tail='BA_ "GenSigSNA" SG_ 1 S 255;\n')
    signal = load_dbc(path).require("M").require("S")
    assert (signal.raw_type_range, signal.raw_range) == ((0, 255), (0, 254))


@pytest.mark.parametrize(
    ("signal", "says"),
    [
        ('S : 0|8@1+ (0,0) [0|0] "" B', "scale 0 and offset 0: the scale must be finite and not 0, "),
        ('S : 0|8@1+ (1,0) [5|4] "" B', "minimum 5 is above maximum 4"),
        ('S : 0|8@1+ (1,0) [300|400] "" B', "no value in [300, 400] fits into 8 unsigned bits"),
    ],
)
def test_contradictions(tmp_path: Path, signal: str, says: str) -> None:
    assert says in refusal(write(tmp_path, signal))


def test_a_scale_whose_values_are_no_doubles(tmp_path: Path) -> None:
    signal = 'S : 0|8@1+ (1e308,0) [0|0] "" B'
    assert "raw values of 8 unsigned bits are beyond 1.8e+308" in refusal(write(tmp_path, signal))


def test_a_message_that_no_frame_holds_stops_who_asks_for_it(tmp_path: Path) -> None:
    path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', length=1785)
    assert "the message has 1785 bytes, and a frame holds 64 at most" in refusal(path)
    assert load_dbc(path).messages["M"].length == 1785
    too_long = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', length=1786)
    assert "line 7: M.S: the message has 1786 bytes; at most 1785 are read" in refusal(too_long)


def test_a_start_value_that_does_not_fit(tmp_path: Path) -> None:
    path = write(tmp_path, 'S : 0|8@1+ (1,0) [0|0] "" B', tail='BA_ "GenSigStartValue" SG_ 1 S 256;\n')
    assert "M.S: the start value 256 is no raw value of 8 unsigned bits" in refusal(path)


def test_a_message_nobody_asks_for_stops_nothing(tmp_path: Path) -> None:
    path = write(tmp_path, 'S : 0|8@1+ (1,0) [5|4] "" B')
    assert "M" in load_dbc(path).messages


GOOD = Signal("S", 0, 8, scale=0.4, minimum=0.0, maximum=100.0, not_available=255)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"is_float": True, "length": 16}, "a float of 16 bits; 32 or 64 are supported"),
        ({"scale": math.inf}, "scale inf and offset 0"),
        ({"offset": math.nan}, "scale 0.4 and offset nan"),
        ({"minimum": 101.0}, "minimum 101.0 is above maximum 100.0"),
    ],
)
def test_a_signal_that_breaks_a_rule_is_named(change: dict[str, object], says: str) -> None:
    check_signal(Message("ev.dbc", "M", 1, signals={"S": GOOD}), GOOD, "here")
    bad = dataclasses.replace(GOOD, **change)  # type: ignore[arg-type] # parametrized
    with pytest.raises(ConfigError) as caught:
        check_signal(Message("ev.dbc", "M", 1, signals={"S": GOOD}), bad, "here")
    assert str(caught.value).startswith(f"here: ev.dbc: M.S: {says}")
