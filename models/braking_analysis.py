"""Braking analysis: Psi, the critical gains and the two propositions for the braking two-wheeler.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008. Slips are states, without air drag:

    lambda_i' = r/(J v) (T_i - Psi_i(lambda_f, lambda_r)),   i = f, r                 slips [1]     (6)
    Psi_f = r F_xf - (J/r) (1 - lambda_f) v',   F_xf = (m/l) (g l_r - h v') mu_f      torque [N.m]  (7)
    Psi_r = r F_xr - (J/r) (1 - lambda_r) v',   F_xr = (m/l) (g l_f + h v') mu_r      torque [N.m]  (8)
    v' = -g (l_r mu_f + l_f mu_r)/(l - h (mu_f - mu_r))            (1)-(5) of `two_wheeler_braking`
    T_i = k_i (lambda_i* - lambda_i), not below 0                  proportional control             (9)

Psi_i is the torque that keeps wheel i at its slip. Measured by s, ds = r/(J v) dt, (6) knows no speed:
d lambda_i/ds = T_i - Psi_i. That is what is integrated here.

    Proposition 3.1   k_i > k-bar_i = max over slips and roads of -d Psi_i/d lambda_i, true speed:
                      one equilibrium, and every start ends there, for all lambda_i* in (0, 1).
    Proposition 3.2   k_i lambda* > max Psi_i, slip from v_hat = r max(w_f, w_r) instead: both wheels lock,
                      because the fastest wheel believes in no slip and so is braked with k_i lambda*.

Slips and torques are arrays of one shape where nothing else is stated.

Deviations: k-bar is the condition (14), (15) of the paper, whose secants are nowhere steeper than the
steepest tangent: T_i - Psi_i then falls along its own slip. It gives 324.5 and 135.2 N.m; the dry road sets
the first, cobble the second.

published: lambda* = 0.22 for both wheels in the maneuvers, any in (0, 1) in the propositions.
chosen: the vehicle of `two_wheeler_braking`, the tolerances below.

At the edges: slips lie in [0, 1]. With both wheels locked v_hat = 0, and the slip 0/0 counts as 0.

Step: Proposition 3.1 by LSODA with a relative tolerance of 1e-9; Proposition 3.2 by Euler's rule with a step
for each start, as short as the stiffness of (6) near the lock needs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .constants import GRAVITY
from .road_friction import FRICTION, Road
from .slip_controller import TARGET_SLIP as TARGET_SLIP
from .two_wheeler_braking import TwoWheelerBraking

Array = NDArray[np.float64]
Parameters = TwoWheelerBraking.Parameters
Torques = Callable[[Array, Array], tuple[Array, Array]]

END_TIME = 4.0  # s of the reduced form; the slowest gains of Proposition 3.1 need 1
RESTING_RATE = 1e-6  # N.m: rates of (6) below this are rest
LOCKED = 1.0 - 1e-6  # slip from which on a wheel counts as locked
MOST_STEPS = 20_000  # a lock takes below 2000 steps at 1.05 times the gain of Proposition 3.2


class Reduced(NamedTuple):
    """v' [m/s2], Psi_f and Psi_r [N.m] at some slips, and the slope of each Psi over its own slip [N.m]."""

    acceleration: Array
    psi_front: Array
    psi_rear: Array
    slope_front: Array
    slope_rear: Array


class Gains(NamedTuple):
    """A gain [N.m per unit slip] for each wheel."""

    front: float
    rear: float


class SetPoint(NamedTuple):
    """The slips lambda_f* and lambda_r* that the controller is to keep."""

    front: float
    rear: float


TARGET = SetPoint(TARGET_SLIP, TARGET_SLIP)


class Equilibrium(NamedTuple):
    """Slips at which both torques of (9) equal Psi."""

    front: float
    rear: float


def reduced(p: Parameters, front_slip: Array, rear_slip: Array) -> Reduced:
    """Return v', Psi_i and the derivatives d Psi_i/d lambda_i on the road of p, in the slips' shape."""
    mu_f, mu_r = _friction(p.road, front_slip), _friction(p.road, rear_slip)
    dmu_f, dmu_r = _slope(p.road, front_slip), _slope(p.road, rear_slip)
    g, h, lever = GRAVITY, p.center_height, p.wheel_inertia / p.wheel_radius
    force = p.wheel_radius * p.mass / p.wheelbase
    weight_f, weight_r = g * p.rear_distance, g * p.front_distance
    n, d = weight_f * mu_f + weight_r * mu_r, p.wheelbase - h * (mu_f - mu_r)
    a = -n / d  # v'
    a_f, a_r = -dmu_f * (weight_f * d + h * n) / d**2, -dmu_r * (weight_r * d - h * n) / d**2
    load_f, load_r = weight_f - h * a, weight_r + h * a
    roll_f, roll_r = 1.0 - front_slip, 1.0 - rear_slip
    return Reduced(
        a,
        force * load_f * mu_f - lever * roll_f * a,  # (7)
        force * load_r * mu_r - lever * roll_r * a,  # (8)
        force * (load_f * dmu_f - h * a_f * mu_f) + lever * (a - roll_f * a_f),
        force * (load_r * dmu_r + h * a_r * mu_r) + lever * (a - roll_r * a_r),
    )


def psi_front(p: Parameters, front_slip: Array, rear_slip: Array) -> Array:
    """Return Psi_f [N.m] of (7), in the slips' shape."""
    return reduced(p, front_slip, rear_slip).psi_front


def psi_rear(p: Parameters, front_slip: Array, rear_slip: Array) -> Array:
    """Return Psi_r [N.m] of (8), in the slips' shape."""
    return reduced(p, front_slip, rear_slip).psi_rear


def highest_psi(p: Parameters) -> Gains:
    """Return max Psi_f and max Psi_r [N.m] over all slips in [0, 1], on the road of p."""
    return Gains(
        _maximum(lambda f, r: reduced(p, f, r).psi_front), _maximum(lambda f, r: reduced(p, f, r).psi_rear)
    )


def k_bar(p: Parameters, roads: Iterable[Road] = Road) -> Gains:
    """Return the critical gains of Proposition 3.1 over all slips in [0, 1] and the given roads."""
    falls = [_steepest_falls(replace(p, road=road)) for road in roads]
    return Gains(max(fall.front for fall in falls), max(fall.rear for fall in falls))


def proportional(gains: Gains, target: SetPoint = TARGET) -> Torques:
    """Return the torques of (9) [N.m] as a function of the true slips."""

    def torques(front_slip: Array, rear_slip: Array) -> tuple[Array, Array]:
        return (
            np.maximum(0.0, gains.front * (target.front - front_slip)),  # (9)
            np.maximum(0.0, gains.rear * (target.rear - rear_slip)),
        )

    return torques


def proportional_by_fastest_wheel(gains: Gains, target: SetPoint = TARGET) -> Torques:
    """Return the torques of (9) [N.m] as a function of the true slips; the controller sees those of v_hat.

    v_hat = r max(w_f, w_r). With both wheels locked the slip is 0/0, which counts as no slip.
    """
    true = proportional(gains, target)

    def torques(front_slip: Array, rear_slip: Array) -> tuple[Array, Array]:
        roll_f, roll_r = 1.0 - front_slip, 1.0 - rear_slip
        v_hat = np.maximum(roll_f, roll_r)  # as a share of v
        v_hat = np.where(v_hat > 0.0, v_hat, 1.0)
        locked = (roll_f <= 0.0) & (roll_r <= 0.0)
        return true(np.where(locked, 0.0, 1.0 - roll_f / v_hat), np.where(locked, 0.0, 1.0 - roll_r / v_hat))

    return torques


def equilibria(p: Parameters, gains: Gains, target: SetPoint = TARGET) -> list[Equilibrium]:
    """Return the equilibria of (6) with (9) and the true speed that Newton's method finds from 49 starts."""
    from scipy.optimize import root  # slow to import

    loop = _closed_loop(p, gains, target)

    def rates(x: Array) -> Array:
        return loop(x.reshape(2, 1)).reshape(2)

    found: list[Equilibrium] = []
    for start in np.stack(np.meshgrid(*2 * [np.linspace(0.0, 1.0, 7)]), axis=-1).reshape(-1, 2):
        solution = root(rates, start, tol=1e-12)
        at = Equilibrium(*(float(x) for x in solution.x))
        balanced = float(np.abs(rates(solution.x)).max()) < 1e-6
        inside = all(0.0 <= x <= 1.0 for x in at)
        if balanced and inside and all(np.abs(np.subtract(at, other)).max() > 1e-6 for other in found):
            found.append(at)
    return found


def end_points(p: Parameters, gains: Gains, starts: Array, target: SetPoint = TARGET) -> Array:
    """Return the slips at which (6) with (9) and the true speed ends from `starts`; both of shape (n, 2).

    Raises RuntimeError where it is not at rest at the end, which Proposition 3.1 excludes.
    """
    from scipy.integrate import solve_ivp  # slow to import

    loop = _closed_loop(p, gains, target)

    def rates(_: float, x: Array) -> Array:
        return loop(x.reshape(-1, 2).T).T.reshape(-1)

    # Each start couples its own two slips alone: the Jacobian is banded.
    solution = solve_ivp(
        rates, (0.0, END_TIME), starts.reshape(-1), method="LSODA", rtol=1e-9, atol=1e-12, lband=1, uband=1
    )
    ends: Array = solution.y[:, -1].reshape(-1, 2)
    left = float(np.abs(rates(END_TIME, ends.reshape(-1))).max())
    if not solution.success or left > RESTING_RATE:
        raise RuntimeError(
            f"braking on {p.road.name.lower()}: not at rest after s = {END_TIME}, rates {left:.3g}"
        )
    return ends


def spread(points: Array) -> float:
    """Return the largest difference in a slip between any two of n points, shape (n, 2)."""
    return float(np.ptp(points, axis=0).max())


def locks(p: Parameters, gains: Gains, starts: Array, target: SetPoint = TARGET) -> NDArray[np.bool_]:
    """Return True for each of the `starts`, shape (n, 2), that ends with both wheels locked; shape (n,).

    Proposition 3.2: (6) with the fastest wheel's speed, by Euler's rule with a step for each start. Near the
    lock the controller sees a change of slip 1/(1 - lambda) times as large, so the steps shrink by that
    factor; they end at LOCKED.
    """
    torques = proportional_by_fastest_wheel(gains, target)
    free = reduced(p, np.zeros(1), np.zeros(1))
    stiffest = float(max(free.slope_front[0], free.slope_rear[0]))
    x: Array = starts.T
    for _ in range(MOST_STEPS):
        roll = 1.0 - x.min(axis=0)  # of the fastest wheel
        moving = roll > 1.0 - LOCKED
        if not moving.any():
            break
        ds = np.where(moving, 0.5 / (stiffest + max(gains) / np.where(moving, roll, 1.0)), 0.0)
        x = np.clip(x + ds * _rates(p, torques, x), 0.0, 1.0)
    lock = np.ones(1)
    torque_f, torque_r = torques(lock, lock)
    at = reduced(p, lock, lock)
    stays = torque_f[0] > at.psi_front[0] and torque_r[0] > at.psi_rear[0]
    return np.asarray((x >= LOCKED).all(axis=0) & bool(stays))


def random_starts(count: int, seed: int = 0) -> Array:
    """Return slips in [0, 1], shape (count, 2); the same for the same seed."""
    return np.random.default_rng(seed).random((count, 2))


def _rates(p: Parameters, torques: Torques, x: Array) -> Array:
    """Return d lambda/ds of (6) [N.m]; x and the result have the shape (2,) or (2, n)."""
    at = reduced(p, x[0], x[1])
    torque_f, torque_r = torques(x[0], x[1])
    return np.array([torque_f - at.psi_front, torque_r - at.psi_rear])  # (6)


def _closed_loop(p: Parameters, gains: Gains, target: SetPoint) -> Callable[[Array], Array]:
    """Return `_rates` under (9) with the true speed, as a function of x, shape (2, n).

    It is called some 10^5 times: both wheels are one array, slopes are left out, and what does not change is
    computed once. The numbers are those of `reduced` and `proportional` to the last bit.
    """
    th_1, th_2, th_3 = FRICTION[p.road]
    h, base, lever = p.center_height, p.wheelbase, p.wheel_inertia / p.wheel_radius
    force = p.wheel_radius * p.mass / p.wheelbase
    weight = np.array([[GRAVITY * p.rear_distance], [GRAVITY * p.front_distance]])
    weight_f, weight_r = weight[:, 0].tolist()
    shift, k, wanted = np.array([[-h], [h]]), np.array(gains)[:, None], np.array(target)[:, None]

    def rates(x: Array) -> Array:
        size = np.abs(x)
        mu = np.copysign(th_1 * (1.0 - np.exp(-th_2 * size)) - th_3 * size, x)
        mu_f, mu_r = mu
        a = -(weight_f * mu_f + weight_r * mu_r) / (base - h * (mu_f - mu_r))  # v'
        psi = force * (weight + shift * a) * mu - lever * (1.0 - x) * a  # (7), (8)
        return np.asarray(np.maximum(0.0, k * (wanted - x)) - psi)  # (6), (9)

    return rates


def _friction(road: Road, slip: Array) -> Array:
    th_1, th_2, th_3 = FRICTION[road]
    x = np.abs(slip)
    return np.asarray(np.copysign(th_1 * (1.0 - np.exp(-th_2 * x)) - th_3 * x, slip))


def _slope(road: Road, slip: Array) -> Array:
    th_1, th_2, th_3 = FRICTION[road]
    return np.asarray(th_1 * th_2 * np.exp(-th_2 * np.abs(slip)) - th_3)


def _steepest_falls(p: Parameters) -> Gains:
    return Gains(
        _maximum(lambda f, r: -reduced(p, f, r).slope_front),
        _maximum(lambda f, r: -reduced(p, f, r).slope_rear),
    )


def _maximum(value: Callable[[Array, Array], Array]) -> float:
    """Return the maximum over [0, 1] x [0, 1]: a grid of 81 x 81, then finer ones around its best point."""
    low, high = np.zeros(2), np.ones(2)
    best = -np.inf
    for _ in range(4):
        f, r = np.meshgrid(np.linspace(low[0], high[0], 81), np.linspace(low[1], high[1], 81), indexing="ij")
        values = value(f, r)
        at = np.unravel_index(int(values.argmax()), values.shape)
        best = max(best, float(values[at]))
        reach = 2.0 * (high - low) / 80.0
        center = np.array([f[at], r[at]])
        low, high = np.maximum(0.0, center - reach), np.minimum(1.0, center + reach)
    return best
