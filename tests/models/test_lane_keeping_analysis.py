"""What the paper prints about lane keeping, from the models; tolerances are half a unit of its last digit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from evcosim.models import lane_keeping_analysis as analysis
from evcosim.models.lane_keeping_analysis import PUBLISHED, Parameters

P = Parameters()


@pytest.mark.parametrize("name", ["a", "b", "gain", "prefilter"])
def test_matrices_are_the_printed_ones(name: str) -> None:
    computed, printed = np.array(getattr(P, name)), np.array(getattr(PUBLISHED, name))
    assert np.abs(computed - printed).max() <= 5e-5


def test_the_printed_mass_does_not_give_the_printed_matrices() -> None:
    light = dataclasses.replace(P, mass=1280.0)
    assert abs(light.a[0][0] - PUBLISHED.a[0][0]) > 0.3
    assert abs(light.b[0][0] - PUBLISHED.b[0][0]) > 3.0


def test_poles_are_the_printed_ones() -> None:
    assert np.abs(analysis.closed_loop_poles(P) - PUBLISHED.poles).max() <= 1e-4


def test_the_steering_controls_every_state() -> None:
    assert analysis.controllability_rank(P) == PUBLISHED.controllability_rank == 4
    assert analysis.controllability_rank(dataclasses.replace(P, rear_cornering_stiffness=0.0)) < 4


def test_the_controllability_matrix_is_that_of_the_printed_matrices() -> None:
    """In 1e4, to what four digits of A and B allow: 5e-5 in A^3 B alone is 1.3 units of the fifth digit."""
    a, b = np.array(PUBLISHED.a), np.array(PUBLISHED.b)
    printed = np.hstack([b, a @ b, a @ a @ b, a @ a @ a @ b])
    difference = np.abs(analysis.controllability_matrix(P) - printed) / 1e4
    assert difference[:, :6].max() <= 5e-5
    assert difference.max() <= 6e-5


def test_the_other_printed_gain_is_no_gain_of_this_vehicle() -> None:
    """No row of K has the entries of K-hat, in whatever order and with whatever signs: not reproducible."""
    rows, k_hat = np.sort(np.abs(P.gain), axis=1), np.sort(np.abs(PUBLISHED.k_hat))
    assert np.abs(rows - k_hat).max(axis=1).min() > 1.0


def test_the_continuous_loop_overshoots_and_settles() -> None:
    times, states = analysis.step_response(P, 0.3, 4.0)
    beta = states[:, 3]
    assert 100.0 * analysis.overshoot(beta, 0.3) == pytest.approx(3.8, abs=0.1)
    assert analysis.settling_time(times, beta, 0.3) == pytest.approx(1.33, abs=0.02)
    assert beta[-1] == pytest.approx(0.3, abs=1e-4)


def test_the_response_does_not_depend_on_how_densely_it_is_looked_at() -> None:
    _, coarse = analysis.step_response(P, 0.3, 2.0, dt=0.1)
    _, dense = analysis.step_response(P, 0.3, 2.0, dt=0.01)
    assert dense[::10] == pytest.approx(coarse, abs=1e-12)


@pytest.mark.parametrize(("delay", "radius"), [(0, 0.9681), (1, 0.9679), (2, 1.0225), (3, 1.0898)])
def test_two_steps_of_delay_are_one_too_many(delay: int, radius: float) -> None:
    assert analysis.spectral_radius(P, delay) == pytest.approx(radius, abs=5e-5)


@pytest.mark.parametrize("delay", [0, 1, 2, 3])
def test_the_sampled_loop_is_the_loop_step_by_step(delay: int) -> None:
    """A loop over the closed-form vehicle with a queue of requests, against powers of the matrix."""
    ab, k = np.array(P.transition(0.01)), np.array(P.gain)
    x, queue = np.array([0.1, 0.02, -0.3, 0.4]), [np.zeros(2)] * delay
    z = np.concatenate([x, np.zeros(2 * delay)])
    loop = analysis.sampled_loop(P, delay)
    for _ in range(25):
        queue.append(-k @ x)
        x = ab @ np.concatenate([x, queue.pop(0)])
        z = loop @ z
        assert z[:4] == pytest.approx(x, abs=1e-9)


def test_fast_sampling_has_the_poles_of_the_continuous_loop() -> None:
    slowest = analysis.closed_loop_poles(P).real.max()
    assert np.log(analysis.spectral_radius(P, 0, dt=1e-4)) / 1e-4 == pytest.approx(slowest, rel=1e-3)


def test_overshoot_and_settling_by_hand() -> None:
    times = np.arange(5.0)
    values = np.array([0.0, 1.5, 0.5, 1.01, 1.0])
    assert analysis.overshoot(values, 1.0) == pytest.approx(0.5)
    assert analysis.overshoot(-values, -1.0) == pytest.approx(0.5)
    assert analysis.overshoot(np.array([0.0, 0.9]), 1.0) == 0.0
    assert analysis.settling_time(times, values, 1.0) == 3.0
    assert analysis.settling_time(times, np.ones(5), 1.0) == 0.0
    assert analysis.settling_time(times, np.zeros(5), 1.0) == np.inf
