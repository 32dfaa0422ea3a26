"""The scooter over the ranges of its bounds, and what the acceleration bound alone does to the consumption.

Dardanelli et al., IEEE CDC-ECC 2011, section V, prints the ranges a_b in [0, 4] m/s2 and v_b in [30, 50] km/h
of its tests, and that limiting the acceleration saves energy, without a number.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ..simulation import simulate
from ..studies.parallel import Task
from . import scooter_numbers as numbers

ACCELERATION_BOUNDS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0)  # m/s2
SPEED_BOUNDS = (30.0, 40.0, 50.0)  # km/h
DWELL = 0.5  # s
ALONE = (0.5, 1.0)  # m/s2: bounds of the acceleration beside which none of the speed acts
FREE = (35.0, 40.0, 45.0, 60.0)  # km/h: bounds of the speed beside which none of the acceleration acts
_NONE = {"a_b": 100.0, "v_b": 60.0}  # m/s2 and km/h that the scooter does not reach


@dataclasses.dataclass(frozen=True)
class Pull:
    """The pull of Fig. 8 under constant bounds [m/s2, km/h]: overshoot [km/h], switches and distance [km].

    `consumption` is in Wh/km, NaN for a vehicle that does not move; `overshoot` is 0 below the bound.
    """

    acceleration_bound: float
    speed_bound: float
    overshoot: float
    switches: int
    distance: float
    consumption: float


def pull(acceleration_bound: float, speed_bound: float, dwell_time: float = 0.0) -> Pull:
    """Run Fig. 8 with other bounds [m/s2, km/h] and dwell time [s]."""
    parameters = {
        "planner.acceleration_at_rest": acceleration_bound,
        "planner.speed_mean": speed_bound,
        "ecu.dwell_time": dwell_time,
    }
    results = simulate("scooter", "fig8", parameters=parameters)
    distance = float(results["vehicle.distance"][-1]) / 1000.0
    return Pull(
        acceleration_bound,
        speed_bound,
        max(0.0, float(numbers.over_bound(results).max())),
        len(numbers.switches(results)[0]),
        distance,
        float(results["battery.energy_drawn"][-1]) / distance if distance > 1e-6 else math.nan,
    )


def ride(acceleration_bound: float, speed_bound: float) -> tuple[float, float]:
    """Return consumption [Wh/km] and mean speed [km/h] of the stop and go under constant bounds."""
    parameters = {"planner.acceleration_at_rest": acceleration_bound, "planner.speed_mean": speed_bound}
    return numbers.energy_and_speed(numbers.stop_and_go(True, parameters))


def tasks() -> tuple[Task[Any], ...]:
    """Return the runs of the map, one with a dwell time, one with a_b = 0, and the rides."""
    return (
        *(Task(_of(a, v), pull, (a, v)) for v in SPEED_BOUNDS for a in ACCELERATION_BOUNDS),
        Task("dwell", pull, (4.0, 30.0, DWELL)),
        Task("a_b = 0", pull, (0.0, 30.0)),
        *(Task(f"ride a_b = {a:g}", ride, (a, _NONE["v_b"])) for a in ALONE),
        *(Task(f"ride v_b = {v:g}", ride, (_NONE["a_b"], v)) for v in FREE),
    )


def at(found: Mapping[str, Any], acceleration_bound: float, speed_bound: float) -> Pull:
    """Return the run of the map at a pair of bounds. Raises KeyError where there is none."""
    result: Pull = found[_of(acceleration_bound, speed_bound)]
    return result


def at_equal_speed(found: Mapping[str, Any], acceleration_bound: float) -> tuple[float, float, float]:
    """Return mean speed [km/h], consumption [Wh/km] with this a_b alone, and with v_b alone at that speed.

    The second one lies between those of the rides under v_b whose mean speeds are next to it.
    """
    consumption, speed = found[f"ride a_b = {acceleration_bound:g}"]
    rides = [found[f"ride v_b = {v:g}"] for v in FREE]
    speeds = [each[1] for each in rides]
    if not speeds[0] <= speed <= speeds[-1]:
        raise ValueError(f"no ride is as fast as {speed:.1f} km/h: {speeds[0]:.1f} to {speeds[-1]:.1f} km/h")
    return speed, consumption, float(np.interp(speed, speeds, [each[0] for each in rides]))


def figure(found: Mapping[str, Any]) -> Any:
    """Draw overshoot, switches and consumption over a_b, a line for each v_b."""
    panels = (
        ("overshoot", "overshoot\n[km/h]"),
        ("switches", "switches"),
        ("consumption", "consumption\n[Wh/km]"),
    )
    with figures.canvas(
        3, height=2.1, title="scooter: the pull of Fig. 8 over both bounds", share_x=True
    ) as (
        drawn,
        axes,
    ):
        for row, (name, label) in enumerate(panels):
            panel = axes[row, 0]
            for i, v in enumerate(SPEED_BOUNDS):
                values = [getattr(at(found, a, v), name) for a in ACCELERATION_BOUNDS]
                _line(panel, ACCELERATION_BOUNDS, values, f"v_b = {v:g} km/h", i)
            panel.set_ylabel(label)
            panel.set_ylim(0.0, panel.dataLim.y1 * 1.07)
        axes[1, 0].plot(
            4.0,
            found["dwell"].switches,
            "k*",
            ms=9,
            label=f"v_b = 30 km/h,\ndwell time {DWELL:g} s",
            clip_on=False,
        )
        axes[1, 0].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
        axes[2, 0].set(xlabel="acceleration bound a_b [m/s²]", xlim=(0.0, 4.1))
        drawn.align_ylabels(axes[:, 0])
    return drawn


def _line(panel: Any, x: Sequence[float], y: Sequence[float], label: str, place: int) -> None:
    panel.plot(x, y, marker="os^"[place], ms=4, label=label, **figures.look(place))


def _of(acceleration_bound: float, speed_bound: float) -> str:
    return f"a_b = {acceleration_bound:g}, v_b = {speed_bound:g}"
