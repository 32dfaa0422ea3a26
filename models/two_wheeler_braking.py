"""TwoWheelerBraking: a two-wheeler that brakes in a straight line, with the slip of both wheels.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008. SI; forces that brake are positive.

    J w_f' = r F_xf - T_bf,   J w_r' = r F_xr - T_br,   m v' = -F_xf - F_xr - 1/2 rho CdA v^2     (1)
    F_xi = F_zi mu(lambda_i)                                        tire force [N], i = f, r      (2)
    lambda_i = (v - w_i r)/max(v, w_i r),   0 where both are 0      slip [1]                      (3)
    mu(lambda) = th_1 (1 - exp(-lambda th_2)) - lambda th_3         odd; see `road_friction` [1]  (4)
    F_zf = m g l_r/l - (m h/l) v',   F_zr = m g l_f/l + (m h/l) v',   l = l_f + l_r        [N]    (5)
    v' = -(g l_r mu_f + g l_f mu_r + (l/m) 1/2 rho CdA v^2)/(l - h (mu_f - mu_r))     [m/s2]     (S1)
    d' = v                                                          distance [m]

(S1) is (1), (2) and (5), which are linear in v' for given slips, solved for it.

Deviations: the air drag in (1); the max in (3) and the odd mu, for a wheel faster than the vehicle (the paper
has lambda >= 0 only).

published: v_0 = 100 km/h.
chosen: calibrated to the paper's Table I, m = 200 kg, r = 0.25 m, l_f = 0.834 m, l_r = 0.516 m, h = 0.506 m,
J = 0.79 kg.m2 per wheel, CdA = 0.388 m2; rho = 1.2 kg/m3, dry road by Burckhardt's table, g = 9.81
m/s2; `stop_speed` = 1 m/s.

At the edges: w_i >= 0, a locked wheel stands until the road overcomes its brake. F_zi >= 0: where (S1) gives
less, the other wheel carries all the weight. A negative torque counts as 0. From `stop_speed` on the vehicle
keeps its deceleration a and its slips, so that it stands after another v^2/(2 a) ("The end of the stop" in
docs/systems/braking.md); `stopping_distance` is known from then on, and 0 before.

Step: Heun's rule with inner steps of at most 0.2 ms, held torques; shorter where the wheels are so light that
their fastest eigenvalue, r^2 m g mu'(0)/(J v) at v = `stop_speed`, needs it. Order 2 in the inner step.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import ceil, exp
from typing import NamedTuple

from .base import Model, record, var
from .constants import AIR_DENSITY, GRAVITY, KMH
from .road_friction import FRICTION, Road, friction_slope

INNER_STEP = 2e-4  # s, at most
START_SPEED = 100.0  # km/h, published
FREE_ROLL = START_SPEED / KMH  # m/s
WHEEL_RADIUS = 0.25  # m

Rates = Callable[[float, float, float], tuple[float, float, float]]


class TwoWheelerBraking(Model):
    """Brake torques in; speed, slips, forces, loads and the stopping distance out."""

    @record
    class Parameters:
        """Vehicle, road and start; the module's docstring marks what is published."""

        road: Road = var(Road.DRY, "", "What the tires roll on")
        initial_speed: float = var(START_SPEED, "km/h", "Speed at the start, wheels rolling freely", min=0.0)
        stop_speed: float = var(1.0, "m/s", "Speed from which slips and deceleration are kept", min=0.1)
        mass: float = var(200.0, "kg", "Vehicle and rider (m)", min=1.0)
        wheel_radius: float = var(WHEEL_RADIUS, "m", "Rolling radius of both wheels (r)", min=0.01)
        wheel_inertia: float = var(0.79, "kg.m2", "Inertia of each wheel (J)", min=1e-3)
        front_distance: float = var(0.834, "m", "Center of mass to the front axle (l_f)", min=0.01)
        rear_distance: float = var(0.516, "m", "Center of mass to the rear axle (l_r)", min=0.01)
        center_height: float = var(0.506, "m", "Height of the center of mass (h)", min=0.0)
        drag_area: float = var(0.388, "m2", "Drag coefficient times frontal area (CdA)", min=0.0)
        air_density: float = var(AIR_DENSITY, "kg/m3", "Density of the air (rho)", min=0.0)

        @cached_property
        def wheelbase(self) -> float:
            """l of (5) [m]."""
            return self.front_distance + self.rear_distance

        @cached_property
        def front_weight(self) -> float:
            """F_zf at rest [N], (5)."""
            return self.mass * GRAVITY * self.rear_distance / self.wheelbase

        @cached_property
        def rear_weight(self) -> float:
            """F_zr at rest [N], (5)."""
            return self.mass * GRAVITY * self.front_distance / self.wheelbase

        @cached_property
        def load_transfer(self) -> float:
            """(m h/l) of (5) [kg]."""
            return self.mass * self.center_height / self.wheelbase

        @cached_property
        def inner_step(self) -> float:
            """The longest inner step [s]."""
            slope = friction_slope(self.road, 0.0)
            weight = self.mass * GRAVITY
            fastest = self.wheel_radius**2 * weight * slope / (self.wheel_inertia * self.stop_speed)
            return min(INNER_STEP, 1.0 / fastest)

        @cached_property
        def rates(self) -> Rates:
            """The right side of (1) for these parameters, the function of `_rates`."""
            return _rates(self)

    @record
    class Inputs:
        """The torques of the brakes."""

        front_torque: float = var(0.0, "N.m", "Front brake torque; negative counts as 0", nominal=100.0)
        rear_torque: float = var(0.0, "N.m", "Rear brake torque; negative counts as 0", nominal=100.0)

    @record
    class State:
        """Motion, and the end of the stop."""

        speed: float = var(0.0, "m/s", "Speed (v)", min=0.0)
        front_rim_speed: float = var(0.0, "m/s", "Circumferential speed of the front wheel (w_f r)", min=0.0)
        rear_rim_speed: float = var(0.0, "m/s", "Circumferential speed of the rear wheel (w_r r)", min=0.0)
        distance: float = var(0.0, "m", "Distance travelled (d)", min=0.0)
        stop_deceleration: float = var(0.0, "m/s2", "Deceleration kept at the end; 0 before", min=0.0)
        stopping_distance: float = var(0.0, "m", "Stopping distance; 0 before it is known", min=0.0)

    @record
    class Outputs:
        """The quantities measured on vehicle and bench; the starts are those of a free roll at 100 km/h."""

        speed: float = var(FREE_ROLL, "m/s", "Speed (v)", min=0.0, nominal=10.0)
        deceleration: float = var(0.8981481481481483, "m/s2", "Deceleration (-v')", nominal=10.0)
        distance: float = var(0.0, "m", "Distance travelled (d)", min=0.0, nominal=10.0)
        stopping_distance: float = var(
            0.0, "m", "Distance from the start to standstill; 0 before it is known", min=0.0, nominal=10.0
        )
        front_wheel_speed: float = var(
            FREE_ROLL / WHEEL_RADIUS, "rad/s", "Front wheel speed (w_f)", min=0.0, nominal=100.0
        )
        rear_wheel_speed: float = var(
            FREE_ROLL / WHEEL_RADIUS, "rad/s", "Rear wheel speed (w_r)", min=0.0, nominal=100.0
        )
        front_rim_speed: float = var(
            FREE_ROLL, "m/s", "Circumferential speed of the front wheel (w_f r)", min=0.0, nominal=10.0
        )
        rear_rim_speed: float = var(
            FREE_ROLL, "m/s", "Circumferential speed of the rear wheel (w_r r)", min=0.0, nominal=10.0
        )
        front_slip: float = var(0.0, "1", "Slip of the front wheel (lambda_f)", min=-1.0, max=1.0)
        rear_slip: float = var(0.0, "1", "Slip of the rear wheel (lambda_r)", min=-1.0, max=1.0)
        front_force: float = var(0.0, "N", "Braking force of the front tire (F_xf)", nominal=1000.0)
        rear_force: float = var(0.0, "N", "Braking force of the rear tire (F_xr)", nominal=1000.0)
        front_load: float = var(
            817.2478463648833, "N", "Load of the front tire (F_zf)", min=0.0, nominal=1000.0
        )
        rear_load: float = var(
            1144.7521536351167, "N", "Load of the rear tire (F_zr)", min=0.0, nominal=1000.0
        )

    @staticmethod
    def initial(p: TwoWheelerBraking.Parameters, u: TwoWheelerBraking.Inputs) -> TwoWheelerBraking.State:
        """Return free rolling at `initial_speed`. Raises ValueError where that is not above `stop_speed`."""
        v = p.initial_speed / KMH
        if v <= p.stop_speed:
            raise ValueError(
                f"initial_speed = {p.initial_speed} km/h must be above stop_speed = {p.stop_speed} m/s "
                f"({p.stop_speed * KMH} km/h), below which nothing is computed"
            )
        return TwoWheelerBraking.State(v, v, v, 0.0, 0.0, 0.0)

    @staticmethod
    def step(
        p: TwoWheelerBraking.Parameters,
        x: TwoWheelerBraking.State,
        u: TwoWheelerBraking.Inputs,
        dt: float,
    ) -> TwoWheelerBraking.State:
        """Return the state after `dt` [s] of held torques."""
        if x.stop_deceleration > 0.0:
            return _come_to_rest(x, dt)
        n = ceil(dt / p.inner_step - 1e-9)
        m = _integrate(p, x, max(0.0, u.front_torque), max(0.0, u.rear_torque), dt / n, n)
        if m.speed > p.stop_speed:
            return TwoWheelerBraking.State(m.speed, m.front, m.rear, x.distance + m.way, 0.0, 0.0)
        there = x.distance + m.way
        total = there + m.speed * m.speed / (2.0 * m.deceleration)
        slow = TwoWheelerBraking.State(m.speed, m.front, m.rear, there, m.deceleration, total)
        return _come_to_rest(slow, m.left)

    @staticmethod
    def outputs(p: TwoWheelerBraking.Parameters, x: TwoWheelerBraking.State) -> TwoWheelerBraking.Outputs:
        """Return the quantities measured at this instant."""
        v, rim_f, rim_r = x.speed, x.front_rim_speed, x.rear_rim_speed
        a, force_f, force_r = p.rates(v, rim_f, rim_r)
        if x.stop_deceleration > 0.0:
            a = -x.stop_deceleration if v > 0.0 else 0.0
        load_f, load_r = loads(p, a)
        return TwoWheelerBraking.Outputs(
            v,
            -a,
            x.distance,
            x.stopping_distance,
            rim_f / p.wheel_radius,
            rim_r / p.wheel_radius,
            rim_f,
            rim_r,
            slip(v, rim_f),
            slip(v, rim_r),
            force_f,
            force_r,
            load_f,
            load_r,
        )


def slip(v: float, rim: float) -> float:
    """Return the slip in [-1, 1] for a vehicle speed and a wheel's circumferential speed [m/s], both >= 0."""
    fastest = max(v, rim)
    return (v - rim) / fastest if fastest > 0.0 else 0.0  # (3)


def loads(p: TwoWheelerBraking.Parameters, acceleration: float) -> tuple[float, float]:
    """Return F_zf and F_zr [N] at v' [m/s2]; a wheel in the air leaves the whole weight to the other."""
    weight = p.mass * GRAVITY
    front = min(weight, max(0.0, p.front_weight - p.load_transfer * acceleration))  # (5)
    return front, weight - front


def _rates(p: TwoWheelerBraking.Parameters) -> Rates:
    """Return the function (v, w_f r, w_r r) [m/s] -> (v' [m/s2], F_xf, F_xr [N]), by (2)-(5) and (S1).

    It is called a hundred times a step of 10 ms: (3) and (4) stand in it twice instead of in a function, and
    its constants are bound once for a set of parameters.
    """
    th_1, th_2, th_3 = FRICTION[p.road]
    m, k, drag = p.mass, p.load_transfer, 0.5 * p.air_density * p.drag_area
    weight, weight_f, weight_r = p.mass * GRAVITY, p.front_weight, p.rear_weight

    def rates(v: float, rim_f: float, rim_r: float) -> tuple[float, float, float]:
        if rim_f <= v:
            x = (v - rim_f) / v if v > 0.0 else 0.0  # (3)
            mu_f = th_1 * (1.0 - exp(-th_2 * x)) - th_3 * x  # (4)
        else:
            x = (rim_f - v) / rim_f
            mu_f = th_3 * x - th_1 * (1.0 - exp(-th_2 * x))
        if rim_r <= v:
            x = (v - rim_r) / v if v > 0.0 else 0.0
            mu_r = th_1 * (1.0 - exp(-th_2 * x)) - th_3 * x
        else:
            x = (rim_r - v) / rim_r
            mu_r = th_3 * x - th_1 * (1.0 - exp(-th_2 * x))
        air = drag * v * v
        inertia = m - k * (mu_f - mu_r)
        if inertia > 0.0:
            a = -(weight_f * mu_f + weight_r * mu_r + air) / inertia  # (S1)
            load_f, load_r = weight_f - k * a, weight_r + k * a  # (5)
            if load_f >= 0.0 and load_r >= 0.0:
                return a, load_f * mu_f, load_r * mu_r  # (2)
            if load_f < 0.0:
                force = weight * mu_r
                return -(force + air) / m, 0.0, force
        force = weight * mu_f  # the rear wheel is in the air
        return -(force + air) / m, force, 0.0

    return rates


class _Motion(NamedTuple):
    """Speeds [m/s], distance [m], last deceleration [m/s2] and time left [s] after some inner steps."""

    speed: float
    front: float
    rear: float
    way: float
    deceleration: float
    left: float


def _integrate(
    p: TwoWheelerBraking.Parameters,
    x: TwoWheelerBraking.State,
    torque_f: float,
    torque_r: float,
    h: float,
    n: int,
) -> _Motion:
    """Return the motion after n Heun steps of h [s] of (1), or as many as it takes down to `stop_speed`."""
    rates, stop, r = p.rates, p.stop_speed, p.wheel_radius
    force_rate = h * r * r / p.wheel_inertia  # of w r, per N
    brake_f, brake_r = h * r * torque_f / p.wheel_inertia, h * r * torque_r / p.wheel_inertia
    v, f, b, way = x.speed, x.front_rim_speed, x.rear_rim_speed, 0.0
    for k in range(n):
        a, force_f, force_r = rates(v, f, b)
        f1 = f + force_rate * force_f - brake_f  # (1), Heun's predictor
        b1 = b + force_rate * force_r - brake_r
        a1, force_f1, force_r1 = rates(v + h * a, f1 if f1 > 0.0 else 0.0, b1 if b1 > 0.0 else 0.0)
        f += 0.5 * force_rate * (force_f + force_f1) - brake_f
        b += 0.5 * force_rate * (force_r + force_r1) - brake_r
        if f < 0.0:
            f = 0.0
        if b < 0.0:
            b = 0.0
        change = 0.5 * h * (a + a1)
        v1 = v + change
        if v1 <= stop:
            share = (v - stop) / (v - v1)
            way += 0.5 * share * h * (v + stop)
            return _Motion(stop, f * stop / v1, b * stop / v1, way, -change / h, h * (n - k - share))
        way += 0.5 * h * (v + v1)
        v = v1
    return _Motion(v, f, b, way, 0.0, 0.0)


def _come_to_rest(x: TwoWheelerBraking.State, dt: float) -> TwoWheelerBraking.State:
    """Return the state after `dt` [s] of the last meters: constant deceleration and slips."""
    v, a = x.speed, x.stop_deceleration
    if v <= a * dt:
        return TwoWheelerBraking.State(0.0, 0.0, 0.0, x.stopping_distance, a, x.stopping_distance)
    v1 = v - a * dt
    way = x.distance + 0.5 * dt * (v + v1)
    keep = v1 / v
    return TwoWheelerBraking.State(
        v1, x.front_rim_speed * keep, x.rear_rim_speed * keep, way, a, x.stopping_distance
    )
