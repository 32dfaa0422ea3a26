"""The braking two-wheeler on suspensions and elastic tires, as the paper simulates it: runs and numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...cosim.results.results import Results
from ..simulation import simulate
from ..studies.parallel import Task
from .braking_runs import CONTROLLED, LOCKED, STOP_TIME, Stop, lock_of, stop_of
from .page import Findings, Found, at_most, holds, near

PLANT = "DetailedTwoWheeler"
LENGTHS = (0.1, 0.3)  # m, of relaxation

_LANDING = 0.1  # s for which the rear wheel, landing from a hop, may turn in a lock
_TABLE = {"known_speed": ("(a)", 0.7), "front_only": ("(c)", 0.3), "front_compensated": ("(d)", 0.5)}
_LONGER = 3.0  # %
OF = "detailed plant"


def tasks() -> tuple[Task[Any], ...]:
    """Return the runs of the detailed plant, over the bus."""
    strategies, put_in = (*CONTROLLED, "estimated_speed"), {"fmus": {"vehicle": PLANT}}
    return (
        *(Task(f"{name}, detailed", simulate, ("braking", name), put_in) for name in strategies),
        *(Task(f"relaxation {name}", relaxed, (name,)) for name in CONTROLLED),
    )


def relaxed(strategy: str) -> list[Stop]:
    """Run a strategy with each of LENGTHS, with ideal signals."""
    return [
        stop_of(
            simulate(
                "braking",
                strategy,
                fmus={"vehicle": PLANT},
                parameters={"vehicle.relaxation_length": length},
                ideal=True,
                stop_time=STOP_TIME,
            )
        )
        for length in LENGTHS
    ]


def table(found: dict[str, Any], printed: dict[str, float]) -> dict[str, Found]:
    """Return what the detailed plant gives for the rows of Table I; `printed` are their numbers by key."""
    distances = {name: stop_of(found[f"{name}, detailed"]).distance for name in CONTROLLED}
    rows = {}
    for name, (by, reach) in _TABLE.items():
        rows[by] = near(distances[name], printed[by], reach, "m", of=OF)
    for name in CONTROLLED[1:]:
        by = f"{_TABLE[name][0]} longer"
        more = 100.0 * (distances[name] / distances["known_speed"] - 1.0)
        rows[by] = near(more, printed[by], _LONGER, "%", digits=3, of=OF)
    return rows | {"(b)": _lock(found["estimated_speed, detailed"])}


def _lock(results: Results) -> Found:
    lock = lock_of(results)
    slips = [results[f"vehicle.{wheel}_slip"] for wheel in ("front", "rear")]
    held = (results.time >= lock.time) & (results["vehicle.speed"] > 0.0)
    step = float(results.time[1] - results.time[0])
    turning = step * float(np.count_nonzero(np.minimum(*slips)[held] < LOCKED))
    return holds(
        f"both after {lock.time:.2f} s at {lock.speed:.1f} m/s, to standstill but for {turning:.2f} s, in "
        "which the rear wheel lands from a hop",
        lock.time <= 1.0 and lock.speed > 15.0 and turning <= _LANDING,
        of=OF,
    )


def own(found: dict[str, Any]) -> Findings:
    """Return the numbers of the detailed plant that the paper does not print."""
    known = found["known_speed, detailed"]
    pitch = float(np.degrees(known["vehicle.pitch"].max()))
    hop = float(np.count_nonzero(known["vehicle.rear_load"] == 0.0)) * 0.01
    moved = {
        name: float(np.ptp([stop.distance for stop in found[f"relaxation {name}"]])) for name in CONTROLLED
    }
    return {
        "detailed plant, relaxation length of 0.1 to 0.3 m: stopping distance changes by": [
            at_most(change, 0.15, "m", digits=2, of=_TABLE[name][0]) for name, change in moved.items()
        ],
        "detailed plant, (a): largest pitch": near(pitch, 6.04, 0.05, "°", digits=3),
        "detailed plant, (a): rear wheel in the air": near(hop, 0.3, 0.05, "s", digits=2),
    }
