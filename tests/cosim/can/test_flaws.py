"""The flaws of a database: which signals share bits in a frame, and where a code ends a range."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message, Signal, check_signal
from evcosim.cosim.can.flaws import checked, clipped, code_by_text, database_of
from evcosim.cosim.can.quantization import reference

PAGE = Signal("Page", 0, 4, is_multiplexer=True)
SUB = Signal("Sub", 4, 4, is_multiplexer=True, multiplexer="Page", multiplexer_ranges=((1, 1),))


def of(name: str, multiplexer: str, *ranges: tuple[int, int], start: int = 8) -> Signal:
    return Signal(name, start, 8, multiplexer=multiplexer, multiplexer_ranges=ranges)


def problems(*signals: Signal) -> dict[str, str]:
    message = checked(Message("test.dbc", "M", 1, signals={s.name: s for s in signals}))
    return {name: signal.problem for name, signal in message.signals.items() if signal.problem}


@pytest.mark.parametrize(
    ("one", "other", "meet"),
    [
        (of("a", "Page", (0, 0)), of("b", "Page", (1, 1)), False),
        (of("a", "Page", (0, 2)), of("b", "Page", (2, 3)), True),
        (of("a", "Page", (0, 0), (5, 7)), of("b", "Page", (1, 4), (8, 9)), False),
        (of("a", "Page", (0, 0)), Signal("b", 8, 8), True),
        (of("a", "Page", (0, 0)), of("b", "Sub", (0, 0)), False),  # Sub is in page 1
        (of("a", "Page", (1, 1)), of("b", "Sub", (0, 0)), True),
        (of("a", "Sub", (1, 1)), of("b", "Sub", (0, 0)), False),
    ],
)
def test_signals_of_pages_that_never_meet_may_share_bits(one, other, meet):
    said = "'a' and 'b' overlap in bits 8 to 15"
    assert problems(PAGE, SUB, one, other) == ({"a": said, "b": said} if meet else {})


def test_multiplexers_that_select_each_other_are_a_flaw_and_no_endless_loop():
    one = Signal("a", 0, 4, is_multiplexer=True, multiplexer="b", multiplexer_ranges=((0, 0),))
    other = Signal("b", 4, 4, is_multiplexer=True, multiplexer="a", multiplexer_ranges=((0, 0),))
    assert problems(one, other) == {
        "a": "it selects itself: a <- b <- a",
        "b": "its multiplexer 'a' is no signal that can be used",
    }
    assert problems(of("c", "gone", (0, 0)))["c"] == "its multiplexer 'gone' is no signal that can be used"
    signed = Signal("Page", 0, 4, is_multiplexer=True, signed=True)
    said = "no value of its multiplexer 'Page' that selects it is one of 4 signed bits"
    assert problems(signed, of("c", "Page", (8, 9)), of("d", "Page", (3, 9))) == {"c": said}


def test_a_flaw_of_a_multiplexer_is_one_of_what_it_selects():
    sub = dataclasses.replace(SUB, start=6, length=4)
    said = problems(PAGE, sub, of("a", "Sub", (0, 0), start=16), of("b", "Page", (2, 2)), Signal("c", 9, 1))
    assert said["Sub"] == said["c"] == "'Sub' and 'c' overlap in bit 9"
    assert said["a"] == "its multiplexer 'Sub' is no signal that can be used"
    assert set(said) == {"Sub", "c", "a", "b"}  # b, of another page than Sub, meets c


def test_three_signals_of_one_bit_all_have_a_flaw():
    assert set(problems(*(Signal(name, 3, 1) for name in "abc"))) == {"a", "b", "c"}


@pytest.mark.parametrize(
    ("choices", "code"),
    [
        ({255: "SNA"}, 255),
        ({3: "Not available"}, 3),
        ({3: "SIGNAL_NOT_AVAILABLE", 0: "Off"}, 3),
        ({3: "available"}, None),
        ({}, None),
    ],
)
def test_a_description_that_says_that_there_is_no_value(choices, code):
    assert code_by_text(choices) == code


@pytest.mark.parametrize(
    ("signal", "limits", "note"),
    [
        (
            Signal("S", 0, 8, minimum=0, maximum=255, not_available=255),
            (0, 254),
            "its maximum 255 would be sent as raw 255",
        ),
        (
            Signal("S", 0, 8, minimum=0, maximum=300, not_available=255),
            (0, 254),
            "254 (raw 254) is the last value",
        ),
        (
            Signal("S", 0, 12, scale=0.05, offset=-25, minimum=-25, maximum=179.75, not_available=4095),
            (-25, 4094 * 0.05 - 25),
            "179.7 (raw 4094)",
        ),
        (Signal("S", 0, 2, minimum=0, maximum=3, not_available=3), (0, 2), "2 (raw 2) is the last"),
        (
            Signal("S", 0, 8, minimum=0, maximum=255, not_available=0),
            (1, 255),
            "its minimum 0 would be sent as raw 0",
        ),
        (Signal("S", 0, 8, minimum=0, maximum=250, not_available=250), (0, 249), "249 (raw 249)"),
        (
            Signal("S", 0, 8, scale=-1, offset=255, minimum=0, maximum=100, not_available=255),
            (1, 100),
            "its minimum 0",
        ),
        (
            Signal("S", 0, 8, signed=True, minimum=-128, maximum=127, not_available=-128),
            (-127, 127),
            "its minimum -128",
        ),
        (Signal("S", 0, 8, minimum=0, maximum=254, not_available=255), (0, 254), ""),
        (Signal("S", 0, 8, not_available=255), (None, None), ""),
        (Signal("S", 0, 8, minimum=0, maximum=255, not_available=9), (0, 255), ""),
        (Signal("S", 0, 1, minimum=1, maximum=1, not_available=1), (1, 1), ""),
        (Signal("S", 0, 8, scale=0, minimum=0, maximum=255, not_available=255), (0, 255), ""),
    ],
)
def test_a_range_ends_one_short_of_the_code_at_its_end(signal, limits, note):
    made = clipped(signal)
    assert (made.minimum, made.maximum) == limits
    assert note in made.note and bool(note) == bool(made.note)


@given(
    st.integers(2, 16),
    st.booleans(),
    st.sampled_from([1, 0.5, -0.1, 3]),
    st.sampled_from([0, -40, 0.25]),
    st.data(),
)
def test_no_value_is_sent_as_the_code_at_the_end(length, signed, scale, offset, data):
    bare = Signal("S", 0, length, signed=signed, scale=scale, offset=offset)
    ends = sorted(raw * scale + offset for raw in bare.raw_type_range)
    code = data.draw(st.sampled_from(bare.raw_type_range))
    signal = clipped(dataclasses.replace(bare, minimum=ends[0], maximum=ends[1], not_available=code))
    check_signal(Message("ev.dbc", "M", 1, signals={"S": signal}), signal)
    x = data.draw(st.floats(ends[0] - 5, ends[1] + 5))
    assert reference(signal, BusSettings(), x)[0] != code


def test_flaws_stand_in_the_order_of_the_lines():
    messages = [
        Message("f.dbc", "B", 2, signals={"S": Signal("S", 99, 8, line=9)}, line=8),
        Message("f.dbc", "A", 3, length=2000, line=3),
    ]
    database = database_of(Path("f.dbc"), messages, [(5, "five"), (0, "none")], ["N", "N"])
    assert [w.split(": ", 2)[1] for w in database.warnings] == ["none", "line 3", "line 5", "line 9"]
    assert (database.nodes, list(database.messages)) == (("N",), ["B", "A"])


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        (Signal("S", 0, 8), "raw -1, 256, 300, which 8 unsigned bits do not hold"),
        (Signal("S", 0, 8, signed=True), "raw 256, 300, which 8 signed bits do not hold"),
        (Signal("S", 0, 9), "raw -1, which 9 unsigned bits do not hold"),
        (Signal("S", 0, 10, signed=True), ""),
        (Signal("S", 0, 32, is_float=True), ""),
        (Signal("S", 0, 9, problem="bad"), ""),
    ],
)
def test_texts_of_codes_that_no_frame_holds_are_a_warning(signal: Signal, said: str) -> None:
    choices = dict.fromkeys((0, 255, 256, 300, -1), "text")
    signal = dataclasses.replace(signal, choices=choices, line=7)
    warnings = database_of(Path("f"), [Message("f", "M", 1, False, 8, signals={"S": signal})]).warnings
    found = [text for text in warnings if "has a text for" in text]
    assert len(found) == bool(said)
    assert not said or found == [f"f: line 7: message 'M': signal 'S' has a text for {said}"]


def test_many_codes_that_no_frame_holds_are_cut_short() -> None:
    signal = Signal("S", 0, 1, choices=dict.fromkeys(range(20), "text"))
    (said,) = database_of(Path("f"), [Message("f", "M", 1, False, 8, signals={"S": signal})]).warnings
    assert "raw 2, 3, 4, 5, 6, 7, 8, 9 ..., which" in said
