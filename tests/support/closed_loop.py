"""The scooter's loop in plain Python: planner, ECU and vehicle at 100 Hz, without FMUs, bus or master.

The ECU is stepped before the vehicle. The speed is sent rounded to 1 km/h, the throttle clipped to 0..100 %
and, on request, rounded to `throttle_resolution`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from itertools import pairwise

from evcosim.models.bound_controller import BoundController, ControllerState
from evcosim.models.bound_planner import BoundPlanner
from evcosim.models.scooter import Scooter

STEP = 0.01  # s

FIG9 = BoundPlanner.Parameters(
    acceleration_minimum=0.3,
    acceleration_at_rest=2.5,
    acceleration_slope=0.05,
    speed_mean=38.0,
    speed_amplitude=6.0,
)


@dataclasses.dataclass(frozen=True)
class Row:
    """What the units see at t_k [s]: the vehicle before its step (speed in km/h), the ECU after its step."""

    time: float
    request: float
    speed: float
    speed_measured: float
    acceleration: float
    speed_bound: float
    acceleration_bound: float
    ecu: BoundController.Outputs


def fig8_rider(t: float) -> float:
    """Full throttle from 1 s with 200 %/s, released at 30 s."""
    return min(100.0, max(0.0, 200.0 * (t - 1.0)), max(0.0, 200.0 * (30.5 - t)))


def fig9_rider(t: float) -> float:
    """Full throttle from 1 s with 200 %/s, released from 35 to 45 s, from 75 to 85 s, and at 115 s."""
    throttle = 0.0
    for pressed, released in ((1.0, 35.0), (45.0, 75.0), (85.0, 115.0)):
        throttle = max(throttle, min(100.0, 200.0 * (t - pressed), 100.0 - 200.0 * (t - released)))
    return throttle


def run(
    rider: Callable[[float], float],
    stop_time: float,
    *,
    planner: BoundPlanner.Parameters | None = None,
    ecu: BoundController.Parameters | None = None,
    vehicle: Scooter.Parameters | None = None,
    grade: Callable[[float], float] = lambda t: 0.0,
    speed_resolution: float = 1.0,
    throttle_resolution: float = 0.0,
) -> list[Row]:
    """The rows at 0, 0.01, ... up to, not including, stop_time [s]. A resolution of 0 does not round."""
    p, c, s = (
        planner or BoundPlanner.Parameters(),
        ecu or BoundController.Parameters(),
        vehicle or Scooter.Parameters(),
    )
    x_s = Scooter.initial(s, Scooter.Inputs())
    measured = _round(3.6 * x_s.speed, speed_resolution)
    x_c = BoundController.initial(c, BoundController.Inputs(rider(0.0), measured))
    x_p = BoundPlanner.initial(p, BoundPlanner.Inputs(0.0, x_c.speed_estimate))
    rows = []
    for k in range(round(stop_time / STEP)):
        t = k * STEP
        speed = 3.6 * x_s.speed
        measured = _round(speed, speed_resolution)
        x_p = BoundPlanner.step(p, x_p, BoundPlanner.Inputs(t, x_c.speed_estimate), STEP)
        u_c = BoundController.Inputs(rider(t), measured, x_p.speed_bound, x_p.acceleration_bound)
        x_c = BoundController.step(c, x_c, u_c, STEP)
        throttle = min(100.0, max(0.0, _round(x_c.throttle, throttle_resolution)))
        u_s = Scooter.Inputs(throttle, 0.0, grade(t))
        acceleration = Scooter.outputs(s, x_s, u_s).acceleration
        y = BoundController.outputs(c, x_c)
        rows.append(
            Row(t, rider(t), speed, measured, acceleration, x_p.speed_bound, x_p.acceleration_bound, y)
        )
        x_s = Scooter.step(s, x_s, u_s, STEP)
    return rows


def _round(value: float, resolution: float) -> float:
    return math.floor(value / resolution + 0.5) * resolution if resolution > 0.0 else value


def switches(rows: list[Row]) -> list[tuple[float, ControllerState]]:
    """The first state and every change, each with its time [s]."""
    found = [(rows[0].time, rows[0].ecu.state)]
    found += [(b.time, b.ecu.state) for a, b in pairwise(rows) if a.ecu.state != b.ecu.state]
    return found


def ripple(rows: list[Row]) -> float:
    """Root mean square of dg_e/dt [%/s] while a bound acts, without the samples of a state change."""
    rates = [
        (b.ecu.throttle - a.ecu.throttle) / STEP
        for a, b in pairwise(rows)
        if a.ecu.state == b.ecu.state != ControllerState.DRIVER
    ]
    return math.sqrt(sum(r * r for r in rates) / len(rates))
