"""SlipController: keeps the slip of two braked wheels at its set point.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008. T_s = dt.

    lambda_i = (v - w_i r)/v  with the speed v that the controller believes;  0 where v = 0  [1]     (2)
    T_i = k(v) (K_p e_i + K_d e_i') + I_i,  clipped to 0..T_max,  e_i = lambda* - lambda_i   [N.m]  (C1)
    I_i' = k(v) K_i e_i, not where T_i is clipped and e_i drives it further out                     (C2)
    k(v) = clip(v/v_0, k_min, 1)                                                                    (C3)

With K_i = K_d = 0 and k_min = 1, (C1) is the proportional control (9) of the propositions. The strategies of
the paper's Table I:

    KNOWN_SPEED       both wheels by (C1), v the true speed                                          (a)
    ESTIMATED_SPEED   both wheels by (C1), v = v_hat of the wheels                                   (b)
    FRONT_ONLY        front wheel by (C1), v = v_hat; the rear wheel is free and gives v_hat         (c)
    FRONT_COMPENSATED the same, and T_r = -J w_r' on the rear wheel, so that it runs without slip    (d)

One controller has both wheels ("Units" in docs/systems/braking.md). (d) differences w_r over one
sample, and so acts through the same actuator as any torque.

published: lambda* = 0.22 for both wheels, the strategies, a PID for the maneuvers.
chosen: calibrated to Table I, K_p = 3000 N.m, K_i = 25000 N.m/s, K_d = 0, k_min = 0.09, v_0 = 100 km/h,
T_max = 2000 N.m, J = 0.79 kg.m2, r = 0.25 m.

At the edges: both wheels locked is v_hat = 0, and the slip 0/0 counts as 0 ("0/0" in
docs/systems/braking.md). Below 2 m/s of believed speed the torques are held, since lambda' goes as 1/v
(chosen). The first sample has no difference: it counts as 0.

Step: the sample at t_k; e' in (C1) by the backward difference, (C2) by the forward rectangle after T_i is
decided, order 1 in dt.
"""

from __future__ import annotations

from enum import IntEnum
from functools import cached_property

from .base import Model, record, var
from .constants import KMH

TARGET_SLIP = 0.22  # lambda*, published


class Strategy(IntEnum):
    """The strategies of Table I: the wheels that are controlled, and the speed that is believed."""

    KNOWN_SPEED = 0
    ESTIMATED_SPEED = 1
    FRONT_ONLY = 2
    FRONT_COMPENSATED = 3


KNOWN_SPEED, ESTIMATED_SPEED, FRONT_ONLY, FRONT_COMPENSATED = Strategy


class SlipController(Model):
    """Wheel speeds and the vehicle's speed in, brake torques of both wheels out."""

    sampled = True

    @record
    class Parameters:
        """Tuning and strategy; the module's docstring marks what is published."""

        strategy: Strategy = var(KNOWN_SPEED, "", "Which wheels are controlled, and by which speed")
        target_slip: float = var(TARGET_SLIP, "1", "Set point of both wheels (lambda*)", min=0.0, max=1.0)
        proportional_gain: float = var(3000.0, "N.m", "Torque per slip at v_0 (K_p)", min=0.0)
        integral_gain: float = var(25000.0, "N.m/s", "Torque per slip and second at v_0 (K_i)", min=0.0)
        derivative_gain: float = var(0.0, "N.m.s", "Torque per slip rate at v_0 (K_d)", min=0.0)
        schedule_speed: float = var(100.0, "km/h", "Speed of the full gains (v_0)", min=1.0)
        schedule_minimum: float = var(0.09, "1", "Least share of the gains (k_min)", min=0.0, max=1.0)
        maximum_torque: float = var(2000.0, "N.m", "Limit of each torque (T_max)", min=0.0)
        freeze_speed: float = var(2.0, "m/s", "Believed speed below which the torques hold", min=0.0)
        wheel_radius: float = var(0.25, "m", "Rolling radius of both wheels (r)", min=0.01)
        wheel_inertia: float = var(0.79, "kg.m2", "Inertia that (d) compensates (J)", min=0.0)

        @cached_property
        def schedule_slope(self) -> float:
            """1/v_0 [s/m]."""
            return KMH / self.schedule_speed

    @record
    class Inputs:
        """The values of the sensors and of the estimator."""

        front_wheel_speed: float = var(0.0, "rad/s", "Speed of the front wheel (w_f)", nominal=100.0)
        rear_wheel_speed: float = var(0.0, "rad/s", "Speed of the rear wheel (w_r)", nominal=100.0)
        speed: float = var(0.0, "m/s", "True speed of the vehicle (v), which only (a) knows", nominal=10.0)
        speed_estimate: float = var(0.0, "m/s", "Estimated speed (v_hat), for (b), (c), (d)", nominal=10.0)

    @record
    class State:
        """Integrals at the next sample, and the values that this sample outputs."""

        front_integral: float = var(0.0, "N.m", "Integral of the front wheel at the next sample (I_f)")
        rear_integral: float = var(0.0, "N.m", "Integral of the rear wheel at the next sample (I_r)")
        front_torque: float = var(0.0, "N.m", "Torque asked of the front brake (T_f)")
        rear_torque: float = var(0.0, "N.m", "Torque asked of the rear brake (T_r)")
        front_slip: float = var(0.0, "1", "Slip of the front wheel as believed (lambda_f)")
        rear_slip: float = var(0.0, "1", "Slip of the rear wheel as believed (lambda_r)")
        speed: float = var(0.0, "m/s", "Believed speed (v)")
        rear_wheel_speed: float = var(0.0, "rad/s", "Speed of the rear wheel at this sample (w_r)")
        started: bool = var(False, "", "Whether there was a sample")

    @record
    class Outputs:
        """The torques, and the slips and the speed that explain them."""

        front_torque: float = var(0.0, "N.m", "Torque asked of the front brake (T_f)", min=0.0, nominal=100.0)
        rear_torque: float = var(0.0, "N.m", "Torque asked of the rear brake (T_r)", min=0.0, nominal=100.0)
        front_slip_estimate: float = var(0.0, "1", "Slip of the front wheel as believed (lambda_f)")
        rear_slip_estimate: float = var(0.0, "1", "Slip of the rear wheel as believed (lambda_r)")
        believed_speed: float = var(0.0, "m/s", "Speed that the slips are taken from (v)", nominal=10.0)

    @staticmethod
    def initial(p: SlipController.Parameters, u: SlipController.Inputs) -> SlipController.State:
        """Return a state without torque, with empty integrals."""
        return SlipController.State()

    @staticmethod
    def step(
        p: SlipController.Parameters, x: SlipController.State, u: SlipController.Inputs, dt: float
    ) -> SlipController.State:
        """Take the slips at t_k from the believed speed, then compute the torques."""
        v = u.speed if p.strategy == KNOWN_SPEED else u.speed_estimate
        w_f, w_r = u.front_wheel_speed, u.rear_wheel_speed
        slip_f, slip_r = believed_slip(v, w_f * p.wheel_radius), believed_slip(v, w_r * p.wheel_radius)
        i_f, i_r, t_f, t_r = x.front_integral, x.rear_integral, x.front_torque, x.rear_torque
        if v >= p.freeze_speed:
            rate_f = rate_r = acceleration = 0.0
            if x.started:
                rate_f, rate_r = (slip_f - x.front_slip) / dt, (slip_r - x.rear_slip) / dt
                acceleration = (w_r - x.rear_wheel_speed) / dt
            k = min(1.0, max(p.schedule_minimum, v * p.schedule_slope))  # (C3)
            t_f, i_f = _control(p, k, slip_f, rate_f, i_f, dt)
            if p.strategy == FRONT_COMPENSATED:
                t_r = _clip(-p.wheel_inertia * acceleration, p.maximum_torque)  # (d)
            elif p.strategy != FRONT_ONLY:
                t_r, i_r = _control(p, k, slip_r, rate_r, i_r, dt)
        return SlipController.State(i_f, i_r, t_f, t_r, slip_f, slip_r, v, w_r, True)

    @staticmethod
    def outputs(p: SlipController.Parameters, x: SlipController.State) -> SlipController.Outputs:
        """Return the torques of the last sample, with its slips and its speed."""
        return SlipController.Outputs(x.front_torque, x.rear_torque, x.front_slip, x.rear_slip, x.speed)


def believed_slip(v: float, rim: float) -> float:
    """Return the slip [1] for a believed speed and a wheel's circumferential speed [m/s]; 0 where v <= 0."""
    return (v - rim) / v if v > 0.0 else 0.0  # (2)


def _control(
    p: SlipController.Parameters, k: float, slip: float, slip_rate: float, integral: float, dt: float
) -> tuple[float, float]:
    """Return a wheel's torque, and its integral at the next sample [N.m]."""
    e = p.target_slip - slip
    demand = k * (p.proportional_gain * e - p.derivative_gain * slip_rate) + integral  # (C1)
    torque = _clip(demand, p.maximum_torque)
    if not ((demand > torque and e > 0.0) or (demand < torque and e < 0.0)):
        integral += k * p.integral_gain * e * dt  # (C2)
    return torque, integral


def _clip(torque: float, limit: float) -> float:
    return min(limit, max(0.0, torque))
