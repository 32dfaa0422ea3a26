"""The definition of a signal's effect on a value, by relations, and the constants of the engines."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evcosim.cosim.can import quantization
from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.quantization import ChannelError, decode, operation, quantize, reference
from evcosim.cosim.errors import ConfigError
from support.channels import FREE, POWER, SPEED, THROTTLE, cases, settings, signals

SATURATE = BusSettings()


def round_exactly(q: float, rounding: str) -> int:
    """Independent of the implementation: by exact fractions."""
    exact = Fraction(q)
    if rounding == "half_even":
        return round(exact)
    if rounding == "truncate":
        return math.floor(exact) if exact >= 0 else math.ceil(exact)
    half = Fraction(1, 2)
    return math.floor(exact + half) if exact >= 0 else math.ceil(exact - half)


@given(st.floats(-1e18, 1e18), st.sampled_from(["nearest", "half_even", "truncate"]))
def test_the_definition_rounds_as_exact_fractions_do(q: float, rounding: str) -> None:
    wide = Signal("S", 0, 64, signed=True)
    raw, _ = reference(wide, BusSettings(rounding=rounding), q)  # type: ignore[arg-type] # sampled text
    assert raw == round_exactly(q, rounding)


@given(st.integers(0, 255), st.sampled_from(["nearest", "half_even"]))
def test_decode_and_quantize_are_inverse_at_raw_values(raw: int, rounding: str) -> None:
    assert quantize(THROTTLE, rounding, decode(THROTTLE, raw)) == raw  # type: ignore[arg-type] # sampled text


@given(cases())
def test_what_arrived_arrives_again(case: tuple[Signal, BusSettings, list[float]]) -> None:
    """Saturate twice is saturate once; where a value is rounded to the nearest, so is what it became."""
    signal, use, values = case
    assume(use.overflow == "saturate" and use.rounding != "truncate")
    low, high = signal.minimum, signal.maximum
    for x in values:
        if math.isnan(x):
            continue
        once = reference(signal, use, x)[1]
        within = (low is None or low <= once) and (high is None or once <= high)
        if within:  # a limit may lie between two raw values
            assert reference(signal, use, once)[1] == pytest.approx(once, rel=1e-12, abs=1e-300)


@given(signals(), settings, st.floats(allow_nan=False), st.floats(allow_nan=False))
def test_the_raw_value_is_monotone_under_saturation(
    signal: Signal, use: BusSettings, a: float, b: float
) -> None:
    assume(use.overflow == "saturate")
    a, b = sorted((a, b))
    first, second = reference(signal, use, a)[0], reference(signal, use, b)[0]
    assert first <= second if signal.scale > 0 else first >= second


@given(st.floats(0.0, 100.0))
def test_a_value_in_range_arrives_within_half_a_step(x: float) -> None:
    assert abs(reference(THROTTLE, SATURATE, x)[1] - x) <= 0.2 * (1 + 1e-12)


@pytest.mark.parametrize("signal", [THROTTLE, SPEED, POWER, FREE])
def test_the_constants_are_those_of_the_definition(signal: Signal) -> None:
    op = operation(signal, SATURATE)
    assert (op.scale, op.offset, op.kind) == (signal.scale, signal.offset, "integer")
    assert (op.raw_below, op.raw_above) == tuple(
        reference(signal, SATURATE, x)[0] for x in (-math.inf, math.inf)
    )
    for overflow in ("wrap", "error"):
        other = operation(signal, BusSettings(overflow=overflow))  # type: ignore[arg-type] # plain text
        assert (other.raw_below, other.raw_above) == (None, None)
    assert op.settings == SATURATE


ALIKE = [
    dataclasses.replace(Signal("S", 0, 32, is_float=is_float), **changes)
    for is_float in (False, True)
    for changes in (
        {"scale": 1},
        {"scale": 1.0},
        {"offset": 0.0, "minimum": 0.0},
        {"offset": -0.0, "minimum": -0.0},
        {"offset": -0.0, "maximum": 0},
        {"name": "T", "start": 32},
        {"signed": True},
        {"not_available": 0},
    )
]


@given(st.lists(st.tuples(st.sampled_from(ALIKE), settings), min_size=2))
def test_constants_that_were_found_before_are_those_of_the_same_signal(
    asked: list[tuple[Signal, BusSettings]],
) -> None:
    together = [repr(operation(signal, use)) for signal, use in asked]
    for (signal, use), found in zip(asked, together, strict=True):
        quantization._limits.clear()
        assert repr(operation(signal, use)) == found


def test_the_constants_that_are_kept_are_so_many_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quantization, "_MOST_LIMITS", 3)
    for length in range(1, 9):
        operation(Signal("S", 0, length), SATURATE)
        assert len(quantization._limits) <= 3


@pytest.mark.parametrize(
    ("signal", "kind"),
    [
        (Signal("S", 0, 50), "integer"),
        (Signal("S", 0, 51), "exact"),
        (Signal("S", 0, 50, scale=2), "exact"),
        (Signal("S", 0, 50, scale=0.5), "integer"),
        (Signal("S", 0, 32, is_float=True), "float32"),
        (Signal("S", 0, 64, is_float=True), "float64"),
    ],
)
def test_the_arithmetic_is_chosen_by_the_greatest_number(signal: Signal, kind: str) -> None:
    assert operation(signal, SATURATE).kind == kind


def test_a_signal_that_can_send_no_value_has_no_constants() -> None:
    with pytest.raises(
        ConfigError, match=r"signal 'S': no value in \[300, 400\] or raw 0 to 255 can be sent"
    ):
        operation(Signal("S", 0, 8, minimum=300, maximum=400), BusSettings(overflow="error"))


def test_an_error_has_signal_value_and_rule() -> None:
    with pytest.raises(ChannelError) as caught:
        reference(SPEED, BusSettings(overflow="error"), 255.0)
    error = caught.value
    assert (error.signal, error.value) == ("Speed", 255.0)
    assert error.rule == "the value 255.0 is outside [0, 254] km/h or raw 0 to 254"
