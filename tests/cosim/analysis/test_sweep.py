"""Sweeps: their frequencies, and numbers that make none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.analysis.sweep import PERIODS, Sweep, sweep_of
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.identification_spec import IdentificationSpec
from support.swept import SWEEP


@given(st.floats(0.001, 0.1), st.floats(1.5, 200.0), st.floats(2.0, 50.0))
def test_sweep_goes_from_its_first_to_its_last_frequency(start, ratio, periods):
    sweep = Sweep(start, start * ratio, periods / start * 1.001, 3.0)
    ends = sweep.frequency(np.array([0.0, sweep.duration * (1.0 - 1e-12)]))
    assert ends == pytest.approx([start, start * ratio], rel=1e-6)
    time = np.linspace(0.0, sweep.duration, 1000, endpoint=False)
    assert np.abs(sweep(time)).max() <= 3.0
    assert sweep(np.zeros(1)) == 0.0
    assert np.array_equal(sweep(time), Sweep(start, start * ratio, sweep.duration, 6.0)(time) / 2.0)


def test_sweep_frequency_is_the_slope_of_its_phase():
    time = np.linspace(0.0, 300.0, 300_001)
    crossings = time[1:][np.diff(np.sign(SWEEP(time))) > 0]
    periods = np.diff(crossings)
    assert 1.0 / periods == pytest.approx(SWEEP.frequency(crossings[:-1] + periods / 2.0), rel=0.02)


def test_repeats_begin_anew():
    sweep = Sweep(0.1, 1.0, 30.0, 1.0, repeats=2)
    time = np.arange(0.0, 30.0, 0.01)
    assert sweep.length == 60.0
    assert sweep(time + 30.0) == pytest.approx(sweep(time), abs=1e-9)


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ((0.6, 0.008, 900.0, 20.0), "the first frequency is the lower one"),
        ((0.0, 0.6, 900.0, 20.0), "all four are finite and above 0"),
        ((0.008, 0.6, 900.0, 0.0), "all four are finite and above 0"),
        ((0.008, float("nan"), 900.0, 1.0), "all four are finite and above 0"),
        ((0.008, 0.6, 100.0, 20.0), "0.008 Hz needs 250 s or more"),
        ((0.008, 0.6, 900.0, 20.0, 0), "repeats = 0"),
    ],
)
def test_numbers_that_make_no_sweep(numbers, text):
    with pytest.raises(ConfigError, match=text):
        Sweep(*numbers)


def test_sweep_against_step_band_and_range():
    SWEEP.check_step(0.2)
    with pytest.raises(ConfigError, match=r"goes up to 0\.5 Hz"):
        SWEEP.check_step(0.25)
    SWEEP.check_band((0.008, 0.6))
    for band in ((0.004, 0.3), (0.05, 0.7), (0.3, 0.05), (0.1, 0.1), (float("nan"), 0.3)):
        with pytest.raises(ConfigError, match="must rise, and lie in the sweep"):
            SWEEP.check_band(band)
    SWEEP.check_range(28.0, 0.0, 100.0, "throttle", "%")
    with pytest.raises(ConfigError, match=r"saturates throttle: 85 % .* 65 to 105, .* 0..100 %"):
        SWEEP.check_range(85.0, 0.0, 100.0, "throttle", "%")
    with pytest.raises(ConfigError, match=r"declared for 10.. %"):
        SWEEP.check_range(28.0, 10.0, None, "throttle", "%")
    for center in (1e12, -1e12, 1e151, 1e308):
        with pytest.raises(ConfigError, match=r"amplitude of 20 around -?1e\+\d+ %: it is 1e-09 or more"):
            SWEEP.check_range(center, None, None, "throttle", "%")


def test_a_sweep_begins_at_the_working_point_with_a_rising_flank():
    time = np.array([0.0, 1e-3, 1.0])
    start, next_to_it, later = SWEEP(time)
    assert start == 0.0 < next_to_it < later


def test_as_long_in_each_octave():
    sweep = Sweep(0.01, 0.64, 600.0, 1.0)  # six octaves
    assert sweep.frequency(100.0 * np.arange(6)) == pytest.approx(0.01 * 2.0 ** np.arange(6))


def test_a_specification_says_all_of_a_sweep():
    spec = IdentificationSpec(
        input="u",
        output="y",
        sweep=(0.01, 1.0),
        duration=300.0,
        amplitude=2.0,
        repeats=3,
        band=(0.1, 0.3),
    )
    assert sweep_of(spec) == Sweep(0.01, 1.0, 300.0, 2.0, repeats=3)
    with pytest.raises(ConfigError, match="lie in the sweep"):
        sweep_of(spec.model_copy(update={"band": (0.1, 2.0)}))
    with pytest.raises(ConfigError, match=f"needs {PERIODS / 0.01:g} s or more"):
        sweep_of(spec.model_copy(update={"duration": 100.0}))
