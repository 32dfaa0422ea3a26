"""Lane keeping analysis: poles, controllability, delay and step response, as printed and from the models.

Source: "Optimal lane keeping control of a 4WS electric vehicle", sections 4 and 5. A, B are those of
`bicycle`, K, S those of `lane_keeping_controller`.

    det(s I - (A - B K)) = 0                               poles s of the closed loop [1/s]      (L1)
    [B, A B, A^2 B, A^3 B]                                 controllability matrix                (L2)
    z[k+1] = M z[k],   z = (x, u[k-n], ..., u[k-1])        loop sampled with n samples of delay  (L3)
    x' = (A - B K) x + B S (0, r_2)                        continuous loop [r_2 in m]            (L4)

Every function is of the parameters of `LaneKeepingController`, so it answers for other vehicles, speeds and
weights too.

published: `PUBLISHED`, the numbers that the paper prints, to the digits it prints.
chosen: a sampling of 100 Hz.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .bicycle import Matrix, discretized
from .lane_keeping_controller import LaneKeepingController

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Parameters = LaneKeepingController.Parameters

STEP_SIZE = 0.01  # s: 100 Hz, chosen


class Published(NamedTuple):
    """The paper's numbers; `k_hat` is the one that is not reproducible: it contradicts `gain`."""

    a: Matrix
    b: Matrix
    gain: Matrix
    prefilter: Matrix
    poles: tuple[complex, ...]
    controllability_rank: int
    k_hat: tuple[float, ...]


PUBLISHED = Published(
    a=(
        (-4.0825, 0.0, -21.2592, 0.0),
        (0.0, 0.0, 1.0, 0.0),
        (0.0256, 0.0, -4.0658, 0.0),
        (-1.0, -21.3, 0.0, 0.0),
    ),
    b=((43.4783, 43.4783), (0.0, 0.0), (34.0909, -34.6364), (0.0, 0.0)),
    gain=((0.5862, 6.2017, 0.6624, -0.9401), (0.7389, -3.3525, -0.8676, 0.3409)),
    prefilter=((0.2979, -0.9401), (0.9592, 0.3409)),
    poles=(-55.9664 - 6.7568j, -55.9664 + 6.7568j, -3.2296 - 3.1087j, -3.2296 + 3.1087j),
    controllability_rank=4,
    k_hat=(0.1082, 0.1279, 1.1843, 0.7593),
)


def closed_loop_poles(p: Parameters) -> ComplexArray:
    """Return the poles [1/s], shape (4,), sorted by real and then imaginary part."""
    return np.sort_complex(np.linalg.eigvals(np.array(p.a) - np.array(p.b) @ np.array(p.gain)))  # (L1)


def controllability_matrix(p: Parameters) -> Array:
    """Return [B, A B, A^2 B, A^3 B], shape (4, 8)."""
    a, b = np.array(p.a), np.array(p.b)
    return np.hstack([np.linalg.matrix_power(a, k) @ b for k in range(len(a))])  # (L2)


def controllability_rank(p: Parameters) -> int:
    """Return the rank of the controllability matrix: 4 where the steering moves every state."""
    return int(np.linalg.matrix_rank(controllability_matrix(p)))


def sampled_loop(p: Parameters, delay_steps: int = 0, dt: float = STEP_SIZE) -> Array:
    """Return M of (L3), shape (4 + 2 n, 4 + 2 n), for a controller that samples each `dt` [s].

    Its request is late by n = `delay_steps` samples. z is x and, from the oldest to the newest, the requests
    on their way.
    """
    ab, k = np.array(discretized(p.a, p.b, dt)), np.array(p.gain)
    a_d, b_d = ab[:, :4], ab[:, 4:]
    if delay_steps == 0:
        return np.asarray(a_d - b_d @ k)  # (L3)
    loop = np.zeros((4 + 2 * delay_steps, 4 + 2 * delay_steps))
    loop[:4, :6] = ab
    loop[4:-2, 6:] = np.eye(2 * (delay_steps - 1))
    loop[-2:, :4] = -k
    return loop


def spectral_radius(p: Parameters, delay_steps: int = 0, dt: float = STEP_SIZE) -> float:
    """Return the largest modulus of the sampled loop's eigenvalues: below 1 the loop is stable."""
    return float(np.abs(np.linalg.eigvals(sampled_loop(p, delay_steps, dt))).max())


def step_response(p: Parameters, step: float, stop_time: float, dt: float = 1e-3) -> tuple[Array, Array]:
    """Return times [s] and states, shapes (n,) and (n, 4), of (L4) from rest with r_2 = `step` [m].

    The points are `dt` [s] apart and exact.
    """
    a, b = np.array(p.a), np.array(p.b)
    closed, drive = a - b @ np.array(p.gain), b @ np.array(p.prefilter) @ np.array([[0.0], [step]])  # (L4)
    move = np.array(discretized(_rows(closed), _rows(drive), dt))
    states = np.zeros((round(stop_time / dt) + 1, 4))
    for k in range(1, len(states)):
        states[k] = move[:, :4] @ states[k - 1] + move[:, 4]
    times: Array = dt * np.arange(len(states), dtype=np.float64)
    return times, states


def overshoot(values: Array, target: float) -> float:
    """Return the part of the target (from 0) by which the values, shape (n,), exceed it; 0 if they do not."""
    return max(0.0, float((values / target).max()) - 1.0)


def settling_time(times: Array, values: Array, target: float, band: float = 0.02) -> float:
    """Return the time [s] from which on values are within `band` of the target; infinite if the last is not.

    `band` is a part of the target; times and values have the shape (n,).
    """
    outside = np.flatnonzero(np.abs(values - target) > band * abs(target))
    if not len(outside):
        return float(times[0])
    return float(times[outside[-1] + 1]) if outside[-1] + 1 < len(times) else float("inf")


def _rows(matrix: Array) -> Matrix:
    return tuple(tuple(row) for row in matrix.tolist())
