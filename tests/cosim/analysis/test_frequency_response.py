"""Spectra: a gain is found at all frequencies, noise is seen in the coherence."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.analysis.first_order import FirstOrder
from evcosim.cosim.analysis.frequency_response import (
    averaged,
    block_length,
    frequency_response,
    midpoints,
)
from evcosim.cosim.errors import ConfigError
from support.swept import BAND, RATE, exact, swept


@given(st.integers(1, 50), st.integers(50, 500))
def test_averages_keep_the_mean(block, count):
    values = np.random.default_rng(block).normal(size=block * count)
    assert averaged(values, block).mean() == pytest.approx(values.mean(), abs=1e-12)


def test_a_pure_gain_has_its_response_everywhere():
    u, _ = swept(FirstOrder(1.0, 0.03))
    found = frequency_response(u, -2.5 * u, RATE)
    inside = found.within((0.012, 0.55))
    assert inside.response == pytest.approx(np.full(len(inside.response), -2.5), rel=1e-9)
    assert inside.coherence == pytest.approx(np.ones(len(inside.response)))


def test_noise_lowers_the_coherence():
    u, y = swept(FirstOrder(0.46, 0.03))
    noise = np.random.default_rng(0).normal(size=len(y))
    coherence = [
        frequency_response(u, y + size * noise, RATE).within(BAND).coherence.mean()
        for size in (0.0, 0.3, 3.0)
    ]
    assert coherence[0] > 0.99 > coherence[1] > coherence[2]


def test_signals_that_say_nothing_are_refused():
    u, y = swept(FirstOrder(0.46, 0.03))
    broken = y.copy()
    broken[7] = np.nan
    for a, b, text in (
        (u, np.full_like(u, 3.0), r"output is constant \(3\)"),
        (np.zeros_like(u), y, r"input is constant \(0\)"),
        (u, broken, "output is nan at sample 7"),
        (u, y[:-1], "two signals of the same length"),
        (u[:16], y[:16], "sweep for longer"),
    ):
        with pytest.raises(ConfigError, match=text):
            frequency_response(a, b, RATE)


def test_block_gives_eight_samples_in_the_shortest_period():
    assert block_length(0.6, 0.01) == 20
    assert block_length(12.5, 0.01) == 1


@given(st.integers(1, 40), st.floats(-10.0, 10.0), st.floats(-1.0, 1.0))
def test_midpoints_of_a_line_lie_on_it_half_a_step_later(count, start, slope):
    k = np.arange(count)
    assert midpoints(start + slope * k) == pytest.approx(start + slope * (k[:-1] + 0.5))


@given(st.floats(0.05, 0.5), st.floats(0.05, 0.5))
def test_a_part_of_a_response_has_the_points_in_its_band(low, wide):
    data = exact(FirstOrder(2.0, 0.1), np.linspace(0.01, 1.2, 120))
    part = data.within((low, low + wide))
    inside = (data.frequency >= low) & (data.frequency <= low + wide)
    assert np.array_equal(part.frequency, data.frequency[inside])
    assert np.array_equal(part.response, data.response[inside])
    assert part.resolution == pytest.approx(data.resolution) == pytest.approx(0.01)


def test_gains_in_series_multiply():
    """The response from u to y times that from y to z is that from u to z, where all is coherent."""
    u, y = swept(FirstOrder(0.46, 0.03))
    _, z = swept(FirstOrder(-3.0, 0.03))
    first, second, both = (frequency_response(a, b, RATE).within(BAND) for a, b in ((u, y), (y, z), (u, z)))
    assert first.response * second.response == pytest.approx(both.response, rel=1e-3)


def test_the_response_does_not_depend_on_levels_and_units():
    u, y = swept(FirstOrder(0.46, 0.03))
    plain, other = frequency_response(u, y, RATE), frequency_response(10.0 * u + 28.0, 3.6 * y + 30.0, RATE)
    assert other.within(BAND).response == pytest.approx(0.36 * plain.within(BAND).response, rel=1e-6)
