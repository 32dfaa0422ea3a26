"""Lane keeping limits: what outputs let one observe, and what a steering asks of the tires.

Source: a paper on optimal lane keeping control of a 4WS electric vehicle (title and authors are not known),
section 4, whose outputs are y' and theta.

    [C; C A; C A^2; C A^3]                                 observability matrix of y = C x       (L1)
    F_f = 2 C_f (delta_f - (y' + l_1 w_z)/v_x)             side force of the front axle [N]      (L2)
    F_r = 2 C_r (delta_r - (y' - l_2 w_z)/v_x)             of the rear axle [N]                  (L3)
    a_y = (F_f + F_r)/m                                    lateral acceleration [m/s2]           (L4)
    N_f = m g l_2/(l_1 + l_2),  N_r = m g l_1/(l_1 + l_2)  loads of the axles [N]                (L5)

A side force needs a friction of at least F/N; the linear model of `bicycle` has no such limit. Every function
is of a `Bicycle`, which the parameters of `LaneKeepingController` and `LateralVehicle` are.

published: nothing that `bicycle` does not have.
chosen: g = 9.81 m/s2; loads at rest, without transfer.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .bicycle import Bicycle
from .constants import GRAVITY

Array = NDArray[np.float64]

_ZERO = 1e-9  # a singular value below this part of the largest counts as 0


def observability_matrix(p: Bicycle, outputs: ArrayLike) -> Array:
    """Return [C; C A; C A^2; C A^3], shape (4 m, 4), for outputs C of shape (m, 4)."""
    a, c = np.array(p.a), np.array(outputs, dtype=float)
    return np.vstack([c @ np.linalg.matrix_power(a, k) for k in range(len(a))])  # (L1)


def observability_rank(p: Bicycle, outputs: ArrayLike) -> int:
    """Return the rank of (L1) for outputs C, shape (m, 4): 4 where they let one find every state."""
    return 4 - len(unobservable(p, outputs))


def unobservable(p: Bicycle, outputs: ArrayLike) -> Array:
    """Return a basis of the states that leave the outputs C, shape (m, 4), at 0: shape (4 - rank, 4)."""
    _, sizes, directions = np.linalg.svd(observability_matrix(p, outputs), full_matrices=True)
    return np.asarray(directions[np.count_nonzero(sizes > _ZERO * sizes[0]) :])


def side_forces(p: Bicycle, states: ArrayLike, angles: ArrayLike) -> Array:
    """Return the side forces [N] of front and rear axle, shape (n, 2).

    `states` (n, 4) are x of `bicycle`, `angles` (n, 2) its u; all tires are sound.
    """
    y, _, w, _ = np.asarray(states, dtype=float).T
    d_f, d_r = np.asarray(angles, dtype=float).T
    front = 2.0 * p.front_cornering_stiffness * (d_f - (y + p.front_axle_distance * w) / p.speed)  # (L2)
    rear = 2.0 * p.rear_cornering_stiffness * (d_r - (y - p.rear_axle_distance * w) / p.speed)  # (L3)
    return np.column_stack([front, rear])


def lateral_acceleration(p: Bicycle, forces: Array) -> Array:
    """Return the lateral acceleration [m/s2], shape (n,), of side forces [N], shape (n, 2)."""
    return np.asarray(forces.sum(axis=1) / p.mass)  # (L4)


def axle_loads(p: Bicycle) -> Array:
    """Return the loads [N] of front and rear axle at rest, shape (2,)."""
    distances = np.array([p.rear_axle_distance, p.front_axle_distance])
    return np.asarray(p.mass * GRAVITY * distances / distances.sum())  # (L5)


def needed_friction(p: Bicycle, forces: Array) -> Array:
    """Return the friction coefficients that side forces [N] need, both of shape (n, 2)."""
    return np.abs(forces) / axle_loads(p)
