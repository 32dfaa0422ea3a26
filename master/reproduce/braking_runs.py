"""The runs of the braking two-wheeler: each strategy's stop, the vehicle's effect on it, both propositions.

Runs that are compared with each other are `ideal`: the bus adds up to 0.15 m below 2 m/s, where half a newton
meter decides.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...cosim.interface import Value
from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...models import braking_analysis as analysis
from ...models.constants import GRAVITY
from ...models.road_friction import Road, friction_coefficient
from ..simulation import simulate
from .sampling import sampled

LOCKED = 0.99  # slip
FAST = 5.0  # m/s: above it, the end of the stop has no influence
STOP_TIME = 5.0  # s, more than any stop on a dry road with the parameters here needs
STARTS = 30
FINE_STEP = 0.001  # s, of a controller at 1 kHz

CONTROLLED = ("known_speed", "front_only", "front_compensated")
"""(a), (c), (d): the strategies that stop under control."""

NOMINAL = analysis.Parameters()


class Stop(NamedTuple):
    """The numbers of a stop."""

    distance: float  # m; NaN: not at rest at the end of the run
    swing: float  # the highest slip of the front wheel above FAST
    lock_speed: float  # m/s at which the front wheel first locks; NaN: it does not


class Lock(NamedTuple):
    """The lock of both wheels: its time [s] and speed [m/s], and True if they stay locked to standstill."""

    time: float
    speed: float
    stays: bool


class Propositions(NamedTuple):
    """The results of the random starts on one road."""

    spread: tuple[float, ...]  # of the end points of Proposition 3.1, in slip, for each of FACTORS
    equilibria: tuple[int, ...]  # how many there are, for each of FACTORS
    locked: int  # of STARTS, Proposition 3.2


FACTORS = (1.05, 10.0)  # of k-bar
MARGIN = 1.5  # k lambda* over max Psi


def stop_of(results: Results) -> Stop:
    """Return the numbers of the stop in a run's results."""
    v, slip = results["vehicle.speed"], results["vehicle.front_slip"]
    distance = float(results["vehicle.stopping_distance"][-1]) if v[-1] == 0.0 else math.nan
    locked = np.flatnonzero(slip > LOCKED)
    return Stop(distance, float(slip[v > FAST].max()), float(v[locked[0]]) if len(locked) else math.nan)


def lock_of(results: Results) -> Lock:
    """Return time and speed at which both wheels locked; NaN if they did not."""
    v = results["vehicle.speed"]
    both = (results["vehicle.front_slip"] > LOCKED) & (results["vehicle.rear_slip"] > LOCKED)
    if not both.any():
        return Lock(math.nan, math.nan, False)
    first = int(both.argmax())
    return Lock(float(results.time[first]), float(v[first]), bool(both[first:][v[first:] > 0.0].all()))


def stops(strategy: str, changes: Sequence[dict[str, Value]], step_size: float | None = None) -> list[Stop]:
    """Run a strategy with each set of changed parameters, at the system's step size or another one [s]."""
    system = sampled("braking", step_size)
    return [
        stop_of(simulate(system, strategy, parameters=change, ideal=True, stop_time=STOP_TIME))
        for change in changes
    ]


def propositions(road: Road) -> Propositions:
    """Evaluate both propositions on one road, from the same random starts."""
    p, starts = dataclasses.replace(NOMINAL, road=road), analysis.random_starts(STARTS)
    gains = [critical(factor) for factor in FACTORS]
    return Propositions(
        tuple(analysis.spread(analysis.end_points(p, k, starts)) for k in gains),
        tuple(len(analysis.equilibria(p, k)) for k in gains),
        int(analysis.locks(p, locking(p), starts).sum()),
    )


def critical(factor: float) -> analysis.Gains:
    """Return k-bar over all roads, times a factor [N.m per slip]."""
    k = analysis.k_bar(NOMINAL)
    return analysis.Gains(factor * k.front, factor * k.rear)


def locking(p: analysis.Parameters) -> analysis.Gains:
    """Return the gains of Proposition 3.2 [N.m per slip]: k lambda* = MARGIN max Psi on the road of p."""
    psi = analysis.highest_psi(p)
    factor = MARGIN / analysis.TARGET_SLIP
    return analysis.Gains(factor * psi.front, factor * psi.rear)


def rear_slip(results: Results) -> Array:
    """Return the slip of the rear wheel once the brakes act (from 0.5 s on), above FAST."""
    slip: Array = results["vehicle.rear_slip"][_acting(results)]
    return slip


def estimated_slip(results: Results) -> float:
    """Return the largest slip of a wheel that (16) estimates, once the brakes act, above FAST."""
    wheels = [results[f"vehicle.{wheel}_wheel_speed"][_acting(results)] for wheel in ("front", "rear")]
    fastest = np.maximum(*wheels)
    return float(max(((fastest - wheel) / fastest).max() for wheel in wheels))


def estimate_error(results: Results) -> float:
    """Return the largest error of the estimated speed, over the speed, once the brakes act, above FAST."""
    acting = _acting(results)
    speed = results["vehicle.speed"][acting]
    rims = [results[f"vehicle.{wheel}_rim_speed"][acting] for wheel in ("front", "rear")]
    return float(np.abs(np.maximum(*rims) / speed - 1.0).max())


def rear_energy(results: Results) -> tuple[float, float]:
    """Return the work [J] that the rear wheel does on the road above FAST, and the energy that it loses."""
    rows = results["vehicle.speed"] > FAST
    wheel = results["vehicle.rear_wheel_speed"][rows]
    power = -results["vehicle.rear_force"][rows] * results["vehicle.rear_rim_speed"][rows]
    lost = 0.5 * NOMINAL.wheel_inertia * (wheel[0] ** 2 - wheel[-1] ** 2)
    return float(np.trapezoid(power, results.time[rows])), float(lost)


def _acting(results: Results) -> NDArray[np.bool_]:
    acting: NDArray[np.bool_] = (results["vehicle.speed"] > FAST) & (results.time > 0.5)
    return acting


def coupling() -> tuple[float, float]:
    """Return the largest change of Psi_f over the rear slip, of Psi_r over the front one, over max Psi."""
    side = np.linspace(0.0, 1.0, 101)
    front, rear = np.meshgrid(side, side)
    at = analysis.reduced(NOMINAL, front, rear)
    return (
        float(np.ptp(at.psi_front, axis=0).max() / at.psi_front.max()),
        float(np.ptp(at.psi_rear, axis=1).max() / at.psi_rear.max()),
    )


def reduced_form_error() -> float:
    """Return the largest difference [m/s2] of v' of (6) from that which solves (1), (2) and (5) together."""
    p, slips = NOMINAL, analysis.random_starts(STARTS)
    given = analysis.reduced(p, slips[:, 0], slips[:, 1]).acceleration
    worst = 0.0
    for (front, rear), acceleration in zip(slips, given, strict=True):
        mu = [friction_coefficient(p.road, float(slip)) for slip in (front, rear)]
        length, shift = p.front_distance + p.rear_distance, p.mass * p.center_height
        load = [p.mass * GRAVITY * p.rear_distance, p.mass * GRAVITY * p.front_distance]
        # unknowns v', F_zf, F_zr
        equations = [[p.mass, mu[0], mu[1]], [shift, length, 0.0], [-shift, 0.0, length]]
        solved = np.linalg.solve(np.array(equations), np.array([0.0, *load]))
        worst = max(worst, abs(float(solved[0]) - float(acceleration)))
    return worst


def late(extra: float) -> dict[str, Value]:
    """Return the parameters of brakes that are later than the published 10 ms by `extra` [s]."""
    return {f"{brake}.delay": 0.01 + extra for brake in ("front_brake", "rear_brake")}


def high(factor: float) -> dict[str, Value]:
    """Return the parameters of a center of mass `factor` times as high."""
    return {"vehicle.center_height": factor * NOMINAL.center_height}


def heavy(factor: float) -> dict[str, Value]:
    """Return the parameters of wheels with `factor` times the inertia, which the controller compensates."""
    return {f"{unit}.wheel_inertia": factor * NOMINAL.wheel_inertia for unit in ("vehicle", "controller")}
