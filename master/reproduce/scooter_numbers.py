"""The numbers of the scooter system, each a function of the results of a run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...cosim.leftovers import temporary
from ...cosim.results.results import Results
from ...models.constants import KMH
from ...models.scooter import Scooter, command, level_road_load, maximum_force
from ..simulation import Simulation, simulate

VARIANTS: dict[str, dict[str, Any]] = {"bus": {}, "ideal": {"ideal": True}, "jacobi": {"algorithm": "jacobi"}}
CONSTANT_SPEEDS = (24.0, 27.3, 30.5, 34.49, 40.5, 45.25, 49.0)  # km/h


def linearized(speed: float) -> tuple[float, float]:
    """Return gain [km/h per %] and pole [Hz] at a steady speed [km/h] on a level road, by (1)-(2)."""
    p, v, h = Scooter.Parameters(), speed / KMH, 1e-4
    load_slope = (level_road_load(p, v + h) - level_road_load(p, v - h)) / (2.0 * h)
    force_slope = (maximum_force(p, v + h) - maximum_force(p, v - h)) / (2.0 * h)
    damping = load_slope - level_road_load(p, v) / maximum_force(p, v) * force_slope  # N.s/m
    return KMH * maximum_force(p, v) / 100.0 / damping, damping / p.mass / (2.0 * math.pi)


def throttle_limits() -> tuple[float, float]:
    """Return the throttles [%] beyond which the drive's force [N] at 30 km/h changes no more."""
    p, v = Scooter.Parameters(), 30.0 / KMH
    force = {throttle: command(p, v, float(throttle)) for throttle in range(-50, 151)}
    changing = [g for g in range(-50, 150) if force[g + 1] != force[g]]
    return float(changing[0]), float(changing[-1] + 1)


def boost(slow: float, fast: float) -> float:
    """Return the largest acceleration of the drive at a slow speed [km/h] over that at a fast one."""
    p = Scooter.Parameters()
    accelerations = [maximum_force(p, v / KMH) - level_road_load(p, v / KMH) for v in (slow, fast)]
    return accelerations[0] / accelerations[1]


def power_share(speed: float, acceleration: float) -> float:
    """Return the power of an acceleration [m/s2] at a speed [km/h] over that of the level road's friction."""
    p = Scooter.Parameters()
    return p.mass * acceleration / level_road_load(p, speed / KMH)


def steady_throttle(speed: float) -> float:
    """Return the throttle g [%] that keeps a speed [km/h] on a level road: v = 17.03 + 0.46 g (force map)."""
    return (speed - 17.03) / 0.46


def switches(results: Results) -> tuple[NDArray[np.float64], list[int]]:
    """Return the times [s] at which the supervisor changes its state, shape (n,), and its n + 1 states."""
    state = results["ecu.state"]
    at = np.flatnonzero(np.diff(state)) + 1
    return results.time[at], [int(state[0]), *(int(s) for s in state[at])]


def time_in_states(results: Results) -> list[float]:
    """Return the times [s] in the states driver, acceleration and velocity."""
    step = results.time[1] - results.time[0]
    return [float(step * np.count_nonzero(results["ecu.state"][:-1] == s)) for s in (0, 1, 2)]


def over_bound(results: Results) -> NDArray[np.float64]:
    """Return true speed minus speed bound [km/h], shape (n,)."""
    over: NDArray[np.float64] = results["vehicle.speed"] * KMH - results["ecu.speed_bound"]
    return over


def settled_error(results: Results) -> float:
    """Return the largest |v - v_b| [km/h] in velocity after 20 s."""
    settled = (results.time > 20.0) & (results["ecu.state"] == 2)
    return float(np.abs(over_bound(results)[settled]).max())


def settled_acceleration(results: Results) -> float:
    """Return the mean |acceleration| [m/s2] in velocity after 20 s."""
    settled = (results.time > 20.0) & (results["ecu.state"] == 2)
    return float(np.abs(results["vehicle.acceleration"][settled]).mean())


def ripple(results: Results) -> float:
    """Return the rms of dg_e/dt [%/s] while a bound acts, without samples in which the state changes."""
    state, rate = results["ecu.state"], np.diff(results["ecu.throttle"]) / 0.01
    inside = (state[1:] == state[:-1]) & (state[1:] != 0)
    return float(np.sqrt(np.mean(rate[inside] ** 2)))


def largest_jump(results: Results) -> float:
    """Return the largest |change of g_e| [%] at a switch, beyond the rider's own change."""
    throttle, request = results["ecu.throttle"], results["ecu.throttle_request"]
    at = np.flatnonzero(np.diff(results["ecu.state"]))
    return float((np.abs(np.diff(throttle))[at] - np.abs(np.diff(request))[at]).max())


def time_above_bound(results: Results) -> float:
    """Return the time [s] in acceleration with a true acceleration above the bound by more than 10 %."""
    above = results["vehicle.acceleration"] > 1.1 * results["ecu.acceleration_bound"]
    step = results.time[1] - results.time[0]
    return float(step * np.count_nonzero(above & (results["ecu.state"] == 1)))


def since_switch(results: Results) -> NDArray[np.float64]:
    """Return the time [s] in the present state, shape (n,); 0 before the first switch."""
    times, _ = switches(results)
    last = times[np.searchsorted(times, results.time, side="right") - 1]
    return np.where(results.time >= times[0], results.time - last, 0.0)


class ConstantSpeed(NamedTuple):
    """The estimate from 60 to 90 s at a constant speed: largest |v_e - v| and mean |v_e - v_m| [km/h]."""

    error: float
    from_measured: float


def at_constant_speed(speed: float, **options: Any) -> ConstantSpeed:
    """Return how good the estimated speed is at a constant speed [km/h], without bounds."""
    text = f"""
        leave_out = ["rider", "planner", "battery"]
        [experiment]
        stop_time = 90.0
        [parameters.ecu]
        enabled = false
        [parameters.vehicle]
        initial_speed = {speed / KMH}
        [[stimulus]]
        to = "ecu.throttle_request"
        constant = {steady_throttle(speed)}
    """
    with temporary() as folder:
        path = folder / "constant.toml"
        path.write_text(text)
        results = simulate("scooter", path, **options)
    late, estimate = results.time > 60.0, results["ecu.speed_estimate"]
    error = np.abs(estimate - results["vehicle.speed"] * KMH)[late]
    from_measured = np.abs(estimate - results["ecu.speed_measured"])[late]
    return ConstantSpeed(float(error.max()), float(from_measured.mean()))


def stop_and_go(bounded: bool, bounds: Mapping[str, float] | None = None) -> Results:
    """Run 300 s, with full throttle for 18 s and coasting for 12 s in turn; `bounds` are other parameters."""
    with Simulation("scooter", "fig8", parameters={"ecu.enabled": bounded, **(bounds or {})}) as sim:
        for second in range(300):
            sim.override("ecu.throttle_request", 100.0 if second % 30 < 18 else 0.0)
            sim.step(100)
        return sim.results


def energy_and_speed(results: Results) -> tuple[float, float]:
    """Return consumption from the cells [Wh/km] and mean speed [km/h]."""
    kilometers = results["vehicle.distance"][-1] / 1000.0
    return results["battery.energy_drawn"][-1] / kilometers, kilometers / (results.time[-1] / 3600.0)
