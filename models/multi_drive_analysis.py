"""Multi-drive analysis: the numbers of the two-motor car that a run gives, and limits of the printed data.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012.

    dip = max(v_ref - v),   overshoot = max(v - v_ref)                                 [km/h]    (D1)
    error = sqrt(sum e_1^2 dt/sum dt) from the first curve on                          [rad/s]   (D2)
    rho = T_aero/(1/2 A C_x v^2 R)                       density of a torque of the air [kg/m3]  (D3)
    a_rise = 0.8 v/(t_rise g)                            mean of a rise from 10 to 90 % [1]      (D4)
    a_max = 2 T_max/(R (M + 2 J_e/R^2) g)                two wheels at their torque limit [1]    (D5)
    s_p = ln(th_1 th_2/th_3)/th_2                        slip of the highest friction [1]        (D6)
    c = K_d/J_e (1 - exp(-h/tau))        growth of an error from sample to sample, sampled by h  (D7)

The symbols are those of `two_motor_vehicle`.

The paper's "optimal range" of the slip is not defined there: it is read as |s| < s_p, where more slip gives
more force. (D7): the derivative of a wheel's error meets the wheel's own inertia, behind the lag tau of the
drive; a loop with c > 1 throws its torque from limit to limit.

published: the first curve of the maneuver begins at 2 s.
chosen: the reading of the optimal range.
"""

from __future__ import annotations

from math import expm1, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .constants import GRAVITY, KMH
from .two_motor_vehicle import TwoMotorVehicle

Array = NDArray[np.float64]

FIRST_CURVE = 2.0  # s: the maneuver `curve_and_slope` begins


class Maneuver(NamedTuple):
    """The result of a controller: dip and overshoot of the speed, error of the left wheel, and distance."""

    dip: float  # km/h, largest shortfall of the speed
    overshoot: float  # km/h
    error: float  # rad/s, root mean square from the first curve on
    distance: float  # m


def maneuver(time: Array, speed: Array, reference: float, left_error: Array, distance: Array) -> Maneuver:
    """Return the numbers of a run from time [s], speed [m/s], left_error [rad/s] and distance [m].

    The four are arrays of shape (n,); `reference` is the requested speed [m/s]. The error counts from
    FIRST_CURVE on, each sample until the next.
    Raises ValueError where the run ends before the first curve.
    """
    behind = time[:-1] >= FIRST_CURVE - 1e-9
    if not behind.any():
        raise ValueError(f"the run ends at {time[-1]:g} s, before the first curve at {FIRST_CURVE:g} s")
    held, span = left_error[:-1][behind], np.diff(time)[behind]
    return Maneuver(
        KMH * float(reference - speed.min()),  # (D1)
        KMH * float(speed.max() - reference),
        float(np.sqrt(np.sum(held**2 * span) / np.sum(span))),  # (D2)
        float(distance[-1] - distance[0]),
    )


def improvement(better: float, worse: float) -> float:
    """Return the share by which `better` is smaller than `worse`."""
    return 1.0 - better / worse


def time_to_speed(time: Array, speed: Array, target: float, share: float = 0.99) -> float:
    """Return the time [s] at which a speed, shape (n,), first reaches a share of the target [m/s].

    It is linear between samples, and NaN where the speed never reaches it. The wheels' references are those
    of a car without slip; the car itself stays 0.1 % below its target.
    """
    above = np.flatnonzero(speed >= share * target)
    if not len(above):
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(time[0])
    return float(np.interp(share * target, speed[k - 1 : k + 1], time[k - 1 : k + 1]))


def density_for(torque: float, p: TwoMotorVehicle.Parameters, speed: float) -> float:
    """Return the air density [kg/m3] at which the air gives a torque [N.m] at a speed [m/s]."""
    return torque / (0.5 * p.frontal_area * p.drag_coefficient * speed**2 * p.wheel_radius)  # (D3)


def acceleration_of_rise(speed: float, rise_time: float) -> float:
    """Return the mean acceleration, in g, of a rise from 10 % to 90 % of a speed [m/s] in a time [s]."""
    return 0.8 * speed / rise_time / GRAVITY  # (D4)


def grip_limit(p: TwoMotorVehicle.Parameters, torque_limit: float) -> float:
    """Return the acceleration, in g, of two wheels at their torque limit [N.m], without resistance."""
    inertia = p.mass + 2.0 * p.wheel_inertia / p.wheel_radius**2
    return 2.0 * torque_limit / p.wheel_radius / inertia / GRAVITY  # (D5)


def peak_slip(p: TwoMotorVehicle.Parameters) -> float:
    """Return the slip [1] beyond which a tire gives less force."""
    return log(p.friction_peak * p.friction_rise / p.friction_fall) / p.friction_rise  # (D6)


def derivative_growth(p: TwoMotorVehicle.Parameters, gain: float, lag: float, period: float) -> float:
    """Return the factor c [1] of a derivative gain [N.m.s2/rad] behind a lag, sampled by a period [s]."""
    return -gain / p.wheel_inertia * expm1(-period / lag)  # (D7)
