"""Rider: follows a speed reference with throttle and brake, or turns the grip as told; counts what is missed.

Source: chosen. The paper (Dardanelli et al., IEEE CDC-ECC 2011) has a human rider. Speeds are in km/h.

    u = K_p e + I + K_v v_r,   e = v_r - v                      pedal demand [%]                  (R1)
    I' = (K_p/T_i) e, except where that pushes u further past a pedal's end                       (R2)
    u > 0:     throttle = min(u, 100), no brake                                                   (R3)
    u < -u_c:  brake = min(K_b (-u - u_c), F_max) [N], no throttle; between, it coasts            (R4)
    v_r = 0 and v < v_s:  stopped. Throttle 0, brake F_s, I = 0, until v_r > 0                    (R5)
    d_r' = v_r/3.6                                              distance of the reference [m]     (R6)
    d_m' = max(0, e - b)/3.6,  t_m' = 1 where e > b             distance [m] and time [s] missed  (R7)
    throttle = min(max(g, 0), 100), no brake                    where `follows` is false          (R8)

K_v is the throttle that a speed needs in steady state. (R4) leaves a band without either pedal, so that
throttle and brake do not alternate. (R2) stops the integral in saturation, so that a reference out of reach
leaves nothing to unwind. e > b means slower than the cycle's tolerance allows. (R7) counts only what is
missed; a vehicle that is too fast misses nothing. (R8) is a rider who turns the grip to the given position g
[%] whatever the speed.

published: nothing.
chosen: K_p = 20 % per km/h, T_i = 4 s, K_v = 0.8 % per km/h, u_c = 5 %, K_b = 8.5 N per % (braking then
answers like the scooter's full drive force of 850 N), F_max = 1500 N, v_s = 0.5 km/h, F_s = 600 N (holds a
200 kg vehicle on a slope of 30 %), b = 3.2 km/h (2 mph, the legal band of the UDDS).

At the edges: a reference below 0 counts as 0. At the start no pedal is pressed and the integral is 0.

Step: the sample at t_k takes u with the integral so far, then adds to the integrals of (R2), (R6) and (R7) by
explicit Euler, order 1 in dt.
"""

from __future__ import annotations

from .base import Model, record, var
from .constants import KMH


class Rider(Model):
    """Speed reference and speed in; throttle, brake and the shortfall out."""

    sampled = True
    initial_inputs = ("speed_reference", "speed")

    @record
    class Parameters:
        """The rider's reactions; all chosen."""

        proportional_gain: float = var(20.0, "%.h/km", "Pedal per speed error (K_p)", min=0.0)
        integral_time: float = var(4.0, "s", "Integral time (T_i)", min=1e-3)
        speed_feedforward: float = var(0.8, "%.h/km", "Throttle that a speed needs (K_v)", min=0.0)
        coasting_band: float = var(5.0, "%", "Negative demand without brake (u_c)", min=0.0)
        brake_gain: float = var(8.5, "N/%", "Brake force per demand (K_b)", min=1e-3)
        maximum_brake_force: float = var(1500.0, "N", "Strongest braking (F_max)", min=0.0)
        standstill_speed: float = var(0.5, "km/h", "Speed below which the rider stops (v_s)", min=0.0)
        standstill_brake_force: float = var(600.0, "N", "Brake while stopped (F_s)", min=0.0)
        follows: bool = var(True, "", "Whether the speed is followed; if not, the grip's position is given")
        tolerance: float = var(3.2, "km/h", "Speed error that counts as followed (b)", min=0.0)

    @record
    class Inputs:
        """The cycle and the speedometer."""

        speed_reference: float = var(0.0, "km/h", "Speed to follow (v_r)", nominal=10.0)
        speed: float = var(0.0, "km/h", "Speed of the vehicle (v)", nominal=10.0)
        grip: float = var(0.0, "%", "Position of the grip (g) where no speed is followed", nominal=10.0)

    @record
    class State:
        """Integrals, and the values that this sample outputs."""

        integral: float = var(0.0, "%", "Integral of the PI law (I)")
        distance_reference: float = var(0.0, "m", "Distance of the reference (d_r)", min=0.0)
        distance_missed: float = var(0.0, "m", "Distance lost beyond the tolerance (d_m)", min=0.0)
        time_missed: float = var(0.0, "s", "Time beyond the tolerance (t_m)", min=0.0)
        throttle: float = var(0.0, "%", "Throttle", min=0.0, max=100.0)
        brake_force: float = var(0.0, "N", "Force of the brakes", min=0.0)
        speed_error: float = var(0.0, "km/h", "Reference minus speed (e)")

    @record
    class Outputs:
        """The two pedals, and the shortfall against the cycle."""

        throttle: float = var(0.0, "%", "Throttle", min=0.0, max=100.0, nominal=10.0, initially=())
        brake_force: float = var(0.0, "N", "Force of the brakes", min=0.0, nominal=100.0, initially=())
        speed_error: float = var(0.0, "km/h", "Reference minus speed")
        distance_reference: float = var(
            0.0, "m", "Distance of the reference", min=0.0, nominal=100.0, initially=()
        )
        distance_missed: float = var(
            0.0, "m", "Distance lost while slower than the tolerance allows", min=0.0, initially=()
        )
        time_missed: float = var(
            0.0, "s", "Time spent slower than the tolerance allows", min=0.0, initially=()
        )

    @staticmethod
    def initial(p: Rider.Parameters, u: Rider.Inputs) -> Rider.State:
        """Return a state with no pedal pressed and nothing counted."""
        return Rider.State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, max(0.0, u.speed_reference) - u.speed)

    @staticmethod
    def step(p: Rider.Parameters, x: Rider.State, u: Rider.Inputs, dt: float) -> Rider.State:
        """Press a pedal at t_k, and count what `dt` [s] of this speed misses."""
        v_r = max(0.0, u.speed_reference)
        e = v_r - u.speed
        if not p.follows:
            integral, throttle, brake = 0.0, min(100.0, max(0.0, u.grip)), 0.0  # (R8)
        elif v_r <= 0.0 and u.speed < p.standstill_speed:  # (R5)
            integral, throttle, brake = 0.0, 0.0, p.standstill_brake_force
        else:
            integral, throttle, brake = _pedals(p, x.integral, v_r, e, dt)
        travelled = x.distance_reference + dt * v_r / KMH  # (R6)
        missed, late = x.distance_missed, x.time_missed
        if e > p.tolerance:  # (R7)
            missed += dt * (e - p.tolerance) / KMH
            late += dt
        return Rider.State(integral, travelled, missed, late, throttle, brake, e)

    @staticmethod
    def outputs(p: Rider.Parameters, x: Rider.State) -> Rider.Outputs:
        """Return the pedals and the counts of the last sample."""
        return Rider.Outputs(
            x.throttle, x.brake_force, x.speed_error, x.distance_reference, x.distance_missed, x.time_missed
        )


def _pedals(
    p: Rider.Parameters, integral: float, v_r: float, e: float, dt: float
) -> tuple[float, float, float]:
    """Return the next integral [%], the throttle [%] and the brake force [N]."""
    demand = p.proportional_gain * e + integral + p.speed_feedforward * v_r  # (R1)
    lowest = -p.coasting_band - p.maximum_brake_force / p.brake_gain
    if not ((demand >= 100.0 and e > 0.0) or (demand <= lowest and e < 0.0)):
        integral += dt * p.proportional_gain / p.integral_time * e  # (R2)
    if demand > 0.0:
        return integral, min(100.0, demand), 0.0  # (R3)
    press = max(0.0, -demand - p.coasting_band)
    return integral, 0.0, min(p.maximum_brake_force, p.brake_gain * press)  # (R4)
