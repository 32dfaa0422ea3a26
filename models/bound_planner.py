"""BoundPlanner: the speed bound and the acceleration bound of the ECU, from time and estimated speed.

Source: Dardanelli et al., "Speed and acceleration controllers for a light electric two-wheeled vehicle",
IEEE CDC-ECC 2011, section V, which describes the bounds of its Fig. 9 in words.

    a_b = max(a_min, a_0 - k v_e)                    acceleration bound [m/s2], v_e in km/h      (P1)
    v_b = max(0, v_0 + v_1 sin(2 pi t/P))            speed bound [km/h]                          (P2)

Deviations: the formulas are chosen. The paper says "monotonically decreasing" in the estimated speed of a_b
and "slowly varying" of v_b.

published: a_0 = 1 m/s2, v_0 = 30 km/h with k = v_1 = 0 (Fig. 8), the defaults.
chosen: a_min = 0; and for Fig. 9 a_min = 0.3 m/s2, a_0 = 2.5 m/s2, k = 0.05 m/s2 per km/h, v_0 = 38 km/h,
v_1 = 6 km/h, P = 60 s.

At the edges: neither bound falls below 0. At the start the bounds are those of the first inputs.

Step: the sample at t_k computes (P1) and (P2) from the inputs at t_k; there is no memory and no error.
"""

from __future__ import annotations

from math import pi, sin

from .base import Model, record, time, var


class BoundPlanner(Model):
    """Estimated speed and time in, bounds out."""

    sampled = True
    initial_inputs = ("time", "speed_estimate")

    @record
    class Parameters:
        """The two laws; the defaults are the paper's constant bounds."""

        acceleration_at_rest: float = var(1.0, "m/s2", "Acceleration bound at standstill (a_0)", min=0.0)
        acceleration_slope: float = var(0.0, "m.h/(s2.km)", "Its decrease with the speed (k)", min=0.0)
        acceleration_minimum: float = var(0.0, "m/s2", "Lowest acceleration bound (a_min)", min=0.0)
        speed_mean: float = var(30.0, "km/h", "Mean speed bound (v_0)", min=0.0)
        speed_amplitude: float = var(0.0, "km/h", "Amplitude of the speed bound (v_1)", min=0.0)
        period: float = var(60.0, "s", "Period of the speed bound (P)", min=1e-3)

    @record
    class Inputs:
        """The quantities that the bounds depend on."""

        time: float = time()
        speed_estimate: float = var(0.0, "km/h", "Estimated speed (v_e)", nominal=10.0)

    @record
    class State:
        """The bounds of this sample."""

        speed_bound: float = var(30.0, "km/h", "Speed bound (v_b)", min=0.0)
        acceleration_bound: float = var(1.0, "m/s2", "Acceleration bound (a_b)", min=0.0)

    @record
    class Outputs:
        """The bounds of this sample."""

        speed_bound: float = var(
            30.0, "km/h", "Speed bound (v_b)", min=0.0, nominal=10.0, initially=("time",)
        )
        acceleration_bound: float = var(
            1.0, "m/s2", "Acceleration bound (a_b)", min=0.0, initially=("speed_estimate",)
        )

    @staticmethod
    def initial(p: BoundPlanner.Parameters, u: BoundPlanner.Inputs) -> BoundPlanner.State:
        """Return the bounds of the first inputs."""
        return _bounds(p, u)

    @staticmethod
    def step(
        p: BoundPlanner.Parameters, x: BoundPlanner.State, u: BoundPlanner.Inputs, dt: float
    ) -> BoundPlanner.State:
        """Return the bounds of the inputs at t_k."""
        return _bounds(p, u)

    @staticmethod
    def outputs(p: BoundPlanner.Parameters, x: BoundPlanner.State) -> BoundPlanner.Outputs:
        """Return the bounds of the last sample."""
        return BoundPlanner.Outputs(x.speed_bound, x.acceleration_bound)


def _bounds(p: BoundPlanner.Parameters, u: BoundPlanner.Inputs) -> BoundPlanner.State:
    falling = p.acceleration_at_rest - p.acceleration_slope * u.speed_estimate
    a_b = max(p.acceleration_minimum, falling)  # (P1)
    v_b = max(0.0, p.speed_mean + p.speed_amplitude * sin(2.0 * pi * u.time / p.period))  # (P2)
    return BoundPlanner.State(v_b, a_b)
