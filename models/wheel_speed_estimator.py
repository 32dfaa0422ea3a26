"""WheelSpeedEstimator: the speed of a two-wheeler from its wheels alone.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008.

    v_hat = r max(w_f, w_r)                                                                          (16)

published: (16). chosen: r = 0.25 m. It is exact while one wheel rolls freely. Brake both, and it is as wrong
as the slower loss of speed: with both wheels locked it is 0, and that is what it says.
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
        """What the wheel speed sensors measure."""

        front_wheel_speed: float = var(0.0, "rad/s", "Speed of the front wheel (w_f)", nominal=100.0)
        rear_wheel_speed: float = var(0.0, "rad/s", "Speed of the rear wheel (w_r)", nominal=100.0)

    @record
    class State:
        """What this sample shows."""

        speed: float = var(0.0, "m/s", "Estimated speed (v_hat)")

    @record
    class Outputs:
        """The estimate."""

        speed: float = var(0.0, "m/s", "Estimated speed (v_hat)", min=0.0, nominal=10.0)

    @staticmethod
    def initial(
        p: WheelSpeedEstimator.Parameters, u: WheelSpeedEstimator.Inputs
    ) -> WheelSpeedEstimator.State:
        """No estimate before the first sample."""
        return WheelSpeedEstimator.State(0.0)

    @staticmethod
    def step(
        p: WheelSpeedEstimator.Parameters,
        x: WheelSpeedEstimator.State,
        u: WheelSpeedEstimator.Inputs,
        dt: float,
    ) -> WheelSpeedEstimator.State:
        """The estimate of this sample; a wheel that turns backward counts as standing."""
        fastest = max(0.0, u.front_wheel_speed, u.rear_wheel_speed)
        return WheelSpeedEstimator.State(p.wheel_radius * fastest)  # (16)

    @staticmethod
    def outputs(
        p: WheelSpeedEstimator.Parameters, x: WheelSpeedEstimator.State
    ) -> WheelSpeedEstimator.Outputs:
        """The last sample's estimate."""
        return WheelSpeedEstimator.Outputs(x.speed)
