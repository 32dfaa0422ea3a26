"""DetailedTwoWheeler: a braking two-wheeler that heaves and pitches on springs and on elastic tires.

Source: chosen. Tanelli et al. (IEEE CDC 2008) simulate with suspensions, tire elasticity and tire
relaxation and print no equation of them. In the place of (5) of `two_wheeler_braking`:

    m v' + m_s e phi'' = -F_xf - F_xr - D,   D = 1/2 rho CdA v^2         forces along the road [N]    (D1)
    (I + m_s e^2) phi'' + m_s e v' = B + r D + m_s g e phi + M           pitch [N.m]                  (D2)
    F_xi = N_i mu(s_i),   i = f, r                                       tire force [N]               (D3)
    sigma s_i' = (v - w_i r) - max(v, w_i r) s_i                         slip of a tire [m/s]         (D4)
    J w_i' = r F_xi - T_i                                                wheels [N.m]                 (D5)
    B = r (F_xf + F_xr) - q J (w_f' + w_r')                              brakes on the frame [N.m]    (D6)

`two_wheeler_ride` has the springs: the moment M of the suspensions, the loads N_i, m_s and e. phi pitches
forward, v is the speed of the hubs, and e the height of the center of the sprung mass m_s above them. q = 1
(`wheel_reaction`): the frame holds the brakes, B = T_f + T_r. q = 0 leaves the wheels' angular momentum
out, as (5) does; on stiff springs and with sigma = 0 this is then `two_wheeler_braking`.

A stop ends as there, and the springs move on, the deceleration being given:

    (I + m_s e (e + r)) phi'' = -m h v' - q J (w_f' + w_r') + m_s g e phi + M       (D1) in (D2)      (D7)

Deviations: the lean m_s g e phi, and q = 1, shift load beyond (5).

published: v_0 = 100 km/h; that there are suspensions, tire elasticity, relaxation.
chosen: h = 0.46 m, calibrated to Table I (lower than in (5), because of both deviations); m, r, l_f, l_r,
J, CdA, rho, road and g as in `two_wheeler_braking`; m_uf = 14 kg, m_ur = 18 kg, I = 28 kg.m2; k_f = 18, k_r
= 24 kN/m, c_f = 1200, c_r = 1600 N.s/m (2.5 Hz, half of critical); k_t = 160 kN/m, c_t = 400 N.s/m; sigma =
0.15 m.

At the edges: w_i >= 0 as in `two_wheeler_braking`: the brake of a locked wheel holds r F_xi. There is no
limit to the pitch; beyond 0.5 rad the log says that the vehicle turns over. At the start it rolls freely,
at rest on its springs under the deceleration of the air.

Step: Heun's rule with inner steps of at most 0.5 ms and held torques, (D4) by its exact solution for a slip
that is linear in the inner step; shorter where springs are stiff, wheels light or sigma small. Order 2.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import ceil, exp, sqrt
from typing import NamedTuple

from .base import Model, record, var
from .constants import GRAVITY
from .road_friction import FRICTION, friction_slope
from .tire_relaxation import relaxation, relaxed
from .two_wheeler_braking import TwoWheelerBraking, slip
from .two_wheeler_ride import (
    Frame,
    Ride,
    RideRates,
    Springs,
    between,
    fastest_rate,
    frame,
    moved,
    suspension,
    travel,
)

INNER_STEP = 5e-4  # s, at most
TURNED_OVER = 0.5  # rad


class DetailedTwoWheeler(Model):
    """Inputs and outputs of `TwoWheelerBraking`, in whose place it stands, and the motion on the springs."""

    @record
    class Parameters(TwoWheelerBraking.Parameters):
        """Those of `TwoWheelerBraking`, and what carries the vehicle; all chosen."""

        center_height: float = var(0.46, "m", "Height of the center of mass (h)", min=0.0)
        front_unsprung_mass: float = var(14.0, "kg", "Front wheel and what moves with it (m_uf)", min=0.1)
        rear_unsprung_mass: float = var(18.0, "kg", "Rear wheel and what moves with it (m_ur)", min=0.1)
        pitch_inertia: float = var(28.0, "kg.m2", "Inertia of the sprung mass in pitch (I)", min=0.1)
        front_stiffness: float = var(18e3, "N/m", "Spring of the front suspension (k_f)", min=1.0)
        rear_stiffness: float = var(24e3, "N/m", "Spring of the rear suspension (k_r)", min=1.0)
        front_damping: float = var(1200.0, "N.s/m", "Damper of the front suspension (c_f)", min=0.0)
        rear_damping: float = var(1600.0, "N.s/m", "Damper of the rear suspension (c_r)", min=0.0)
        tire_stiffness: float = var(160e3, "N/m", "Radial stiffness of each tire (k_t)", min=1.0)
        tire_damping: float = var(400.0, "N.s/m", "Radial damping of each tire (c_t)", min=0.0)
        relaxation_length: float = var(0.15, "m", "Relaxation length of each tire (sigma)", min=0.0)
        wheel_reaction: bool = var(True, "", "Whether the wheels' angular momentum pitches the vehicle (q)")

        @cached_property
        def frame(self) -> Frame:
            """The sprung mass that these parameters leave."""
            return frame(
                self.mass,
                self.center_height,
                self.wheel_radius,
                self.wheelbase,
                (self.front_weight / GRAVITY, self.rear_weight / GRAVITY),
                (self.front_unsprung_mass, self.rear_unsprung_mass),
            )

        @cached_property
        def springs(self) -> Springs:
            """Suspensions and tires."""
            return Springs(
                self.front_stiffness, self.rear_stiffness, self.front_damping, self.rear_damping,
                self.tire_stiffness, self.tire_damping, self.front_unsprung_mass, self.rear_unsprung_mass,
                self.front_weight, self.rear_weight,
            )  # fmt: skip # suspensions, tires and wheels, loads

        @cached_property
        def inner_step(self) -> float:
            """The longest inner step [s], by bounds of the fastest rates of springs and of slip."""
            return _inner_step(self)

        @cached_property
        def motion(self) -> Motion:
            """The right side of (D1)-(D6), the function of `_motion`."""
            return _motion(self)

    @record
    class Inputs(TwoWheelerBraking.Inputs):
        """The torques of the brakes."""

    @record
    class State:
        """Motion along the road and on the springs, slips of the tires, and the end of the stop."""

        speed: float = var(0.0, "m/s", "Speed (v)", min=0.0)
        front_rim_speed: float = var(0.0, "m/s", "Circumferential speed of the front wheel (w_f r)", min=0.0)
        rear_rim_speed: float = var(0.0, "m/s", "Circumferential speed of the rear wheel (w_r r)", min=0.0)
        front_tire_slip: float = var(0.0, "1", "Slip of the front tire (s_f)", min=-1.0, max=1.0)
        rear_tire_slip: float = var(0.0, "1", "Slip of the rear tire (s_r)", min=-1.0, max=1.0)
        heave: float = var(0.0, "m", "Sprung mass up (z)")
        pitch: float = var(0.0, "rad", "Pitch, forward (phi)")
        front_hub: float = var(0.0, "m", "Front hub up (z_f)")
        rear_hub: float = var(0.0, "m", "Rear hub up (z_r)")
        heave_rate: float = var(0.0, "m/s", "Rate of z")
        pitch_rate: float = var(0.0, "rad/s", "Rate of phi")
        front_hub_rate: float = var(0.0, "m/s", "Rate of z_f")
        rear_hub_rate: float = var(0.0, "m/s", "Rate of z_r")
        distance: float = var(0.0, "m", "Distance travelled (d)", min=0.0)
        front_torque: float = var(0.0, "N.m", "Front brake torque of the last step (T_f)", min=0.0)
        rear_torque: float = var(0.0, "N.m", "Rear brake torque of the last step (T_r)", min=0.0)
        stop_deceleration: float = var(0.0, "m/s2", "Deceleration kept at the end; 0 before", min=0.0)
        stopping_distance: float = var(0.0, "m", "Stopping distance; 0 before it is known", min=0.0)

    @record
    class Outputs(TwoWheelerBraking.Outputs):
        """Those of `TwoWheelerBraking`, and the motion on the springs."""

        deceleration: float = var(0.8981481481481484, "m/s2", "Deceleration (-v')", nominal=10.0)
        front_load: float = var(
            812.6840164413027, "N", "Load of the front tire (N_f)", min=0.0, nominal=1000.0
        )
        rear_load: float = var(1149.315983558697, "N", "Load of the rear tire (N_r)", min=0.0, nominal=1000.0)
        front_tire_slip: float = var(0.0, "1", "Slip of the front tire (s_f)", min=-1.0, max=1.0)
        rear_tire_slip: float = var(0.0, "1", "Slip of the rear tire (s_r)", min=-1.0, max=1.0)
        pitch: float = var(0.005101190636690246, "rad", "Pitch, forward (phi)", nominal=0.1)
        heave: float = var(0.0004477378671398787, "m", "Sprung mass up (z)", nominal=0.01)
        front_travel: float = var(
            0.0034868898022945983, "m", "Compression of the front suspension (x_f)", nominal=0.01
        )
        rear_travel: float = var(
            -0.002615167351720949, "m", "Compression of the rear suspension (x_r)", nominal=0.01
        )

    @staticmethod
    def initial(p: DetailedTwoWheeler.Parameters, u: DetailedTwoWheeler.Inputs) -> DetailedTwoWheeler.State:
        """Return free rolling at `initial_speed`, on springs at rest.

        Raises ValueError where that is not above `stop_speed`, where the unsprung masses leave no sprung mass
        between the axles, and where the springs cannot carry the vehicle upright.
        """
        v = TwoWheelerBraking.initial(p, u).speed
        pitch, front = _at_rest(p, 0.5 * p.air_density * p.drag_area * v * v / p.mass)
        k, tire = p.frame, front / p.tire_stiffness
        heave = -tire - front / p.front_stiffness + k.front * pitch
        return DetailedTwoWheeler.State(v, v, v, 0.0, 0.0, heave, pitch, -tire, tire)

    @staticmethod
    def step(
        p: DetailedTwoWheeler.Parameters,
        x: DetailedTwoWheeler.State,
        u: DetailedTwoWheeler.Inputs,
        dt: float,
    ) -> DetailedTwoWheeler.State:
        """Return the state after `dt` [s] of held torques."""
        if x.stop_deceleration > 0.0:
            return _come_to_rest(p, x, dt)
        n = ceil(dt / p.inner_step - 1e-9)
        x, left = _advance(p, x, max(0.0, u.front_torque), max(0.0, u.rear_torque), dt / n, n)
        return _come_to_rest(p, x, left) if left > 0.0 else x

    @staticmethod
    def outputs(p: DetailedTwoWheeler.Parameters, x: DetailedTwoWheeler.State) -> DetailedTwoWheeler.Outputs:
        """Return the quantities measured at this instant, the torques being those of the step to it."""
        v, rim_f, rim_r = x.speed, x.front_rim_speed, x.rear_rim_speed
        now = p.motion(
            v, rim_f, rim_r, x.front_tire_slip, x.rear_tire_slip, ride_of(x), x.front_torque, x.rear_torque
        )
        a = -now.speed
        if x.stop_deceleration > 0.0:
            a = x.stop_deceleration if v > 0.0 else 0.0
        return DetailedTwoWheeler.Outputs(
            v, a, x.distance, x.stopping_distance,
            rim_f / p.wheel_radius, rim_r / p.wheel_radius, rim_f, rim_r, slip(v, rim_f), slip(v, rim_r),
            now.front_force, now.rear_force, now.front_load, now.rear_load,
            x.front_tire_slip, x.rear_tire_slip, x.pitch, x.heave, *travel(p.frame, ride_of(x)),
        )  # fmt: skip # motion, wheels, tires, springs

    @staticmethod
    def notice(
        p: DetailedTwoWheeler.Parameters,
        before: DetailedTwoWheeler.State,
        after: DetailedTwoWheeler.State,
        u: DetailedTwoWheeler.Inputs,
    ) -> str:
        """Return a sentence when the vehicle turns over, which small angles do not describe."""
        if abs(after.pitch) > TURNED_OVER:
            return "the vehicle turns over: its pitch is beyond what the model describes"
        return ""


class Now(NamedTuple):
    """Rates [m/s2, rad/s2] of speeds and of the ride, forces and loads [N] at one instant."""

    speed: float
    front_rim: float
    rear_rim: float
    heave: float
    pitch: float
    front_hub: float
    rear_hub: float
    front_force: float
    rear_force: float
    front_load: float
    rear_load: float


Motion = Callable[[float, float, float, float, float, Ride, float, float], Now]


def ride_of(x: DetailedTwoWheeler.State) -> Ride:
    """Return the part of a state that moves on the springs."""
    return (
        x.heave, x.pitch, x.front_hub, x.rear_hub,
        x.heave_rate, x.pitch_rate, x.front_hub_rate, x.rear_hub_rate,
    )  # fmt: skip # places, then their rates


def _at_rest(p: DetailedTwoWheeler.Parameters, deceleration: float) -> tuple[float, float]:
    """Return pitch [rad] and S_f = -S_r [N] at rest on the springs under a deceleration [m/s2].

    Raises ValueError for springs on which the vehicle falls over.
    """
    k, length = p.frame, p.wheelbase
    give = 1.0 / p.front_stiffness + 1.0 / p.rear_stiffness + 2.0 / p.tire_stiffness
    left = length - k.mass * GRAVITY * k.above * give / length
    if left <= 0.0:
        raise ValueError("the springs and tires are too soft to keep the vehicle upright")
    front = p.mass * p.center_height * deceleration / left  # (D7) at rest
    return front * give / length, front


def _inner_step(p: DetailedTwoWheeler.Parameters) -> float:
    k = p.frame
    inertia = p.pitch_inertia + k.mass * k.above**2 * (1.0 - k.mass / p.mass)
    grip = p.wheel_radius**2 * p.mass * GRAVITY * friction_slope(p.road, 0.0) / p.wheel_inertia  # m/s2
    wheel = grip / p.stop_speed
    if p.relaxation_length > 0.0:
        wheel = min(wheel, 2.0 * sqrt(grip / p.relaxation_length))
    return min(INNER_STEP, 0.5 / fastest_rate(p.springs, k, inertia), 1.0 / wheel)


def _motion(p: DetailedTwoWheeler.Parameters) -> Motion:
    """Return the function (v, w_f r, w_r r, s_f, s_r, ride, T_f, T_r) -> rates, forces and loads.

    Its constants are bound once for a set of parameters.
    """
    th_1, th_2, th_3 = FRICTION[p.road]
    suspend = suspension(p.springs, p.frame)
    k, m, r = p.frame, p.mass, p.wheel_radius
    drag, by_inertia = 0.5 * p.air_density * p.drag_area, r / p.wheel_inertia
    momentum = p.wheel_inertia / r if p.wheel_reaction else 0.0  # of w r
    coupling, weight = k.mass * k.above, k.mass * GRAVITY * k.above
    inertia = p.pitch_inertia + coupling * k.above - coupling * coupling / m

    def motion(
        v: float, rim_f: float, rim_r: float, s_f: float, s_r: float, ride: Ride, t_f: float, t_r: float
    ) -> Now:
        up, pitch, up_f, up_r, load_f, load_r = suspend(ride)
        x = s_f if s_f >= 0.0 else -s_f
        force_f = load_f * (th_1 * (1.0 - exp(-th_2 * x)) - th_3 * x)  # (D3)
        if s_f < 0.0:
            force_f = -force_f
        x = s_r if s_r >= 0.0 else -s_r
        force_r = load_r * (th_1 * (1.0 - exp(-th_2 * x)) - th_3 * x)
        if s_r < 0.0:
            force_r = -force_r
        a_f, a_r = by_inertia * (r * force_f - t_f), by_inertia * (r * force_r - t_r)  # (D5)
        if rim_f <= 0.0 and a_f < 0.0:
            a_f = 0.0
        if rim_r <= 0.0 and a_r < 0.0:
            a_r = 0.0
        air, tires = drag * v * v, force_f + force_r
        reaction = r * tires - momentum * (a_f + a_r)  # (D6)
        push = -(tires + air)
        turn = reaction + r * air - coupling / m * push + weight * ride[1] + pitch
        about = turn / inertia  # (D2), with (D1) in it
        along = (push - coupling * about) / m  # (D1)
        return Now(along, a_f, a_r, up, about, up_f, up_r, force_f, force_r, load_f, load_r)

    return motion


def _advance(
    p: DetailedTwoWheeler.Parameters,
    x: DetailedTwoWheeler.State,
    torque_f: float,
    torque_r: float,
    h: float,
    n: int,
) -> tuple[DetailedTwoWheeler.State, float]:
    """Return the state after n Heun steps of h [s], or as many as reach `stop_speed`, and the time left."""
    motion, stop, sigma = p.motion, p.stop_speed, p.relaxation_length
    v, f, b, way = x.speed, x.front_rim_speed, x.rear_rim_speed, x.distance
    s_f, s_r, ride = x.front_tire_slip, x.rear_tire_slip, ride_of(x)
    slip_f, slip_r, left = slip(v, f), slip(v, b), 0.0
    a = 0.0
    for i in range(n):
        k = motion(v, f, b, s_f, s_r, ride, torque_f, torque_r)
        v1, f1, b1 = v + h * k.speed, max(0.0, f + h * k.front_rim), max(0.0, b + h * k.rear_rim)
        relax_f = relaxation(sigma, h, 0.5 * max(v + v1, f + f1))  # (D4)
        relax_r = relaxation(sigma, h, 0.5 * max(v + v1, b + b1))
        s_f1 = relaxed(relax_f, s_f, slip_f, slip(v1, f1))
        s_r1 = relaxed(relax_r, s_r, slip_r, slip(v1, b1))
        ride1 = moved(ride, k, h)
        k1 = motion(v1, f1, b1, s_f1, s_r1, ride1, torque_f, torque_r)
        v1 = v + 0.5 * h * (k.speed + k1.speed)
        f1 = max(0.0, f + 0.5 * h * (k.front_rim + k1.front_rim))
        b1 = max(0.0, b + 0.5 * h * (k.rear_rim + k1.rear_rim))
        slip_f1, slip_r1 = slip(v1, f1), slip(v1, b1)
        s_f, s_r = relaxed(relax_f, s_f, slip_f, slip_f1), relaxed(relax_r, s_r, slip_r, slip_r1)
        ride1 = between(ride, moved(ride1, k1, h), 0.5)
        if v1 <= stop:
            share = (v - stop) / (v - v1)
            way += 0.5 * share * h * (v + stop)
            f1, b1, a, left = f1 * stop / v1, b1 * stop / v1, (v - v1) / h, h * (n - i - share)
            v, f, b, ride = stop, f1, b1, between(ride, ride1, share)
            break
        way += 0.5 * h * (v + v1)
        v, f, b, slip_f, slip_r, ride = v1, f1, b1, slip_f1, slip_r1, ride1
    whole = way + v * v / (2.0 * a) if a > 0.0 else 0.0
    state = DetailedTwoWheeler.State(v, f, b, s_f, s_r, *ride, way, torque_f, torque_r, a, whole)
    return state, left


def _come_to_rest(
    p: DetailedTwoWheeler.Parameters, x: DetailedTwoWheeler.State, dt: float
) -> DetailedTwoWheeler.State:
    """Return the state after `dt` [s] of the last meters, or of rest: constant deceleration and slips."""
    v, a, ride = x.speed, x.stop_deceleration, ride_of(x)
    braking = min(dt, v / a)
    if braking > 0.0:
        ride = _settled(p, ride, a, (x.front_rim_speed + x.rear_rim_speed) / v, braking)
    if v <= a * dt:
        ride = _settled(p, ride, 0.0, 0.0, dt - braking)
        total = x.stopping_distance
        return DetailedTwoWheeler.State(0.0, 0.0, 0.0, 0.0, 0.0, *ride, total, 0.0, 0.0, a, total)
    v1 = v - a * dt
    keep = v1 / v
    return DetailedTwoWheeler.State(
        v1, x.front_rim_speed * keep, x.rear_rim_speed * keep, x.front_tire_slip, x.rear_tire_slip, *ride,
        x.distance + 0.5 * dt * (v + v1), x.front_torque, x.rear_torque, a, x.stopping_distance,
    )  # fmt: skip # a line for what rolls, a line for the rest


def _settled(p: DetailedTwoWheeler.Parameters, ride: Ride, a: float, rolling: float, dt: float) -> Ride:
    """Return a ride after `dt` [s] at a deceleration a [m/s2]; `rolling` is (w_f + w_r) r/v."""
    suspend, k, r = suspension(p.springs, p.frame), p.frame, p.wheel_radius
    inertia = p.pitch_inertia + k.mass * k.above * (k.above + r)
    momentum = p.wheel_inertia / r * rolling if p.wheel_reaction else 0.0
    given, weight = (p.mass * p.center_height + momentum) * a, k.mass * GRAVITY * k.above

    def rates(ride: Ride) -> RideRates:
        up, pitch, up_f, up_r, _, _ = suspend(ride)
        return RideRates(up, (given + weight * ride[1] + pitch) / inertia, up_f, up_r)  # (D7)

    n = ceil(dt / p.inner_step - 1e-9)
    h = dt / n if n > 0 else 0.0
    for _ in range(n):
        ahead = moved(ride, rates(ride), h)
        ride = between(ride, moved(ahead, rates(ahead), h), 0.5)
    return ride
