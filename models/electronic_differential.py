"""ElectronicDifferential: reference speeds of two driven rear wheels in place of a mechanical differential.

Source: B. Gasbaoui, A. Nasri, "A Novel Multi-Drive Electric Vehicle System Control Based on Multi-Input
Multi-Output PID Controller", Serbian Journal of Electrical Engineering 9(2), 2012.

    R   = L/tan(d)                                              radius of the turn [m]            (9)
    w_1 = (L - (d_w/2) tan(d))/L w_v,   w_2 = (L + (d_w/2) tan(d))/L w_v      [rad/s]       (10)-(12)
    w_v = (w_1 + w_2)/2 = v_ref/R_w                             v_ref in km/h: v_ref/3.6         (13)

w_1 is the left wheel's reference and w_2 the right one's; d > 0 [rad] steers to the left.

Deviations: the labels of two lengths, which the paper's Table 1 swaps, are put right: the wheelbase is
L = 2.5 m and the track d_w = 1.5 m.

published: L = 2.5 m, d_w = 1.5 m, R_w = 0.36 m.
chosen: the stop of the steering, 45 deg.

At the edges: an angle beyond the stop counts as the stop; a stop at which R <= d_w/2 is refused at the start
(`turn_geometry`). A negative v_ref drives backward.

Step: the sample at t_k computes the references from the inputs at t_k; there is no memory and no error.
"""

from __future__ import annotations

from math import pi

from .base import Model, record, var
from .constants import KMH
from .turn_geometry import check_steering, wheel_ratios


class ElectronicDifferential(Model):
    """Speed and steering angle in, reference speeds of the left and the right rear wheel out."""

    sampled = True
    initial_inputs = ("speed_reference", "steering_angle")

    @record
    class Parameters:
        """The car's geometry, published but for the stop."""

        wheelbase: float = var(2.5, "m", "Distance between the axles (L)", min=0.1)
        track: float = var(1.5, "m", "Distance between the rear wheels (d_w)", min=0.1)
        wheel_radius: float = var(0.36, "m", "Radius of the wheels (R_w)", min=0.01)
        steering_limit: float = var(pi / 4.0, "rad", "Stop of the steering", min=0.0, max=1.57)

    @record
    class Inputs:
        """The speed and the angle that the driver requests."""

        speed_reference: float = var(0.0, "km/h", "Speed asked for (v_ref)", nominal=10.0)
        steering_angle: float = var(0.0, "rad", "Angle of the front wheels (d), positive to the left")

    @record
    class State:
        """The references of this sample."""

        left_reference: float = var(0.0, "rad/s", "Reference of the left wheel (w_1)")
        right_reference: float = var(0.0, "rad/s", "Reference of the right wheel (w_2)")

    @record
    class Outputs:
        """The references that the wheel-speed controller holds."""

        left_reference: float = var(0.0, "rad/s", "Reference of the left wheel (w_1)", nominal=10.0)
        right_reference: float = var(0.0, "rad/s", "Reference of the right wheel (w_2)", nominal=10.0)

    @staticmethod
    def initial(
        p: ElectronicDifferential.Parameters, u: ElectronicDifferential.Inputs
    ) -> ElectronicDifferential.State:
        """Return the references of the first inputs. Raises ValueError for a stop that is too far."""
        check_steering(p.wheelbase, p.track, p.steering_limit)
        return ElectronicDifferential.step(p, ElectronicDifferential.State(), u, 0.0)

    @staticmethod
    def step(
        p: ElectronicDifferential.Parameters,
        x: ElectronicDifferential.State,
        u: ElectronicDifferential.Inputs,
        dt: float,
    ) -> ElectronicDifferential.State:
        """Return the references of the inputs at t_k."""
        left, right = wheel_ratios(p.wheelbase, p.track, p.steering_limit, u.steering_angle)  # (9)
        w_v = u.speed_reference / KMH / p.wheel_radius  # (13)
        return ElectronicDifferential.State(left * w_v, right * w_v)  # (10)-(12)

    @staticmethod
    def outputs(
        p: ElectronicDifferential.Parameters, x: ElectronicDifferential.State
    ) -> ElectronicDifferential.Outputs:
        """Return the references of the last sample."""
        return ElectronicDifferential.Outputs(x.left_reference, x.right_reference)
