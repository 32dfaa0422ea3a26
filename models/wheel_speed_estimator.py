"""WheelSpeedEstimator: the speed of a two-wheeler from its wheels alone.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008.

    v_hat = r max(w_f, w_r)                          estimated speed [m/s], w in rad/s           (16)

published: (16).
chosen: r = 0.25 m.

At the edges: the estimate is exact while one wheel rolls freely. With both wheels braked it is too low by the
slip of the faster one; with both locked it is 0. A wheel that turns backward counts as standing. There is no
estimate (0) before the first sample.

Step: the sample at t_k computes (16) from the inputs at t_k; there is no memory and no error.
"""

from __future__ import annotations

from .base import Model, record, var


class WheelSpeedEstimator(Model):
    """Both wheel speeds in, the estimated speed of the vehicle out."""

    sampled = True

    @record
    class Parameters:
        """The wheels."""

        wheel_radius: float = var(0.25, "m", "Rolling radius of both wheels (r)", min=0.01)

    @record
    class Inputs:
        """The speeds that the wheel speed sensors measure."""

        front_wheel_speed: float = var(0.0, "rad/s", "Speed of the front wheel (w_f)", nominal=100.0)
        rear_wheel_speed: float = var(0.0, "rad/s", "Speed of the rear wheel (w_r)", nominal=100.0)

    @record
    class State:
        """The estimate of this sample."""

        speed: float = var(0.0, "m/s", "Estimated speed (v_hat)")

    @record
    class Outputs:
        """The estimate."""

        speed: float = var(0.0, "m/s", "Estimated speed (v_hat)", min=0.0, nominal=10.0)

    @staticmethod
    def initial(
        p: WheelSpeedEstimator.Parameters, u: WheelSpeedEstimator.Inputs
    ) -> WheelSpeedEstimator.State:
        """Return 0: there is no estimate before the first sample."""
        return WheelSpeedEstimator.State(0.0)

    @staticmethod
    def step(
        p: WheelSpeedEstimator.Parameters,
        x: WheelSpeedEstimator.State,
        u: WheelSpeedEstimator.Inputs,
        dt: float,
    ) -> WheelSpeedEstimator.State:
        """Return the estimate at t_k; a wheel that turns backward counts as standing."""
        fastest = max(0.0, u.front_wheel_speed, u.rear_wheel_speed)
        return WheelSpeedEstimator.State(p.wheel_radius * fastest)  # (16)

    @staticmethod
    def outputs(
        p: WheelSpeedEstimator.Parameters, x: WheelSpeedEstimator.State
    ) -> WheelSpeedEstimator.Outputs:
        """Return the last sample's estimate."""
        return WheelSpeedEstimator.Outputs(x.speed)
