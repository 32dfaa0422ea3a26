"""Scooter: the longitudinal motion of a light electric two-wheeler and its motor drive (EMD).

Source: Dardanelli et al., "Speed and acceleration controllers for a light electric two-wheeled vehicle",
IEEE CDC-ECC 2011. SI inside; the throttle g is in %.

    M dv/dt = F_w - F_br - F_f                                        motion [N]                     (1)
    F_f = 1/2 rho CxA v^2 + r_v v + M g (C_r cos th + sin th)         resistance [N]                 (2)
    R(v) = F_f of a level road, th = 0                                road load of (S2) [N]          (3)
    tau_m F_w' = (g/100) fade(v) F_max(v) - F_w                       the drive's current loop      (S1)
    F_max(v) = min(F_b, 100 mu R(v)/(v_kmh - c))                      the force map [N]             (S2)
    fade(v)  = 1 below 49.5 km/h, 0 above 50.5 km/h, linear between   the drive's speed limit       (S3)
    w_f = v/r_f,  w_r = v/r_r                                         pure rolling [rad/s]          (S4)
    P = min(F_w v/eta + P_0, A)                                       at the battery terminals [W]  (S5)
    F_w v <= eta max(0, A - P_0)                                      what is left for the drive    (S6)
    d' = v                                                            distance [m]

(S2) is derived from the published gain mu and pole, c = 17.03 km/h ("Derivations" in
docs/systems/scooter.md). It is valid from 24 to 49 km/h and belongs to the drive: R(v) is that of the default
parameters, the vehicle that the drive was matched to, whatever the parameters are set to.

Deviations: the paper defines F_g = M g cos th and multiplies it by (C_r cos th + sin th) in (2); the double
cosine is a misprint.

A is the input `available_power`: by default no limit. The A of t_k acts in the step from t_k to t_k+1: it
limits force and command at the start of the step and at its end, so that the P of t_k+1 is at most A; a
battery that steps after the vehicle delivers all of it. A comes from the battery's charge alone, so that no
loop arises.

published: mu = 0.46 and the pole 0.03 Hz, both at one working point, the clipping of the throttle to 0..100
%, the limit of 50 km/h, v = (w_f r_f + w_r r_r)/2.
inferred: mu is in km/h per %.
chosen: the working point of both, 30 km/h; M = 200 kg, rho = 1.2 kg/m3, CxA = 0.60 m2, r_v = 10 N.s/m, C_r =
0.014, F_b = 850 N, tau_m = 5 ms, (S6), the fade of 1 km/h, r_f = r_r = 0.2 m, eta = 0.85, P_0 = 40 W,
g = 9.81 m/s2.

At the edges: the vehicle never moves backward. At v = 0 it stands as long as the drive does not overcome
brake, grade and rolling resistance, and its acceleration is then 0. Negative brake forces count as none.
There is no slip, so that the paper's v = (w_f r_f + w_r r_r)/2 holds exactly. There is no regeneration: the
brake is a friction brake, and P is never below P_0, or below A if that is less. At the start the drive gives
no force. With A <= P_0 it gives none: the vehicle coasts. That A limits the drive, it says in the log.

Step: (S1) is solved exactly for a command that changes linearly over the step, (1) by Heun's rule: order 2 in
dt, stable for any dt/tau_m. A step of 10 ms is exact to about 1e-5 m/s away from the corners of the map.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, exp, pi, sin

from .base import Model, record, var
from .constants import AIR_DENSITY, GRAVITY, KMH

MATCHED_GAIN = 0.46  # published, without its unit: km/h per %
MATCHED_POLE = 0.03  # Hz at MATCHED_SPEED, published
MATCHED_SPEED = 30.0  # km/h, chosen
NO_LIMIT = 1e12  # W


class Scooter(Model):
    """Throttle, brake and grade in; speed, wheel speeds and electrical power out."""

    initial_inputs = ("available_power",)

    @record
    class Parameters:
        """Vehicle and drive; the module's docstring marks what is published."""

        mass: float = var(200.0, "kg", "Vehicle and rider", min=1.0)
        air_density: float = var(AIR_DENSITY, "kg/m3", "Density of the air", min=0.0)
        drag_area: float = var(0.60, "m2", "Drag coefficient times frontal area", min=0.0)
        viscous_resistance: float = var(10.0, "N.s/m", "Resistance proportional to the speed", min=0.0)
        rolling_resistance: float = var(0.014, "1", "Rolling resistance coefficient", min=0.0)
        maximum_force: float = var(850.0, "N", "Limit of the low-speed boost", min=0.0)
        drive_time_constant: float = var(0.005, "s", "Lag of the drive's current loop", min=1e-6)
        speed_limit: float = var(50.0, "km/h", "Speed limit of the drive", min=0.0)
        speed_limit_band: float = var(1.0, "km/h", "Band in which the drive's force fades out", min=1e-3)
        drive_efficiency: float = var(0.85, "1", "Battery terminals to wheel", min=0.01, max=1.0)
        auxiliary_power: float = var(40.0, "W", "Drawn by everything but the drive", min=0.0)
        front_wheel_radius: float = var(0.2, "m", "Rolling radius of the front wheel", min=0.01)
        rear_wheel_radius: float = var(0.2, "m", "Rolling radius of the rear wheel", min=0.01)
        initial_speed: float = var(0.0, "m/s", "Speed at the start", min=0.0)

        @cached_property
        def drag(self) -> float:
            """1/2 rho CxA [N.s2/m2]."""
            return 0.5 * self.air_density * self.drag_area

        @cached_property
        def fade_end(self) -> float:
            """Speed [m/s] from which on the drive gives no force, (S3)."""
            return (self.speed_limit + 0.5 * self.speed_limit_band) / KMH

        @cached_property
        def fade_slope(self) -> float:
            """Fall of the fade with the speed [s/m], (S3)."""
            return KMH / self.speed_limit_band

        @cached_property
        def force_map(self) -> ForceMap:
            """The map (S2) of the drive, matched to the vehicle of the default parameters."""
            return _matched_map(Scooter.Parameters())

    @record
    class Inputs:
        """The commands to drive and brake, and the slope of the road."""

        throttle: float = var(0.0, "%", "Throttle request, clipped to 0..100 % by the drive")
        brake_force: float = var(0.0, "N", "Force of the friction brakes", min=0.0)
        road_grade: float = var(0.0, "rad", "Angle of the road, positive uphill", min=-1.5, max=1.5)
        available_power: float = var(
            NO_LIMIT, "W", "Largest power that the battery can deliver; by default no limit", min=0.0
        )

    @record
    class State:
        """Motion and force of the drive."""

        speed: float = var(0.0, "m/s", "Speed", min=0.0)
        drive_force: float = var(0.0, "N", "Force of the drive at the wheel", min=0.0)
        distance: float = var(0.0, "m", "Distance travelled", min=0.0)
        available_power: float = var(NO_LIMIT, "W", "Limit of the power in the last step", min=0.0)

    @record
    class Outputs:
        """The quantities that the sensors of the vehicle and of the bench measure."""

        speed: float = var(0.0, "m/s", "Speed", min=0.0, nominal=10.0, initially=())
        acceleration: float = var(
            0.0,
            "m/s2",
            "Acceleration",
            depends=("brake_force", "road_grade"),
            initially=("brake_force", "road_grade"),
        )
        front_wheel_speed: float = var(
            0.0, "rad/s", "Speed of the front wheel", min=0.0, nominal=50.0, initially=()
        )
        rear_wheel_speed: float = var(
            0.0, "rad/s", "Speed of the rear wheel", min=0.0, nominal=50.0, initially=()
        )
        power: float = var(40.0, "W", "Electrical power at the battery terminals", min=0.0, nominal=1000.0)
        drive_force: float = var(
            0.0, "N", "Force of the drive at the wheel", min=0.0, nominal=100.0, initially=()
        )
        distance: float = var(0.0, "m", "Distance travelled", min=0.0, nominal=100.0, initially=())

    @staticmethod
    def initial(p: Scooter.Parameters, u: Scooter.Inputs) -> Scooter.State:
        """Return the state of rolling at `initial_speed`, without force."""
        return Scooter.State(p.initial_speed, 0.0, 0.0, max(0.0, u.available_power))

    @staticmethod
    def step(p: Scooter.Parameters, x: Scooter.State, u: Scooter.Inputs, dt: float) -> Scooter.State:
        """Return the state after `dt` [s] of held inputs."""
        v, m = x.speed, p.mass
        available = max(0.0, u.available_power)
        work = p.drive_efficiency * max(0.0, available - p.auxiliary_power)
        f = _within(x.drive_force, v, work)
        hold = _held_forces(p, u)
        tau = p.drive_time_constant
        decay = exp(-dt / tau)
        # Predictor: command and resistance of the start, over the whole step.
        c0, r0 = _within(command(p, v, u.throttle), v, work), _resistance(p, v)
        impulse = dt * c0 + tau * (f - c0) * (1.0 - decay)  # (S1), integrated
        v1 = max(0.0, v + (impulse - dt * (r0 + hold)) / m)
        # Corrector: both change linearly to their values at the predicted speed.
        c1, r1 = _within(command(p, v1, u.throttle), v1, work), _resistance(p, v1)
        ramp = tau * (c1 - c0) / dt
        f1 = c1 - ramp + (f - c0 + ramp) * decay  # (S1)
        impulse = 0.5 * dt * (c0 + c1) - tau * (f1 - f)
        v1 = v + (impulse - dt * (0.5 * (r0 + r1) + hold)) / m  # (1)
        moving = 1.0
        if v1 < 0.0:  # it stops within the step and stays
            moving = v / (v - v1)
            v1 = 0.0
        # f1 lags commands that are not negative, so it is not either, but for rounding.
        f1 = _within(max(0.0, f1), v1, work)
        return Scooter.State(v1, f1, x.distance + 0.5 * moving * dt * (v + v1), available)

    @staticmethod
    def outputs(p: Scooter.Parameters, x: Scooter.State, u: Scooter.Inputs) -> Scooter.Outputs:
        """Return the quantities measured at this instant; brake and grade act on the acceleration at once."""
        v, f = x.speed, x.drive_force
        a = (f - _resistance(p, v) - _held_forces(p, u)) / p.mass  # (1)
        if v <= 0.0 and a < 0.0:
            a = 0.0
        w_f, w_r = v / p.front_wheel_radius, v / p.rear_wheel_radius  # (S4)
        power = min(f * v / p.drive_efficiency + p.auxiliary_power, x.available_power)  # (S5)
        return Scooter.Outputs(v, a, w_f, w_r, power, f, x.distance)

    @staticmethod
    def notice(p: Scooter.Parameters, before: Scooter.State, after: Scooter.State, u: Scooter.Inputs) -> str:
        """Return a sentence when the drive gives less force than is asked for, because of (S6)."""
        if after.available_power >= NO_LIMIT or u.throttle <= 0.0:
            return ""
        v = after.speed
        wanted = command(p, v, u.throttle) * v / p.drive_efficiency + p.auxiliary_power
        limited = wanted > after.available_power or after.available_power <= p.auxiliary_power
        return (
            "the battery cannot deliver the power that is asked for: the drive gets what is left"
            if limited
            else ""
        )


@dataclass(frozen=True)
class ForceMap:
    """Numbers of (S2) below its limit, in SI: F = peak (static + v (viscous + drag v))/(v - offset)."""

    peak: float
    offset: float
    static: float
    viscous: float
    drag: float


def level_road_load(p: Scooter.Parameters, v: float) -> float:
    """Return the resistance [N] at speed v [m/s] on a level road."""
    return p.mass * GRAVITY * p.rolling_resistance + _resistance(p, v)  # (3)


def _matched_map(p: Scooter.Parameters) -> ForceMap:
    """Return the map (S2) that has the published gain and pole in a vehicle of parameters p."""
    gain, v0 = MATCHED_GAIN / KMH, MATCHED_SPEED / KMH
    force = 100.0 * p.mass * 2.0 * pi * MATCHED_POLE * gain
    offset = v0 - 100.0 * gain * level_road_load(p, v0) / force
    static = p.mass * GRAVITY * p.rolling_resistance
    return ForceMap(100.0 * gain, offset, static, p.viscous_resistance, p.drag)


def maximum_force(p: Scooter.Parameters, v: float) -> float:
    """Return the force [N] of full throttle at speed v [m/s], by (S2) and (S3)."""
    k = p.force_map
    force = p.maximum_force
    if v > k.offset:
        force = min(force, k.peak * (k.static + v * (k.viscous + k.drag * v)) / (v - k.offset))  # (S2)
    fade = (p.fade_end - v) * p.fade_slope  # (S3)
    if fade < 1.0:
        force *= max(0.0, fade)
    return force


def command(p: Scooter.Parameters, v: float, throttle: float) -> float:
    """Return the command of (S1), (g/100) fade(v) F_max(v) [N]."""
    return 0.01 * min(100.0, max(0.0, throttle)) * maximum_force(p, v)


def _within(force: float, v: float, work: float) -> float:
    """Return the force [N] at speed v [m/s], not above that of the power `work` [W] that is left for it."""
    if work <= 0.0:
        return 0.0
    return work / v if force * v > work else force  # (S6)


def _resistance(p: Scooter.Parameters, v: float) -> float:
    """Return the part of (2) that depends on the speed [N]."""
    return v * (p.viscous_resistance + p.drag * v)  # (2)


def _held_forces(p: Scooter.Parameters, u: Scooter.Inputs) -> float:
    """Return brake, rolling resistance and grade [N]: the forces that a step holds."""
    th = u.road_grade
    weight = p.mass * GRAVITY
    return max(0.0, u.brake_force) + weight * (p.rolling_resistance * cos(th) + sin(th))  # (2)
