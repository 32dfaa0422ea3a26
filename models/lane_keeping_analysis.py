"""Lane keeping analysis: poles, controllability, cost, delay and step response of the lane keeping loop.

Source: a paper on optimal lane keeping control of a 4WS electric vehicle (title and authors are not known),
sections 4 and 5. A, B are those of `bicycle`, K, S those of `lane_keeping_controller`.

    det(s I - (A - B K)) = 0                               poles s of the closed loop [1/s]      (L1)
    [B, A B, A^2 B, A^3 B]                                 controllability matrix                (L2)
    z[k+1] = M z[k],   z = (x, u[k-n], ..., u[k-1])        loop sampled with n samples of delay  (L3)
    x' = (A - B K) x + B S (0, r_2)                        continuous loop [r_2 in m]            (L4)
    A' P + P A - P B K + Q = 0,  P = P'                    algebraic Riccati equation            (L5)
    J = 1/2 integral of (x' Q x + u' R u) dt = 1/2 x_0' P x_0          cost from x_0 to rest     (L6)

Every function is of the parameters of `LaneKeepingController`, so it answers for other vehicles, speeds and
weights too.

published: nothing that the two models do not have.
chosen: a sampling of 100 Hz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .bicycle import Rows, discretized
from .lane_keeping_controller import LaneKeepingController

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Parameters = LaneKeepingController.Parameters

STEP_SIZE = 0.01  # s: 100 Hz, chosen


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
    ab, k = np.array(discretized(p.a, p.b, dt))[:, :6], np.array(p.gain)
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


def riccati_matrix(p: Parameters) -> Array:
    """Return P, shape (4, 4), of (L5): the solution of the Lyapunov equation of the loop under K."""
    from scipy.linalg import solve_continuous_lyapunov

    k = np.array(p.gain)
    closed, (q, r) = np.array(p.a) - np.array(p.b) @ k, _weights(p)
    return np.asarray(solve_continuous_lyapunov(closed.T, -(q + k.T @ r @ k)))


def riccati_residual(p: Parameters) -> float:
    """Return the largest entry of the left side of (L5), over the largest weight of Q."""
    a, b, k, x = np.array(p.a), np.array(p.b), np.array(p.gain), riccati_matrix(p)
    q, _ = _weights(p)
    return float(np.abs(a.T @ x + x @ a - x @ b @ k + q).max() / np.abs(q).max())  # (L5)


def smallest_eigenvalue(p: Parameters) -> float:
    """Return that of P: above 0 where it is positive definite."""
    return float(np.linalg.eigvalsh(riccati_matrix(p))[0])


def least_cost(p: Parameters, step: float) -> float:
    """Return 1/2 x_0' P x_0 for a displacement of `step` [m] from the reference."""
    return 0.5 * step**2 * float(riccati_matrix(p)[3, 3])  # (L6)


def cost_of_step(p: Parameters, step: float, stop_time: float = 20.0) -> float:
    """Return the integral of (L6) over the response to a step [m]: of what is left to the end of it."""
    times, states = step_response(p, step, stop_time)
    left, (q, r) = states - [0.0, 0.0, 0.0, step], _weights(p)
    request = -left @ np.array(p.gain).T
    rate = np.einsum("ni,ij,nj->n", left, q, left) + np.einsum("ni,ij,nj->n", request, r, request)
    return 0.5 * float(np.trapezoid(rate, times))


def final_states(p: Parameters, drive: Array) -> Array:
    """Return where (A - B K) x + `drive` r = 0 for each input r = 1 of the drive (4 x n), shape (4, n)."""
    return np.asarray(-np.linalg.solve(np.array(p.a) - np.array(p.b) @ np.array(p.gain), drive))


def smallest_singular_value(p: Parameters, outputs: Rows) -> float:
    """Return that of C (A - B K)^-1 B for outputs C (m x 4): 0 where no prefilter reaches every reference."""
    return float(np.linalg.svd(np.array(outputs) @ final_states(p, np.array(p.b)), compute_uv=False)[-1])


def _weights(p: Parameters) -> tuple[Array, Array]:
    """Return Q, shape (4, 4), and R, shape (2, 2)."""
    states = (
        p.lateral_velocity_weight, p.heading_angle_weight, p.yaw_rate_weight, p.displacement_weight,
    )  # fmt: skip # one line is enough
    return np.diag(states), np.diag((p.front_steering_weight, p.rear_steering_weight))


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


def _rows(matrix: Array) -> Rows:
    return tuple(tuple(row) for row in matrix.tolist())
