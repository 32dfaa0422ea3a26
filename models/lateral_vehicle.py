"""LateralVehicle: the lateral motion of a four-wheel-steered vehicle at a constant speed.

Source: "Optimal lane keeping control of a 4WS electric vehicle", section 4.

    x' = A x + B u,   x = (y', theta, w_z, beta) [m/s, rad, rad/s, m],   u = (delta_f, delta_r) [rad]  (B1)

A and B, with their published numbers and the deviations from the paper, are those of `bicycle`.

published: everything but the start.
chosen: the vehicle starts at rest in its lane, x = 0.

At the edges: the model is linear, so that angles of any size are taken as small and the tires' force has no
limit.

Step: x(t + dt) = A_d x + B_d u, the exact solution for steering angles held over the step, so that any step
size gives the same trajectory. A_d and B_d are one matrix exponential for each step size, computed when it is
first used.
"""

from __future__ import annotations

from .base import Model, record, var
from .bicycle import Bicycle


class LateralVehicle(Model):
    """Front and rear steering angles in; lateral velocity, heading, yaw rate and displacement out."""

    @record
    class Parameters(Bicycle):
        """The vehicle, and where it starts."""

        initial_lateral_velocity: float = var(0.0, "m/s", "Lateral velocity at the start")
        initial_heading_angle: float = var(0.0, "rad", "Heading angle at the start")
        initial_yaw_rate: float = var(0.0, "rad/s", "Yaw rate at the start")
        initial_displacement: float = var(0.0, "m", "Displacement at the start")

    @record
    class Inputs:
        """Angles of the road wheels."""

        front_steering_angle: float = var(0.0, "rad", "Front road-wheel angle (delta_f)", nominal=0.1)
        rear_steering_angle: float = var(0.0, "rad", "Rear road-wheel angle (delta_r)", nominal=0.1)

    @record
    class State:
        """x of (B1)."""

        lateral_velocity: float = var(0.0, "m/s", "Lateral velocity (y')")
        heading_angle: float = var(0.0, "rad", "Heading relative to the lane (theta)")
        yaw_rate: float = var(0.0, "rad/s", "Yaw rate (w_z)")
        displacement: float = var(0.0, "m", "Displacement from the lane center (beta)")

    @record
    class Outputs:
        """The four states, all of which are measured."""

        lateral_velocity: float = var(0.0, "m/s", "Lateral velocity (y')")
        heading_angle: float = var(0.0, "rad", "Heading relative to the lane (theta)", nominal=0.1)
        yaw_rate: float = var(0.0, "rad/s", "Yaw rate (w_z)", nominal=0.1)
        displacement: float = var(0.0, "m", "Displacement from the lane center (beta)")

    @staticmethod
    def initial(p: LateralVehicle.Parameters, u: LateralVehicle.Inputs) -> LateralVehicle.State:
        """Return the state that the parameters give."""
        return LateralVehicle.State(
            p.initial_lateral_velocity, p.initial_heading_angle, p.initial_yaw_rate, p.initial_displacement
        )

    @staticmethod
    def step(
        p: LateralVehicle.Parameters, x: LateralVehicle.State, u: LateralVehicle.Inputs, dt: float
    ) -> LateralVehicle.State:
        """Return the state after `dt` [s] of held steering angles."""
        y, th, w, beta = x.lateral_velocity, x.heading_angle, x.yaw_rate, x.displacement
        d_f, d_r = u.front_steering_angle, u.rear_steering_angle
        return LateralVehicle.State(
            *[
                a_y * y + a_th * th + a_w * w + a_beta * beta + b_f * d_f + b_r * d_r
                for a_y, a_th, a_w, a_beta, b_f, b_r in p.transition(dt)  # (B1)
            ]
        )

    @staticmethod
    def outputs(p: LateralVehicle.Parameters, x: LateralVehicle.State) -> LateralVehicle.Outputs:
        """Return the state: all of it is measured."""
        return LateralVehicle.Outputs(x.lateral_velocity, x.heading_angle, x.yaw_rate, x.displacement)
