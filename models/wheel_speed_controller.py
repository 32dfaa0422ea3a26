"""WheelSpeedController: torques of two wheels from their speed errors, by two PIDs or one MIMO-PID.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012. Index 1 is the left wheel.

    u_i = K_p E_i + K_d dE_i/dt + K_i integral E_i dt              torques [N.m]             (6), (8)
    E_1 = e_1 + kappa e_2,  E_2 = e_2 + kappa e_1                  combined errors [rad/s]   (7), (8)
    e_i = w_i,ref - w_i                                            wheel speed errors [rad/s]

and as sampled at t_k, where dt is the time since the last sample and dE/dt the backward difference:

    v_i = K_p E_i + I_i + K_d (E_i - E_i[k-1])/dt,   u_i = v_i limited to -+T_max                (C1)
    I_i[k+1] = I_i + K_i E_i dt   unless v_i lies beyond a limit and E_i drives it further       (C2)

Common errors see gains of (1 + kappa), differences of the two wheels gains of (1 - kappa). kappa = 0 is the
PID (6) for each wheel; kappa = 1 would leave the difference of the wheels without control.

Deviations: (8) does not define the cross error; E_i is chosen. (6) prints 1/K_i where (8) prints K_i, which
is used; `reciprocal_integral` is the literal form of (6). K_d is 0, where the paper prints 2500, without a
unit: at 100 Hz that throws the torque from limit to limit ("Derivations" in docs/systems/multi_drive.md).

published: K_p = 1200, K_i = 400; of the motor 247 N.m, gear 10, efficiency 93 %.
inferred: T_max = 247 N.m x 10 x 93 % = 2297.1 N.m at the wheel.
chosen: kappa = 0.5, K_d = 0, conditional integration, that errors are wheel speeds in rad/s and the u_i
torques at the wheels.

At the edges: at the start the integrals hold `initial_torque`, so that a start in equilibrium stays there.
The first sample has no difference: it counts as 0.

Step: the sample at t_k; (C2) is the forward rectangle, order 1 in dt.
"""

from __future__ import annotations

from .base import Model, record, var

TORQUE_LIMIT = 247.0 * 10.0 * 0.93  # N.m: the motor's, through the gear and its efficiency, inferred


class WheelSpeedController(Model):
    """Reference and measured speeds of two wheels in, torque requests at the wheels out."""

    sampled = True

    @record
    class Parameters:
        """Gains and limits; the module's docstring marks what is published."""

        proportional_gain: float = var(1200.0, "N.m.s/rad", "K_p", min=0.0)
        integral_gain: float = var(400.0, "N.m/rad", "K_i", min=1e-6)
        derivative_gain: float = var(0.0, "N.m.s2/rad", "K_d; the printed 2500 fails at 100 Hz", min=0.0)
        coupling: float = var(
            0.5, "1", "Share of the other wheel's error (kappa); 0 is the PID", max=1.0, min=0.0
        )
        reciprocal_integral: bool = var(False, "", "Whether the integral's gain is 1/K_i, as (6) prints it")
        torque_limit: float = var(TORQUE_LIMIT, "N.m", "Largest torque at a wheel (T_max)", min=0.0)
        initial_torque: float = var(0.0, "N.m", "Torque of each wheel at the start")

        @property
        def applied_integral_gain(self) -> float:
            """K_i, or 1/K_i in the literal form of (6) [N.m/rad]."""
            return 1.0 / self.integral_gain if self.reciprocal_integral else self.integral_gain

    @record
    class Inputs:
        """References and measured speeds of the wheels."""

        left_reference: float = var(0.0, "rad/s", "Reference of the left wheel", nominal=10.0)
        right_reference: float = var(0.0, "rad/s", "Reference of the right wheel", nominal=10.0)
        left_wheel_speed: float = var(0.0, "rad/s", "Speed of the left wheel", nominal=10.0)
        right_wheel_speed: float = var(0.0, "rad/s", "Speed of the right wheel", nominal=10.0)

    @record
    class State:
        """Integrals of the next sample, errors and torques of this one."""

        left_integral: float = var(0.0, "N.m", "Integral of the left wheel at the next sample (I_1)")
        right_integral: float = var(0.0, "N.m", "Integral of the right wheel at the next sample (I_2)")
        left_combined: float = var(0.0, "rad/s", "Error of the left wheel with its share (E_1)")
        right_combined: float = var(0.0, "rad/s", "Error of the right wheel with its share (E_2)")
        left_error: float = var(0.0, "rad/s", "Error of the left wheel (e_1)")
        right_error: float = var(0.0, "rad/s", "Error of the right wheel (e_2)")
        left_torque: float = var(0.0, "N.m", "Torque of the left wheel (u_1)")
        right_torque: float = var(0.0, "N.m", "Torque of the right wheel (u_2)")
        started: bool = var(False, "", "Whether there was a sample before, from which to take a difference")

    @record
    class Outputs:
        """The torque requests, and the errors that they come from."""

        left_torque: float = var(0.0, "N.m", "Torque request of the left wheel (u_1)", nominal=1000.0)
        right_torque: float = var(0.0, "N.m", "Torque request of the right wheel (u_2)", nominal=1000.0)
        left_error: float = var(0.0, "rad/s", "Speed error of the left wheel (e_1)")
        right_error: float = var(0.0, "rad/s", "Speed error of the right wheel (e_2)")

    @staticmethod
    def initial(
        p: WheelSpeedController.Parameters, u: WheelSpeedController.Inputs
    ) -> WheelSpeedController.State:
        """Return an equilibrium: no errors, and integrals that give `initial_torque`."""
        torque = _limited(p.initial_torque, p.torque_limit)
        return WheelSpeedController.State(torque, torque, 0.0, 0.0, 0.0, 0.0, torque, torque, False)

    @staticmethod
    def step(
        p: WheelSpeedController.Parameters,
        x: WheelSpeedController.State,
        u: WheelSpeedController.Inputs,
        dt: float,
    ) -> WheelSpeedController.State:
        """Return the torques and the next integrals at t_k, `dt` [s] after the last sample."""
        e_1 = u.left_reference - u.left_wheel_speed
        e_2 = u.right_reference - u.right_wheel_speed
        combined_1 = e_1 + p.coupling * e_2  # (7), (8)
        combined_2 = e_2 + p.coupling * e_1
        i_1, u_1 = _pid(p, x.left_integral, x.left_combined if x.started else combined_1, combined_1, dt)
        i_2, u_2 = _pid(p, x.right_integral, x.right_combined if x.started else combined_2, combined_2, dt)
        return WheelSpeedController.State(i_1, i_2, combined_1, combined_2, e_1, e_2, u_1, u_2, True)

    @staticmethod
    def outputs(
        p: WheelSpeedController.Parameters, x: WheelSpeedController.State
    ) -> WheelSpeedController.Outputs:
        """Return the torques and errors of the last sample."""
        return WheelSpeedController.Outputs(x.left_torque, x.right_torque, x.left_error, x.right_error)


def _pid(
    p: WheelSpeedController.Parameters, integral: float, before: float, error: float, dt: float
) -> tuple[float, float]:
    """Return the integral of the next sample and the torque of this one [N.m]."""
    wanted = p.proportional_gain * error + integral + p.derivative_gain * (error - before) / dt  # (6), (8)
    torque = _limited(wanted, p.torque_limit)  # (C1)
    if wanted == torque or (wanted - torque) * error < 0.0:
        integral += p.applied_integral_gain * error * dt  # (C2)
    return integral, torque


def _limited(torque: float, limit: float) -> float:
    return limit if torque > limit else -limit if torque < -limit else torque
