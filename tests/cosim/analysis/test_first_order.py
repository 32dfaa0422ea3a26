"""First-order fits: the exact model is found exactly, intervals hold the truth, bad data are refused."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.analysis.first_order import (
    Estimate,
    FirstOrder,
    curvature,
    fit_first_order,
    flat_share,
    predict,
)
from evcosim.cosim.analysis.frequency_response import FrequencyResponse, frequency_response, midpoints
from evcosim.cosim.errors import ConfigError
from support.swept import BAND, GAINS, POLES, RATE, SWEEP, exact, swept

# ---- the fit


@given(GAINS, POLES)
@settings(max_examples=50)
def test_exact_response_gives_the_exact_model(gain, pole):
    fit = fit_first_order(exact(FirstOrder(gain, pole), np.linspace(0.01, 0.4, 80)), BAND)
    assert (fit.gain.value, fit.pole.value) == pytest.approx((gain, pole), rel=1e-6)
    assert fit.residual < 1e-6
    assert fit.separable == (BAND[0] < fit.pole.value < BAND[1])
    assert bool(fit.warnings) == (not fit.separable)


@pytest.mark.parametrize("pole", [0.0206, 0.03, 0.0411, 0.1])
@pytest.mark.parametrize("gain", [0.46, -7.0])
def test_noiseless_sweep_gives_the_model_within_two_percent(gain, pole):
    u, y = swept(FirstOrder(gain, pole))
    fit = fit_first_order(frequency_response(u, y, RATE), BAND)
    assert (fit.gain.value, fit.pole.value) == pytest.approx((gain, pole), rel=0.02)
    assert fit.product.value == pytest.approx(gain * pole, rel=0.01)
    assert fit.separable


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Of 40 sweeps with white noise at the output, 95 % intervals may miss a few."""
    model, held = FirstOrder(0.46, 0.03), {"gain": 0, "pole": 0, "product": 0}
    u, y = swept(model)
    random = np.random.default_rng(1)
    for _ in range(40):
        fit = fit_first_order(frequency_response(u, y + random.normal(scale=0.5, size=len(y)), RATE), BAND)
        truth = {"gain": model.gain, "pole": model.pole, "product": model.gain * model.pole}
        for name, value in truth.items():
            held[name] += getattr(fit, name).low <= value <= getattr(fit, name).high
    assert min(held.values()) >= 34, held


def test_above_the_pole_only_the_product_is_known():
    model = FirstOrder(0.46, 0.03)
    u, y = swept(model)
    noisy = y + np.random.default_rng(2).normal(scale=0.3, size=len(y))
    fit = fit_first_order(frequency_response(u, noisy, RATE), (0.05, 0.3))
    assert not fit.separable
    assert "cannot separate gain from pole: only gain x pole is well conditioned" in fit.warnings[0]
    assert fit.correlation < -0.9
    assert fit.product.relative < 0.5 * min(fit.gain.relative, fit.pole.relative)
    assert fit_first_order(frequency_response(u, noisy, RATE), BAND).separable


def test_below_the_pole_the_pole_is_extrapolated():
    fit = fit_first_order(exact(FirstOrder(2.0, 1.0), np.linspace(0.01, 0.4, 80)), BAND)
    assert "the pole is extrapolated" in fit.warnings[0]


def test_other_dynamics_and_noise_are_warned_of():
    f = np.linspace(0.012, 0.3, 60)
    resonance = 1.0 / (1.0 - (f / 0.1) ** 2 + 0.1j * f / 0.1)
    fit = fit_first_order(FrequencyResponse(f, resonance, np.full(60, 0.5)), BAND)
    assert any("not first-order in this band" in w for w in fit.warnings)
    assert any("coherence in the band is 0.50" in w for w in fit.warnings)


@pytest.mark.parametrize(
    "response", [FirstOrder(1.0, 1e-9).response(np.linspace(0.012, 0.3, 60)), np.full(60, 3.0 + 0.0j)]
)
def test_integrator_and_pure_gain_end_far_outside_the_band(response):
    f = np.linspace(0.012, 0.3, 60)
    fit = fit_first_order(FrequencyResponse(f, response, np.ones(60)), BAND)
    assert not fit.separable
    assert np.isfinite([fit.gain.low, fit.gain.high, fit.pole.low, fit.pole.high]).all()


def test_too_few_points_and_no_response():
    data = exact(FirstOrder(1.0, 0.03), np.linspace(0.01, 0.4, 10))
    with pytest.raises(ConfigError, match=r"holds 1 points .* three are needed"):
        fit_first_order(data, (0.05, 0.06))
    with pytest.raises(ConfigError, match="zero or not finite"):
        fit_first_order(FrequencyResponse(data.frequency, 0.0 * data.response, data.coherence), BAND)


@pytest.mark.parametrize("coherence", [0.29, float("nan"), 0.0])
def test_a_fit_without_coherence_is_refused(coherence):
    model = FirstOrder(0.46, 0.03)
    f = np.linspace(0.012, 0.3, 60)
    fit = fit_first_order(FrequencyResponse(f, model.response(f), np.full(60, 0.9)), BAND)
    assert fit.refusal == ""
    assert "coherence in the band" in dataclasses.replace(fit, coherence=coherence).refusal


def test_a_fit_whose_interval_says_nothing_is_refused_and_shown_in_few_digits():
    f, random = np.linspace(0.05, 0.3, 6), np.random.default_rng(3)
    scattered = np.exp(random.normal(scale=2.0, size=6) + 1j * random.uniform(-3.0, 3.0, size=6))
    fit = fit_first_order(FrequencyResponse(f, scattered, np.full(6, 0.9)), (0.05, 0.3))
    assert "spans more than a factor of 10" in fit.refusal
    assert all(len(warning) < 400 for warning in fit.warnings)
    exact = fit_first_order(FrequencyResponse(f, FirstOrder(-2.0, 0.1).response(f), np.ones(6)), (0.05, 0.3))
    assert exact.refusal == ""


@pytest.mark.parametrize(
    ("low", "value", "high", "spread"),
    [(1.0, 2.0, 4.0, 4.0), (-4.0, -2.0, -1.0, 4.0), (-1.0, 1.0, 3.0, math.inf), (0.0, 1.0, 2.0, math.inf)],
)
def test_the_spread_of_an_interval(low, value, high, spread):
    assert Estimate(value, low, high).spread == spread


# ---- saturation


def test_a_limit_shows_as_a_flat_or_bent_output():
    model = FirstOrder(0.46, 0.03)
    u, y = swept(model)
    frequency = SWEEP.frequency((np.arange(len(u)) + 0.5) / RATE)
    x = midpoints(model.simulated(u, 1.0 / RATE))
    cut = np.minimum(y, 5.0)
    assert flat_share(y, frequency, RATE) < 0.12 < flat_share(cut, frequency, RATE)
    assert curvature(x, y) < 0.01 < 0.1 < curvature(x, cut)
    assert curvature(x, 100.0 * y) == pytest.approx(curvature(x, y))


# ---- prediction


@given(GAINS, st.floats(0.02, 0.2), st.floats(-50.0, 50.0))
@settings(max_examples=20)
def test_simulated_model_reaches_its_gain(gain, pole, u):
    model = FirstOrder(gain, pole)
    x = model.simulated(np.full(2000, u), 0.1)
    assert x[0] == 0.0
    assert x[-1] == pytest.approx(gain * u, rel=1e-6, abs=1e-12)
    after_t = model.simulated(np.full(1, u), model.time_constant)[1]
    assert after_t == pytest.approx((1.0 - np.exp(-1.0)) * gain * u, rel=1e-9, abs=1e-12)


def test_prediction_of_the_model_itself_has_no_error():
    model, time = FirstOrder(0.46, 0.03), np.arange(1000) * 0.1
    u = 28.0 + 20.0 * np.sign(np.sin(2.0 * np.pi * time / 40.0))
    y = 30.0 + model.simulated(u - 28.0, 0.1)[:-1]
    found = predict(model, time, u, y, (28.0, 30.0))
    assert found.mean_esr < 1e-6
    assert 0.2 < np.isfinite(found.esr).mean() < 0.7  # in accelerations alone
    worse = predict(FirstOrder(0.46, 0.04), time, u, y, (28.0, 30.0))
    assert worse.mean_esr > 0.5


def test_no_error_is_given_for_an_output_that_passes_zero():
    model, time = FirstOrder(1.0, 0.03), np.arange(500) * 0.1
    u = np.sign(np.sin(2.0 * np.pi * time / 25.0))
    found = predict(model, time, u, model.simulated(u, 0.1)[:-1], (0.0, 0.0))
    assert np.isnan(found.mean_esr)
