"""Two-wheeler ride: heave, pitch and hubs of a two-wheeler on its suspensions and elastic tires.

Source: chosen; the linear half-vehicle of the textbooks, with a tire that does not pull.

    m_s z'' = S_f + S_r                                                  heave [N]                    (R1)
    m_ui z_i'' = N_i - W_i - S_i,   i = f, r                             hubs [N]                     (R2)
    S_i = k_i x_i + c_i x_i',   x_f = z_f - z + a phi,   x_r = z_r - z - b phi   suspensions [N]      (R3)
    N_i = max(0, W_i - k_t z_i - c_t z_i')                               loads of the tires [N]       (R4)
    M = b S_r - a S_f                                                    on the pitch [N.m]           (R5)

z and z_i (center of the sprung mass m_s, hubs) point up from the place under weight alone, where the loads
are W_i; phi pitches forward. a and b are the distances of that center to the axles, e is its height above
the hubs. They follow from the whole vehicle: with m h = m_s (e + r) + (m_uf + m_ur) r, and m_s a, m_s b
from the loads.

Deviations: suspensions move straight up and transmit horizontal forces and moments without a vertical one
(no anti-dive); angles are small; the rolling radius does not follow the load.

published: nothing.
chosen: all; `detailed_two_wheeler` gives the numbers.

At the edges: a tire in the air has no load, and its suspension no stop.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import NamedTuple, Protocol

Ride = tuple[float, float, float, float, float, float, float, float]
"""z, phi, z_f, z_r [m, rad] and their rates [m/s, rad/s]."""


class Springs(NamedTuple):
    """Suspensions and tires: stiffness [N/m], damping [N.s/m], unsprung masses [kg], loads at rest [N]."""

    front_stiffness: float
    rear_stiffness: float
    front_damping: float
    rear_damping: float
    tire_stiffness: float
    tire_damping: float
    front_mass: float
    rear_mass: float
    front_weight: float
    rear_weight: float


class Frame(NamedTuple):
    """The sprung mass: m_s [kg], a and b of (R3) [m], e [m]."""

    mass: float
    front: float
    rear: float
    above: float


class Rates(Protocol):
    """Accelerations of a ride [m/s2, rad/s2]."""

    @property
    def heave(self) -> float:
        """z''."""

    @property
    def pitch(self) -> float:
        """phi''."""

    @property
    def front_hub(self) -> float:
        """z_f''."""

    @property
    def rear_hub(self) -> float:
        """z_r''."""


class RideRates(NamedTuple):
    """Accelerations of a ride [m/s2, rad/s2]."""

    heave: float
    pitch: float
    front_hub: float
    rear_hub: float


Suspension = Callable[[Ride], tuple[float, float, float, float, float, float]]
"""From a ride: z'' [m/s2], M [N.m], z_f'', z_r'' [m/s2], N_f, N_r [N]."""


def frame(
    mass: float,
    height: float,
    radius: float,
    wheelbase: float,
    carried: tuple[float, float],
    unsprung: tuple[float, float],
) -> Frame:
    """Return the sprung mass of a vehicle: mass [kg], height of its center, radius of wheels, wheelbase [m].

    `carried` and `unsprung` are the masses [kg] on, and of, the front and the rear axle. Raises ValueError
    where an axle carries no more than its own mass.
    """
    front, rear = carried[0] - unsprung[0], carried[1] - unsprung[1]
    if front <= 0.0 or rear <= 0.0:
        raise ValueError(
            f"unsprung masses of {unsprung[0]} and {unsprung[1]} kg leave no sprung mass between the axles, "
            f"which carry {carried[0]:.4g} and {carried[1]:.4g} kg"
        )
    above = (mass * height - (unsprung[0] + unsprung[1]) * radius) / (front + rear) - radius
    return Frame(front + rear, wheelbase * rear / (front + rear), wheelbase * front / (front + rear), above)


def suspension(springs: Springs, frame: Frame) -> Suspension:
    """Return the function of the springs; its constants are bound once."""
    k_f, k_r, c_f, c_r, k_t, c_t, m_f, m_r, w_f, w_r = springs
    m_s, a, b, _ = frame

    def suspend(ride: Ride) -> tuple[float, float, float, float, float, float]:
        z, phi, z_f, z_r, dz, dphi, dz_f, dz_r = ride
        s_f = k_f * (z_f - z + a * phi) + c_f * (dz_f - dz + a * dphi)  # (R3)
        s_r = k_r * (z_r - z - b * phi) + c_r * (dz_r - dz - b * dphi)
        n_f, n_r = w_f - k_t * z_f - c_t * dz_f, w_r - k_t * z_r - c_t * dz_r  # (R4)
        if n_f < 0.0:
            n_f = 0.0
        if n_r < 0.0:
            n_r = 0.0
        up, moment = (s_f + s_r) / m_s, b * s_r - a * s_f  # (R1), (R5)
        return up, moment, (n_f - w_f - s_f) / m_f, (n_r - w_r - s_r) / m_r, n_f, n_r  # (R2)

    return suspend


def travel(frame: Frame, ride: Ride) -> tuple[float, float]:
    """Return the compressions [m] of the front and of the rear suspension."""
    z, phi, z_f, z_r, _, _, _, _ = ride
    return z_f - z + frame.front * phi, z_r - z - frame.rear * phi  # (R3)


def fastest_rate(springs: Springs, frame: Frame, inertia: float) -> float:
    """Return an upper bound [1/s] of the rates of (R1)-(R5) with an inertia of the pitch [kg.m2].

    Of x'' = -C x' - K x each rate obeys rate^2 <= |C| rate + |K|, and a trace is not below a norm.
    """

    def trace(front: float, rear: float, tire: float) -> float:
        sprung = (front + rear) / frame.mass + (frame.front**2 * front + frame.rear**2 * rear) / inertia
        return sprung + (front + tire) / springs.front_mass + (rear + tire) / springs.rear_mass

    damping = trace(springs.front_damping, springs.rear_damping, springs.tire_damping)
    stiffness = trace(springs.front_stiffness, springs.rear_stiffness, springs.tire_stiffness)
    return 0.5 * (damping + sqrt(damping**2 + 4.0 * stiffness))


def moved(ride: Ride, rates: Rates, h: float) -> Ride:
    """Return a ride after h [s] of Euler's rule."""
    z, phi, z_f, z_r, dz, dphi, dz_f, dz_r = ride
    return (
        z + h * dz, phi + h * dphi, z_f + h * dz_f, z_r + h * dz_r,
        dz + h * rates.heave, dphi + h * rates.pitch, dz_f + h * rates.front_hub, dz_r + h * rates.rear_hub,
    )  # fmt: skip # places, then their rates


def between(a: Ride, b: Ride, share: float) -> Ride:
    """Return a + share (b - a)."""
    z, phi, z_f, z_r, dz, dphi, dz_f, dz_r = a
    z1, phi1, z_f1, z_r1, dz1, dphi1, dz_f1, dz_r1 = b
    return (
        z + share * (z1 - z), phi + share * (phi1 - phi),
        z_f + share * (z_f1 - z_f), z_r + share * (z_r1 - z_r),
        dz + share * (dz1 - dz), dphi + share * (dphi1 - dphi),
        dz_f + share * (dz_f1 - dz_f), dz_r + share * (dz_r1 - dz_r),
    )  # fmt: skip # places, then their rates
