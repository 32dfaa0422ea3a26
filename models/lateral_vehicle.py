"""LateralVehicle: the lateral motion of a four-wheel-steered vehicle at a constant speed.

Source: a paper on optimal lane keeping control of a 4WS electric vehicle (title and authors are not known),
section 4.

    x' = A x + B u + E d,   x = (y', theta, w_z, beta) [m/s, rad, rad/s, m],   u = (delta_f, delta_r)     (B1)
    d = (F, M) [N, N.m],   E d = (F/m, 0, M/J_z, 0)               disturbances: side force, yaw moment  (V1)
    F = 1/2 rho S tau (v_x^2 + w^2),  tau = arctan(w/v_x)         crosswind w [m/s], at l_w before the    (V2)
    M = l_w F + s (b/2) f m g l_2/(2 (l_1 + l_2))                 ... center, and drag of a blown tire    (V3)
    C_f (1 - abs(s) (1 - k)/2) in place of C_f                    mean of its axle with a blown tire      (V4)

A and B, with their published numbers and the deviations from the paper, are those of `bicycle`. Crosswind and
blow-out of a front tire are why the paper wants the control, but it has no equations of them: (V1) to (V4)
are chosen.

published: everything but the start and the disturbances.
chosen: the vehicle starts at rest in its lane, x = 0; rho = 1.2 kg/m3, S = 4.5 m2 (side force per angle of
attack, of a sedan with 2 m2 of frontal area), l_w = 0.4 m, k = 0.25, f = 0.3 (some 30 times that of a sound
tire), b = 1.5 m. By default there is neither wind nor blow-out.

At the edges: the model is linear, so that angles of any size are taken as small and the tires' force has no
limit. The wind is that over ground: the vehicle's own lateral velocity and heading are small beside it. The
speed stays constant: the drag of a blown tire turns the vehicle and does not brake it.

Step: x(t + dt) = A_d x + B_d u + E_d d, the exact solution for inputs held over the step, so that any step
size gives the same trajectory. The matrices are one exponential for each step size and loss of stiffness,
computed when it is first used; the last 64 are kept.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from math import atan2

from .base import Model, record, var
from .bicycle import Bicycle, Rows, discretized, input_matrix, state_matrix
from .constants import AIR_DENSITY, GRAVITY


class LateralVehicle(Model):
    """Front and rear steering angles in; lateral velocity, heading, yaw rate and displacement out."""

    @record
    class Parameters(Bicycle):
        """The vehicle, where it starts, and what wind and a blown tire do to it."""

        initial_lateral_velocity: float = var(0.0, "m/s", "Lateral velocity at the start")
        initial_heading_angle: float = var(0.0, "rad", "Heading angle at the start")
        initial_yaw_rate: float = var(0.0, "rad/s", "Yaw rate at the start")
        initial_displacement: float = var(0.0, "m", "Displacement at the start")
        air_density: float = var(AIR_DENSITY, "kg/m3", "Density of the air", min=0.0)
        side_area: float = var(4.5, "m2/rad", "Side force of the wind per pressure and angle (S)", min=0.0)
        wind_distance: float = var(0.4, "m", "Center of gravity to the point where the wind acts (l_w)")
        blown_stiffness: float = var(
            0.25, "1", "Part of its cornering stiffness that a blown tire keeps (k)", min=0.0, max=1.0
        )
        blown_resistance: float = var(0.3, "1", "Rolling resistance of a blown tire (f)", min=0.0)
        track: float = var(1.5, "m", "Between the front wheels (b)", min=0.0)

        @cached_property
        def blown_moment(self) -> float:
            """Yaw moment [N.m] of a blown left tire, the second part of (V3)."""
            wheelbase = self.front_axle_distance + self.rear_axle_distance
            load = self.mass * GRAVITY * self.rear_axle_distance / (2.0 * wheelbase)
            return 0.5 * self.track * self.blown_resistance * load  # (V3)

    @record
    class Inputs:
        """Angles of the road wheels, and what disturbs the vehicle; by default nothing does."""

        front_steering_angle: float = var(0.0, "rad", "Front road-wheel angle (delta_f)", nominal=0.1)
        rear_steering_angle: float = var(0.0, "rad", "Rear road-wheel angle (delta_r)", nominal=0.1)
        crosswind: float = var(0.0, "m/s", "Wind across the lane, positive to the left (w)", nominal=10.0)
        front_blowout: float = var(
            0.0, "1", "Front tire blown out (s): 0 none, 1 the left one, -1 the right one", min=-1.0, max=1.0
        )

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
        """Return the state after `dt` [s] of held inputs."""
        force, moment, blown = 0.0, 0.0, 0.0
        if u.crosswind != 0.0 or u.front_blowout != 0.0:
            side = min(1.0, max(-1.0, u.front_blowout))
            force, blown = _wind_force(p, u.crosswind), abs(side)
            moment = p.wind_distance * force + side * p.blown_moment  # (V3)
        y, th, w, beta = transition(p, dt, blown)
        return LateralVehicle.State(
            _moved(y, x, u, force, moment),
            _moved(th, x, u, force, moment),
            _moved(w, x, u, force, moment),
            _moved(beta, x, u, force, moment),
        )

    @staticmethod
    def outputs(p: LateralVehicle.Parameters, x: LateralVehicle.State) -> LateralVehicle.Outputs:
        """Return the state: all of it is measured."""
        return LateralVehicle.Outputs(x.lateral_velocity, x.heading_angle, x.yaw_rate, x.displacement)


def _wind_force(p: LateralVehicle.Parameters, w: float) -> float:
    """Return the side force [N] of a crosswind w [m/s]."""
    attack = atan2(w, p.speed)
    return 0.5 * p.air_density * p.side_area * attack * (p.speed * p.speed + w * w)  # (V2)


@lru_cache(maxsize=64)
def transition(p: LateralVehicle.Parameters, dt: float, blown: float) -> Rows:
    """Return the rows of (A_d, B_d, E_d), 4 x 8, over dt [s] with abs(s) = `blown`."""
    front = p.front_cornering_stiffness * (1.0 - 0.5 * blown * (1.0 - p.blown_stiffness))  # (V4)
    (b11, b12), (b21, b22), (b31, b32), (b41, b42) = input_matrix(p, front)
    disturbed = (
        (b11, b12, 1.0 / p.mass, 0.0),
        (b21, b22, 0.0, 0.0),
        (b31, b32, 0.0, 1.0 / p.yaw_inertia),
        (b41, b42, 0.0, 0.0),
    )  # (V1)
    return discretized(state_matrix(p, front), disturbed, dt)


def _moved(
    row: tuple[float, ...], x: LateralVehicle.State, u: LateralVehicle.Inputs, force: float, moment: float
) -> float:
    """Return the value of one state after the step, from its row of (A_d, B_d, E_d)."""
    a_y, a_th, a_w, a_beta, b_f, b_r, e_f, e_m = row
    free = a_y * x.lateral_velocity + a_th * x.heading_angle + a_w * x.yaw_rate + a_beta * x.displacement
    steered = free + b_f * u.front_steering_angle + b_r * u.rear_steering_angle
    return steered + e_f * force + e_m * moment  # (B1)
