"""Bicycle: the linear single-track model of a four-wheel-steered vehicle at a constant speed.

Source: a paper on optimal lane keeping control of a 4WS electric vehicle (title and authors are not known),
section 4 (2-DOF bicycle model). State x = (y' [m/s], theta [rad], w_z [rad/s], beta [m]), input u =
(delta_f, delta_r) [rad]:

    x' = A x + B u                                                                               (B1)
    y''    = a11 y' + a13 w_z + b11 delta_f + b12 delta_r       lateral velocity y'
    theta' = w_z                                                heading angle theta, yaw rate w_z
    w_z'   = a31 y' + a33 w_z + b31 delta_f + b32 delta_r
    beta'  = -y' - v_x theta                                    displacement beta
    a11 = -(2 C_f + 2 C_r)/(m v_x)               a13 = -v_x - (2 C_f l_1 - 2 C_r l_2)/(m v_x)    (B2)
    a31 = (-2 l_1 C_f + 2 l_2 C_r)/(J_z v_x)     a33 = -(2 l_1^2 C_f + 2 l_2^2 C_r)/(J_z v_x)    (B3)
    b11 = 2 C_f/m,  b12 = 2 C_r/m,  b31 = 2 l_1 C_f/J_z,  b32 = -2 l_2 C_r/J_z                   (B4)
    (A_d, B_d) = first rows of exp([[A, B], [0, 0]] dt)          over a step of dt                (B5)

One wheel stands for the two of an axle. C_f and C_r are the cornering stiffness of one tire, so an axle has
twice as much. The paper's axes are SAE (y right, z down); the equations are the same in ISO 8855 (y left, z
up), which the bus uses. beta counts against y: it is positive to the right in ISO and to the left in SAE.

Deviations: misprints of the paper are corrected. Its (12) has a13 without the leading minus of its (7), and
a33 with the formula of a31. Its list of data has a mass of 1280 kg, its listing one of 1380 kg, which gives
its A and B and is the default here.

published: C_f = C_r = 30000 N/rad, m = 1380 kg, J_z = 2200 kg.m2, l_1 = 1.25 m, l_2 = 1.27 m, v_x = 21.3 m/s.
chosen: nothing.

At the edges: v_x is at least 0.1 m/s, because (B2) and (B3) divide by it.

Step: `discretized` gives A_d and B_d of x(t + dt) = A_d x + B_d u, exact for steering angles held over dt.
"""

from __future__ import annotations

from functools import cached_property
from math import sqrt

from .base import record, var
from .linear_algebra import exponential

Rows = tuple[tuple[float, ...], ...]
"""Rows of a matrix."""
STATES = 4
AUGMENTED = 2 * STATES  # of (B5)


@record
class Bicycle:
    """The vehicle's numbers, common to the plant and to the model that a controller has of it."""

    mass: float = var(1380.0, "kg", "Mass of the vehicle (m)", min=1.0)
    yaw_inertia: float = var(2200.0, "kg.m2", "Moment of inertia about the vertical axis (J_z)", min=1.0)
    front_cornering_stiffness: float = var(30e3, "N/rad", "Of one front tire (C_f)", min=0.0)
    rear_cornering_stiffness: float = var(30e3, "N/rad", "Of one rear tire (C_r)", min=0.0)
    front_axle_distance: float = var(1.25, "m", "Center of gravity to front axle (l_1)", min=0.0)
    rear_axle_distance: float = var(1.27, "m", "Center of gravity to rear axle (l_2)", min=0.0)
    speed: float = var(21.3, "m/s", "Longitudinal speed (v_x)", min=0.1)

    @cached_property
    def a(self) -> Rows:
        """A of (B1), 4 x 4."""
        return state_matrix(self, self.front_cornering_stiffness)

    @cached_property
    def b(self) -> Rows:
        """B of (B1), 4 x 2."""
        return input_matrix(self, self.front_cornering_stiffness)


def state_matrix(p: Bicycle, front: float) -> Rows:
    """Return A of (B1), 4 x 4, for a cornering stiffness C_f of `front` [N/rad]."""
    m, jz, vx = p.mass, p.yaw_inertia, p.speed
    cf, cr = 2.0 * front, 2.0 * p.rear_cornering_stiffness
    l1, l2 = p.front_axle_distance, p.rear_axle_distance
    a11, a13 = -(cf + cr) / (m * vx), -vx - (cf * l1 - cr * l2) / (m * vx)  # (B2)
    a31, a33 = (l2 * cr - l1 * cf) / (jz * vx), -(l1 * l1 * cf + l2 * l2 * cr) / (jz * vx)  # (B3)
    return (  # (B1)
        (a11, 0.0, a13, 0.0),
        (0.0, 0.0, 1.0, 0.0),
        (a31, 0.0, a33, 0.0),
        (-1.0, -vx, 0.0, 0.0),
    )


def input_matrix(p: Bicycle, front: float) -> Rows:
    """Return B of (B1), 4 x 2, for a cornering stiffness C_f of `front` [N/rad]."""
    cf, cr = 2.0 * front, 2.0 * p.rear_cornering_stiffness
    b31, b32 = p.front_axle_distance * cf / p.yaw_inertia, -p.rear_axle_distance * cr / p.yaw_inertia
    return ((cf / p.mass, cr / p.mass), (0.0, 0.0), (b31, b32), (0.0, 0.0))  # (B4)


def eigenvalues(p: Bicycle) -> tuple[complex, complex]:
    """Return the eigenvalues of A [1/s] that are not 0 for every vehicle: those of y' and w_z."""
    a11, a13, a31, a33 = p.a[0][0], p.a[0][2], p.a[2][0], p.a[2][2]
    mean, half = 0.5 * (a11 + a33), 0.5 * (a11 - a33)
    square = half * half + a13 * a31
    if square < 0.0:
        return complex(mean, sqrt(-square)), complex(mean, -sqrt(-square))
    larger = mean - sqrt(square) if mean < 0.0 else mean + sqrt(square)
    if larger == 0.0:
        return complex(0.0, 0.0), complex(0.0, 0.0)
    return complex(larger, 0.0), complex((a11 * a33 - a13 * a31) / larger, 0.0)


def discretized(a: Rows, b: Rows, dt: float) -> Rows:
    """Return the rows of (A_d, B_d), 4 x 8, for A of 4 x 4 and B of 4 x m, m <= 4; more columns are 0.

    x(t + dt) = A_d x + B_d u is exact for inputs held over dt [s].
    """
    augmented = [0.0] * (AUGMENTED * AUGMENTED)
    for i in range(STATES):
        for j in range(STATES):
            augmented[AUGMENTED * i + j] = a[i][j] * dt
        for j in range(len(b[0])):
            augmented[AUGMENTED * i + STATES + j] = b[i][j] * dt
    moved = exponential(augmented, AUGMENTED)  # (B5)
    return _row(moved, 0), _row(moved, 8), _row(moved, 16), _row(moved, 24)


def _row(m: list[float], k: int) -> tuple[float, ...]:
    """Return the row of 8 columns that begins at k."""
    return m[k], m[k + 1], m[k + 2], m[k + 3], m[k + 4], m[k + 5], m[k + 6], m[k + 7]
