"""What the paper prints about lane keeping, from the models; tolerances are half a unit of its last digit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from evcosim.master.reproduce import printed
from evcosim.models import lane_keeping_analysis as analysis
from evcosim.models.bicycle import discretized
from evcosim.models.lane_keeping_analysis import Parameters

P = Parameters()
A, B, K, S, Q_R, K_HAT = (
    np.array(printed.row("lane_keeping", by).value, dtype=float)
    for by in ("A", "B", "K", "S", "Q_r", "K-hat")
)


@pytest.mark.parametrize(
    ("computed", "printed_one"), [(P.a, A), (P.b, B), (P.gain, K), (P.prefilter, S)], ids="ABKS"
)
def test_matrices_are_the_printed_ones(computed, printed_one) -> None:
    assert np.abs(np.array(computed) - printed_one).max() <= 5e-5


def test_the_printed_mass_does_not_give_the_printed_matrices() -> None:
    light = dataclasses.replace(P, mass=1280.0)
    assert abs(light.a[0][0] - A[0, 0]) > 0.3
    assert abs(light.b[0][0] - B[0, 0]) > 3.0


def test_poles_are_the_printed_ones() -> None:
    expected = [
        complex(re, sign * im) for re, im in ((-55.9664, 6.7568), (-3.2296, 3.1087)) for sign in (-1, 1)
    ]
    assert np.abs(analysis.closed_loop_poles(P) - expected).max() <= 1e-4


def test_the_steering_controls_every_state() -> None:
    assert analysis.controllability_rank(P) == 4
    assert analysis.controllability_rank(dataclasses.replace(P, rear_cornering_stiffness=0.0)) < 4


def test_the_controllability_matrix_is_the_printed_one() -> None:
    """In 1e4; that of the rounded A and B is farther away, in its last two columns."""
    assert np.abs(analysis.controllability_matrix(P) / 1e4 - Q_R).max() <= 5e-5
    rounded = np.hstack([np.linalg.matrix_power(A, k) @ B for k in range(4)])
    assert np.abs(rounded / 1e4 - Q_R)[:, :6].max() <= 5e-5 < np.abs(rounded / 1e4 - Q_R).max()


def test_the_other_printed_gain_is_no_gain_of_this_vehicle() -> None:
    """No row of K has the entries of K-hat, in whatever order and with whatever signs: not reproducible."""
    rows, k_hat = np.sort(np.abs(P.gain), axis=1), np.sort(np.abs(K_HAT))
    assert np.abs(rows - k_hat).max(axis=1).min() > 1.0


def test_the_riccati_matrix_belongs_to_the_gain() -> None:
    x = analysis.riccati_matrix(P)
    assert np.array(P.b).T @ x == pytest.approx(np.array(P.gain), abs=1e-9)
    assert analysis.smallest_eigenvalue(P) == pytest.approx(np.linalg.eigvalsh(x).min()) != 0.0
    assert analysis.smallest_eigenvalue(P) > 0.0
    assert analysis.riccati_residual(P) < 1e-9


def test_no_other_gain_costs_less_than_the_least() -> None:
    """Half of the displacement's weight in the design is another gain, judged by the same cost."""
    least = analysis.least_cost(P, 0.3)
    assert analysis.cost_of_step(P, 0.3) == pytest.approx(least, abs=1e-6)
    assert least == pytest.approx(0.01473, abs=5e-6)
    assert analysis.least_cost(P, 0.6) == pytest.approx(4.0 * least)


def test_the_prefilter_reaches_its_outputs_and_no_prefilter_reaches_the_others() -> None:
    tracked = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 1.0]])
    reached = tracked @ analysis.final_states(P, np.array(P.b) @ np.array(P.prefilter))
    assert reached == pytest.approx(np.eye(2), abs=1e-9)
    assert analysis.smallest_singular_value(P, ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))) < 1e-12


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
    ab, k = np.array(discretized(P.a, P.b, 0.01))[:, :6], np.array(P.gain)
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
