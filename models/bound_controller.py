"""BoundController: keeps a scooter below a speed bound and an acceleration bound (the ECU).

Source: Dardanelli et al., "Speed and acceleration controllers for a light electric two-wheeled vehicle",
IEEE CDC-ECC 2011, section IV. Speeds are in km/h, accelerations in m/s2, throttles in %; T_s = dt.

    x' = -x/T + (mu/T) g_e + G1 (v_m - v_e) + G2 eta,  eta' = v_m - v_e,  v_e = x     observer    (5)
    s^2 + (G1 + 1/T) s + G2 = s^2 + 2 zeta w_o s + w_o^2                              gives G1 and G2
    a_e[k] = (v_e[k] - v_e[k-1])/(3.6 T_s)                                            acceleration
    v_m = 3.6 (w_f r_f + w_r r_r)/2, to whole q, or that of the drive                 measured      (C0)
    v_ref = v_e(t_0) + 3.6 * integral of a_b dt from t_0 in ACCELERATION, else v_ref = v_e        (8)
    R_v, R_a = K_p (1 + 1/(s T_i)),  K_p = w_c T/mu                                          (9)-(10)

The observer sees the quantized measurement v_m and the applied throttle g_e. R_a tracks v_ref, with t_0 its
entry; R_v tracks the speed bound v_b. Both are written as one law, with the indicator s = 1 in the state of
the controller and 0 elsewhere, and r = v_ref or v_b:

    e = s (r - v_e),  g_f = s (r - r(t_0))/mu,  u = I + K_p e + g_f                              (C1)
    I' = (K_p/T_i) e + (g_e - u)/T_t                                always                       (C2)

The measured speed v_m comes from the motor drive, which rounds it to 1 km/h, or is formed here of the speeds
of both wheels, (C0), to the same q = 1 km/h; q = 0 does not round. The rider's throttle g_d comes by wire or
over the bus. These are the paper's measured signals; it does not say which unit forms v_m of them.

The supervisor decides once a sample; g_a and g_v are the candidates u of R_a and R_v, g_d is the rider's
throttle, clipped to 0..100 %:

    DRIVER        g_e = g_d:   v_e >= v_b and g_v <= g_d                    -> VELOCITY
                               a_e >= a_b and g_a <= g_d and v_e < v_b      -> ACCELERATION      (C3)
    ACCELERATION  g_e = g_a:   v_e >= v_b and g_a <= g_d                    -> VELOCITY
                               g_a > g_d                                    -> DRIVER            (C4)
    VELOCITY      g_e = g_v:   g_v > g_d                                    -> DRIVER            (C5)

The controller of a new state is evaluated once more, with s = 1. DRIVER can be kept for `dwell_time` after
each entry (the paper's remark against frequent switching).

Deviations: the factor 3.6 in (8) is missing in the paper. (C1) and (C2) are one reading of the anti-windup
and bumpless switching that the paper draws in its Fig. 7 ("Derivations" in docs/systems/scooter.md).
`use_observer = false` is the paper's comparison: v_m in place of v_e, and as a_e its difference through a
first-order low-pass.

published: q = 1 km/h, mu = 0.46, the pole 0.03 Hz, 100 Hz, a bandwidth of 0.3 Hz of the speed loop, the
clipping of g_e to 0..100 %.
inferred: mu is in km/h per %; T = 1/(2 pi 0.03 Hz); the bandwidth is the crossover of R_v, w_c = 2 pi 0.3
rad/s.
chosen: v_m of the drive and g_d by wire, r_f = r_r = 0.2 m, w_o = 1.2 rad/s, zeta = 1, w_c = 1.5 rad/s of R_a
("slightly lower" in the paper), T_i = T, T_t = 10 ms, no dwell time, a low-pass of 0.5 s.

At the edges: at the start the observer is in equilibrium at (v_m, g_e), so that v_e = v_m, and the state is
DRIVER, with its dwell time over. At a constant v the error |v_e - v| ends within 0.5 km/h (the paper's (6)
and (7)); it can be larger in transients. Throttles are equal within 1e-9 %: a tracking integral nears the
rider's constant throttle but need not reach its last bit. `enabled = false` applies the rider's throttle at
all times.

Step: the sample at t_k reads v_e[k], decides g_e[k], and moves the observer on to t_k+1 by the exact solution
of (5) for v_m[k] and g_e[k] held. (C2) becomes I + (T_s K_p/T_i) e + min(1, T_s/T_t) (g_e - u), order 1.
"""

from __future__ import annotations

from enum import IntEnum
from functools import cached_property, lru_cache
from math import cos, cosh, exp, floor, pi, sin, sinh, sqrt
from typing import NamedTuple

from .base import Model, record, var
from .constants import KMH, SAME_TIME

TIME_CONSTANT = 1.0 / (2.0 * pi * 0.03)  # s: that of the published pole at 0.03 Hz
_SPEEDS = ("speed_measured", "front_wheel_speed", "rear_wheel_speed")  # inputs that v_m may come from
SAME_THROTTLE = 1e-9  # %, see the supervisor above


class ControllerState(IntEnum):
    """The one that commands the throttle: the rider or a controller."""

    DRIVER = 0
    ACCELERATION = 1
    VELOCITY = 2


class SpeedSource(IntEnum):
    """The measurement that is taken as v_m."""

    DRIVE = 0
    WHEELS = 1


class ThrottleSource(IntEnum):
    """The way by which the rider's throttle comes."""

    WIRE = 0
    BUS = 1


DRIVER, ACCELERATION, VELOCITY = ControllerState


class BoundController(Model):
    """The rider's throttle in, the applied throttle out: lower where a bound would be exceeded."""

    sampled = True
    initial_inputs = (
        "throttle_request",
        "throttle_position",
        "speed_measured",
        "front_wheel_speed",
        "rear_wheel_speed",
    )

    @record
    class Parameters:
        """Model of the vehicle, tuning and options; the module's docstring marks what is published."""

        gain: float = var(0.46, "km/(h.%)", "Speed per throttle of the vehicle (mu)", min=1e-6)
        time_constant: float = var(TIME_CONSTANT, "s", "Time constant of the vehicle (T)", min=1e-3)
        observer_bandwidth: float = var(1.2, "rad/s", "Natural frequency of the observer (w_o)", min=1e-3)
        observer_damping: float = var(1.0, "1", "Damping of the observer (zeta)", min=0.1)
        speed_bandwidth: float = var(0.6 * pi, "rad/s", "Crossover frequency of R_v (w_c)", min=0.0)
        acceleration_bandwidth: float = var(1.5, "rad/s", "Crossover frequency of R_a (w_c)", min=0.0)
        integral_time: float = var(TIME_CONSTANT, "s", "Integral time of R_v and R_a (T_i)", min=1e-3)
        tracking_time: float = var(
            0.01, "s", "Time in which an idle or clipped integral follows (T_t)", min=1e-6
        )
        dwell_time: float = var(0.0, "s", "Shortest stay in the state driver", min=0.0)
        filter_time: float = var(0.5, "s", "Low-pass of the acceleration without observer", min=1e-3)
        enabled: bool = var(True, "", "Whether the bounds act; if not, the rider's throttle is applied")
        speed_source: SpeedSource = var(SpeedSource.DRIVE, "", "Where the measured speed comes from")
        throttle_source: ThrottleSource = var(ThrottleSource.WIRE, "", "How the rider's throttle comes")
        front_wheel_radius: float = var(0.2, "m", "Rolling radius of the front wheel (r_f)", min=0.01)
        rear_wheel_radius: float = var(0.2, "m", "Rolling radius of the rear wheel (r_r)", min=0.01)
        speed_resolution: float = var(
            1.0, "km/h", "Step of the speed that is formed of the wheels (q); 0: none", min=0.0
        )
        use_observer: bool = var(True, "", "Whether the observer gives the speed; if not, the measurement")

        @cached_property
        def observer_gain(self) -> float:
            """G1 of (5) [1/s]; G2 is w_o^2."""
            return 2.0 * self.observer_damping * self.observer_bandwidth - 1.0 / self.time_constant

        @cached_property
        def speed_gain(self) -> float:
            """K_p of R_v [% per km/h]."""
            return self.speed_bandwidth * self.time_constant / self.gain  # (9)

        @cached_property
        def acceleration_gain(self) -> float:
            """K_p of R_a [% per km/h]."""
            return self.acceleration_bandwidth * self.time_constant / self.gain  # (10)

    @record
    class Inputs:
        """The rider, the measurement, and the bounds."""

        throttle_request: float = var(0.0, "%", "Throttle of the rider (g_d), clipped to 0..100 %")
        speed_measured: float = var(0.0, "km/h", "Measured speed (v_m)", nominal=10.0)
        speed_bound: float = var(30.0, "km/h", "Speed bound (v_b)", nominal=10.0)
        acceleration_bound: float = var(1.0, "m/s2", "Acceleration bound (a_b)")
        throttle_position: float = var(0.0, "%", "Throttle of the rider (g_d), as the bus carries it")
        front_wheel_speed: float = var(0.0, "rad/s", "Speed of the front wheel (w_f)", nominal=50.0)
        rear_wheel_speed: float = var(0.0, "rad/s", "Speed of the rear wheel (w_r)", nominal=50.0)

    @record
    class State:
        """Observer and integrals at the next sample, and the values that this sample outputs."""

        observer_speed: float = var(0.0, "km/h", "Speed of the observer at the next sample (x)")
        observer_offset: float = var(0.0, "km.s/h", "Integral of v_m - v_e at the next sample (eta)")
        speed_integral: float = var(0.0, "%", "Integral of R_v at the next sample (I)")
        acceleration_integral: float = var(0.0, "%", "Integral of R_a at the next sample (I)")
        speed_estimate: float = var(0.0, "km/h", "Estimated speed (v_e)")
        acceleration_estimate: float = var(0.0, "m/s2", "Estimated acceleration (a_e)")
        state: ControllerState = var(DRIVER, "", "Who commands the throttle")
        throttle: float = var(0.0, "%", "Applied throttle (g_e)")
        reference: float = var(0.0, "km/h", "Reference of the active controller (r), or the speed estimate")
        entry_reference: float = var(0.0, "km/h", "Reference at the entry of the state, r(t_0)")
        dwell_left: float = var(0.0, "s", "Time for which driver is kept")

    @record
    class Outputs:
        """The applied throttle and what explains it."""

        throttle: float = var(
            0.0,
            "%",
            "Applied throttle (g_e)",
            min=0.0,
            max=100.0,
            initially=("throttle_request", "throttle_position"),
        )
        state: ControllerState = var(DRIVER, "", "Who commands the throttle", initially=())
        speed_estimate: float = var(0.0, "km/h", "Estimated speed (v_e)", nominal=10.0, initially=_SPEEDS)
        acceleration_estimate: float = var(0.0, "m/s2", "Estimated acceleration (a_e)", initially=())
        speed_reference: float = var(
            0.0,
            "km/h",
            "What the active controller tracks: v_ref, the speed bound, or in driver the estimate",
            nominal=10.0,
            initially=_SPEEDS,
        )

    @staticmethod
    def initial(p: BoundController.Parameters, u: BoundController.Inputs) -> BoundController.State:
        """Return DRIVER, with the observer in equilibrium at the measured speed and the rider's throttle."""
        g, v = _request(p, u), _measured(p, u)
        return BoundController.State(v, _offset(p, v, g), g, g, v, 0.0, DRIVER, g, v, v, 0.0)

    @staticmethod
    def step(
        p: BoundController.Parameters, x: BoundController.State, u: BoundController.Inputs, dt: float
    ) -> BoundController.State:
        """Estimate, decide and apply at t_k, then predict the observer at t_k + dt [s]."""
        v_m = _measured(p, u)
        g_d, v_b, a_b = _request(p, u), u.speed_bound, u.acceleration_bound
        v_e, a_e = _estimate(p, x, v_m, dt)
        active = x.state
        entry = x.entry_reference
        i_a, i_v = x.acceleration_integral, x.speed_integral

        # The candidates of this sample; an idle controller offers its integral.
        e_a = e_v = 0.0
        g_a, g_v = i_a, i_v
        reference = v_e
        if active == ACCELERATION:
            reference = x.reference + KMH * a_b * dt  # (8)
            e_a = reference - v_e
            g_a = i_a + p.acceleration_gain * e_a + (reference - entry) / p.gain  # (C1)
        elif active == VELOCITY:
            reference = v_b
            e_v = v_b - v_e
            g_v = i_v + p.speed_gain * e_v + (v_b - entry) / p.gain  # (C1)

        following = _supervise(p, x, (v_e, a_e), (v_b, a_b), (g_a, g_v, g_d))
        if following != active:
            # A controller that leaves is idle from now on; one that enters has t_0 = t_k, so that g_f = 0.
            e_a = e_v = 0.0
            g_a, g_v = i_a, i_v
            reference = v_e
            if following == VELOCITY:
                reference = v_b
                e_v = v_b - v_e
                g_v = i_v + p.speed_gain * e_v  # (C1)
            entry = reference

        g_e = g_d if following == DRIVER else _clip(g_a if following == ACCELERATION else g_v)
        follow = min(1.0, dt / p.tracking_time)
        i_a += dt * p.acceleration_gain / p.integral_time * e_a + follow * (g_e - g_a)  # (C2)
        i_v += dt * p.speed_gain / p.integral_time * e_v + follow * (g_e - g_v)  # (C2)
        speed, offset = _predict(p, x, v_m, g_e, dt)
        dwell = max(0.0, x.dwell_left - dt)
        if following == DRIVER and active != DRIVER:
            dwell = p.dwell_time
        return BoundController.State(
            speed, offset, i_v, i_a, v_e, a_e, following, g_e, reference, entry, dwell
        )

    @staticmethod
    def outputs(p: BoundController.Parameters, x: BoundController.State) -> BoundController.Outputs:
        """Return the decisions of the last sample."""
        return BoundController.Outputs(
            x.throttle, x.state, x.speed_estimate, x.acceleration_estimate, x.reference
        )


def _clip(throttle: float) -> float:
    return min(100.0, max(0.0, throttle))


def _request(p: BoundController.Parameters, u: BoundController.Inputs) -> float:
    """Return g_d [%]."""
    return _clip(u.throttle_request if p.throttle_source == ThrottleSource.WIRE else u.throttle_position)


def _measured(p: BoundController.Parameters, u: BoundController.Inputs) -> float:
    """Return v_m [km/h]."""
    if p.speed_source == SpeedSource.DRIVE:
        return u.speed_measured
    rolled = u.front_wheel_speed * p.front_wheel_radius + u.rear_wheel_speed * p.rear_wheel_radius
    v, q = KMH * rolled / 2.0, p.speed_resolution  # (C0)
    return q * floor(v / q + 0.5) if q > 0.0 else v


def _estimate(
    p: BoundController.Parameters, x: BoundController.State, v_m: float, dt: float
) -> tuple[float, float]:
    """Return v_e [km/h] and a_e [m/s2] of this sample."""
    if p.use_observer:
        v_e = x.observer_speed
        return v_e, (v_e - x.speed_estimate) / (KMH * dt)
    v_e = v_m
    difference = (v_e - x.speed_estimate) / (KMH * dt)
    passed = 1.0 - exp(-dt / p.filter_time)
    return v_e, x.acceleration_estimate + passed * (difference - x.acceleration_estimate)


def _supervise(
    p: BoundController.Parameters,
    x: BoundController.State,
    estimate: tuple[float, float],
    bound: tuple[float, float],
    throttle: tuple[float, float, float],
) -> ControllerState:
    """Return the state of this sample, from (v_e, a_e), (v_b, a_b) and the candidates (g_a, g_v, g_d)."""
    if not p.enabled:
        return DRIVER
    v_e, a_e = estimate
    v_b, a_b = bound
    g_a, g_v, g_d = throttle
    g_d += SAME_THROTTLE
    if x.state == DRIVER:  # (C3)
        if x.dwell_left > SAME_TIME:
            return DRIVER
        if v_e >= v_b:
            return VELOCITY if g_v <= g_d else DRIVER
        return ACCELERATION if a_e >= a_b and g_a <= g_d else DRIVER
    if x.state == ACCELERATION:  # (C4)
        if g_a > g_d:
            return DRIVER
        return VELOCITY if v_e >= v_b else ACCELERATION
    return DRIVER if g_v > g_d else VELOCITY  # (C5)


class _Transition(NamedTuple):
    """exp(A dt): the decay of the observer's distance from its equilibrium (x, eta) over one step."""

    speed_speed: float
    speed_offset: float
    offset_speed: float
    offset_offset: float


@lru_cache(maxsize=64)
def _transition(w: float, zeta: float, dt: float) -> _Transition:
    """Return exp(A dt) with A = [[-2 zeta w, w^2], [-1, 0]] of (5), for the distance from its equilibrium."""
    decay = exp(-zeta * w * dt)
    turn = w * sqrt(abs(1.0 - zeta * zeta))
    if turn * dt < 1e-9:  # critically damped
        c, s = 1.0, dt
    elif zeta < 1.0:
        c, s = cos(turn * dt), sin(turn * dt) / turn
    else:
        c, s = cosh(turn * dt), sinh(turn * dt) / turn
    # exp(A dt) = decay (c + s (A + zeta w)), because (A + zeta w)^2 = w^2 (zeta^2 - 1).
    return _Transition(decay * (c - s * zeta * w), decay * s * w * w, -decay * s, decay * (c + s * zeta * w))


def _offset(p: BoundController.Parameters, v_m: float, g_e: float) -> float:
    """Return eta [km.s/h] of the equilibrium of (5) at a constant v_m and g_e; its speed is v_m."""
    return (v_m - p.gain * g_e) / (p.time_constant * p.observer_bandwidth**2)


def _predict(
    p: BoundController.Parameters, x: BoundController.State, v_m: float, g_e: float, dt: float
) -> tuple[float, float]:
    """Return x [km/h] and eta [km.s/h] after dt [s] of constant v_m and g_e."""
    phi = _transition(p.observer_bandwidth, p.observer_damping, dt)
    rest = _offset(p, v_m, g_e)
    dx, de = x.observer_speed - v_m, x.observer_offset - rest
    return (  # (5): the distance from the equilibrium decays
        v_m + phi.speed_speed * dx + phi.speed_offset * de,
        rest + phi.offset_speed * dx + phi.offset_offset * de,
    )
