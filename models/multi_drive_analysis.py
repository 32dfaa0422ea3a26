"""Numbers of the two-motor car that the paper prints, and those that a run gives: pure functions.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012. Some of its numbers
contradict each other or the printed data; `claims` lists them with the reason.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .two_motor_vehicle import GRAVITY, TwoMotorVehicle

Array = NDArray[np.float64]

FIRST_CURVE = 2.0  # s: the maneuver `curve_and_slope` begins
RUN_TIME = 10.0  # s: its duration in the paper


class Maneuver(NamedTuple):
    """How a controller did: dip and overshoot of the speed, error of the left wheel, and the way."""

    dip: float  # km/h, largest shortfall of the speed
    overshoot: float  # km/h
    error: float  # rad/s, root mean square from the first curve on
    distance: float  # m


def maneuver(time: Array, speed: Array, reference: float, left_error: Array, distance: Array) -> Maneuver:
    """The numbers of a run: time [s], speed [m/s], left_error [rad/s], distance [m] are arrays of shape (n,).

    `reference` is the speed asked for [m/s]. The error counts from FIRST_CURVE on, each sample until the
    next.
    Raises ValueError where the run ends before the first curve.
    """
    behind = time[:-1] >= FIRST_CURVE - 1e-9
    if not behind.any():
        raise ValueError(f"the run ends at {time[-1]:g} s, before the first curve at {FIRST_CURVE:g} s")
    held, span = left_error[:-1][behind], np.diff(time)[behind]
    return Maneuver(
        3.6 * float(reference - speed.min()),
        3.6 * float(speed.max() - reference),
        float(np.sqrt(np.sum(held**2 * span) / np.sum(span))),
        float(distance[-1] - distance[0]),
    )


def improvement(better: float, worse: float) -> float:
    """By what share `better` is smaller than `worse`."""
    return 1.0 - better / worse


def time_to_speed(time: Array, speed: Array, target: float, share: float = 0.99) -> float:
    """When [s] a speed, shape (n,), first reaches a share of the target, linear between samples.

    NaN if it never does.     The wheels' references are those of a car without slip; the car itself stays
    0.1 % below its target.
    """
    above = np.flatnonzero(speed >= share * target)
    if not len(above):
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(time[0])
    return float(np.interp(share * target, speed[k - 1 : k + 1], time[k - 1 : k + 1]))


def density_for(torque: float, p: TwoMotorVehicle.Parameters, speed: float) -> float:
    """The air density [kg/m3] at which (2) gives a torque [N.m] at a speed [m/s]."""
    return torque / (0.5 * p.frontal_area * p.drag_coefficient * speed**2 * p.wheel_radius)


def acceleration_of_rise(speed: float, rise_time: float) -> float:
    """The mean acceleration, in g, of a rise from 10 % to 90 % of a speed [m/s] in a time [s]."""
    return 0.8 * speed / rise_time / GRAVITY


def grip_limit(p: TwoMotorVehicle.Parameters, torque_limit: float) -> float:
    """The acceleration, in g, of two wheels at their torque limit [N.m]: mass and wheels, no resistance."""
    inertia = p.mass + 2.0 * p.wheel_inertia / p.wheel_radius**2
    return 2.0 * torque_limit / p.wheel_radius / inertia / GRAVITY


class Claim(NamedTuple):
    """A printed number that no model of the printed data can give, and why."""

    what: str
    printed: str
    reason: str


def claims(p: TwoMotorVehicle.Parameters, speed: float, torque_limit: float) -> list[Claim]:
    """The paper's numbers that are not reproducible, for a car, a speed [m/s] and a torque limit [N.m]."""
    way = speed * RUN_TIME
    needed = [acceleration_of_rise(speed, rise) for rise in (0.50, 0.55)]
    able = grip_limit(p, torque_limit)
    return [
        Claim(
            "distance in 10 s, for the two controllers",
            "460.2 / 354.4 m",
            f"{RUN_TIME:g} s at {3.6 * speed:.0f} km/h are {way:.1f} m; the printed ones take "
            f"{460.2 / speed:.1f} and {354.4 / speed:.1f} s",
        ),
        Claim(
            "rise time, for the two controllers",
            "0.50 / 0.55 s",
            f"10 % to 90 % of {3.6 * speed:.0f} km/h need {needed[0]:.1f} and {needed[1]:.1f} g; the printed "
            f"torque, gear and mass give at most {able:.2f} g",
        ),
        Claim(
            "overshoot, for the two controllers",
            "0 / 9.33 %",
            "belongs to the rise that is not reproducible: from a standstill at the torque limit, with "
            "conditional integration, the speed overshoots by less than 0.1 % under either controller",
        ),
        Claim(
            "speed error, for the two controllers",
            "0 / 0.13 km/h",
            "the instant is not said; in the long run the integral leaves the wheels no error under either, "
            "and slip leaves the car 0.1 % behind",
        ),
        Claim(
            "derivative gain K_d = 2500",
            "2500",
            "differenced at 100 Hz it throws the torque from limit to limit; the paper gives no sampling "
            "and no filter",
        ),
        Claim(
            "torque of the air",
            "93.2 N.m",
            f"needs a density of {density_for(93.2, p, speed):.3f} kg/m3, which the paper does not print; "
            f"1.2 kg/m3 give {1.2 / density_for(93.2, p, speed) * 93.2:.2f} N.m",
        ),
    ]
