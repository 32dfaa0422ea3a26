"""Signals that are coarser than their DBC says."""

from __future__ import annotations

import dataclasses

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.quantization import reference
from evcosim.cosim.can.resolution import with_resolution

VALUE = Signal("Value", 0, 16, signed=True, scale=0.1, offset=0.5, minimum=-20.0, maximum=20.0, unit="m")
BARE = Signal("Bare", 16, 8, scale=0.25, offset=0)


def test_limits_of_a_signal_stay():
    for signal, resolution, ends in (
        (VALUE, "ideal", (-20.0, 20.0)),
        (BARE, "ideal", (0.0, 63.75)),  # no limits in the DBC: those of its bits
        (BARE, 2, (0.0, 127.5)),  # as in a DBC with twice the scale
        (dataclasses.replace(BARE, maximum=10.1), "ideal", (0.0, 10.1)),
        (dataclasses.replace(BARE, scale=-0.25, not_available=255), "ideal", (-63.5, 0.0)),
    ):
        changed = with_resolution(signal, resolution)
        assert tuple(reference(changed, BusSettings(), x)[1] for x in (-1e3, 1e3)) == ends


def test_whole_scales_stay_integers():
    signal = Signal("Large", 0, 63, scale=3)
    assert with_resolution(signal, 2.0).scale == 6
    assert isinstance(with_resolution(signal, 2.0).scale, int)
    assert with_resolution(signal, 1.5).scale == 4.5
    single = Signal("Single", 0, 32, is_float=True, scale=1.0)
    assert with_resolution(single, 4.0) == single


def received(signal: Signal, x: float) -> float:
    return reference(signal, BusSettings(), x)[1]


@given(st.floats(-20.0, 20.0), st.sampled_from([1.0, 2.0, 2.5, 8.0]))
def test_what_arrives_is_within_half_a_step_of_the_coarser_signal(x, factor):
    coarse = with_resolution(VALUE, factor)
    assert abs(received(coarse, x) - x) <= 0.5 * 0.1 * factor * (1 + 1e-9)


@given(st.floats(-20.0, 20.0))
def test_ideal_changes_no_value_in_range(x):
    assert received(with_resolution(VALUE, "ideal"), x) == x


@given(st.sampled_from([2.0, 3.0, 8.0]), st.sampled_from([2.0, 5.0]))
def test_two_factors_are_their_product(a, b):
    twice, once = with_resolution(with_resolution(VALUE, a), b), with_resolution(VALUE, a * b)
    assert twice.scale == pytest.approx(once.scale, rel=1e-15)
    assert dataclasses.replace(twice, scale=1) == dataclasses.replace(once, scale=1)
