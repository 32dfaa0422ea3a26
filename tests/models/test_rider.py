"""Rider: follows the legal cycles, one pedal at a time, stops and stays, counts what is missed."""

from __future__ import annotations

import csv
import math
from bisect import bisect_right
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.models.rider import Rider
from evcosim.models.scooter import Scooter

DT = 0.01
P = Rider.Parameters()
CYCLES = Path(__file__).parents[2] / "cosim" / "data" / "cycles"


def cycle(name: str, highest: float = math.inf) -> list[float]:
    """A cycle of cosim/cycles, linear between its points, every 10 ms [km/h], cut at `highest`."""
    with open(CYCLES / f"{name}.csv", newline="") as file:
        header, *rows = csv.reader(file)
    scale = {"speed_kmh": 1.0, "speed_mps": 3.6}[header[1]]
    times = [float(row[0]) for row in rows]
    speeds = [scale * float(row[1]) for row in rows]
    found = []
    for k in range(round(times[-1] / DT)):
        i = bisect_right(times, k * DT) - 1
        share = (k * DT - times[i]) / (times[i + 1] - times[i])
        found.append(min(highest, speeds[i] + share * (speeds[i + 1] - speeds[i])))
    return found


def ride(reference: list[float], grade: float = 0.0) -> tuple[list[Rider.State], list[Scooter.State]]:
    """Rider and scooter, the rider first, at each sample of a reference [km/h]."""
    p = Scooter.Parameters()
    rider, scooter = Rider.initial(P, Rider.Inputs()), Scooter.initial(p, Scooter.Inputs())
    riders, scooters = [], []
    for v_r in reference:
        rider = Rider.step(P, rider, Rider.Inputs(v_r, 3.6 * scooter.speed), DT)
        riders.append(rider)
        scooters.append(scooter)
        scooter = Scooter.step(p, scooter, Scooter.Inputs(rider.throttle, rider.brake_force, grade), DT)
    return riders, scooters


def rms(values: list[float]) -> float:
    """Root mean square."""
    return math.sqrt(sum(x * x for x in values) / len(values))


def test_ece15_is_followed() -> None:
    reference = cycle("ece15")
    riders, scooters = ride(reference)
    errors = [x.speed_error for x in riders]
    assert rms(errors) < 0.6
    assert max(map(abs, errors)) < 2.5
    assert riders[-1].distance_missed == riders[-1].time_missed == 0.0
    assert riders[-1].distance_reference == pytest.approx(1014.6, abs=1.0)
    assert scooters[-1].distance == pytest.approx(riders[-1].distance_reference, rel=0.005)


def test_udds_below_45_kmh_is_followed_but_for_seconds() -> None:
    riders, _ = ride(cycle("udds", 45.0))
    assert rms([x.speed_error for x in riders]) < 0.8
    assert riders[-1].time_missed < 2.0
    assert riders[-1].distance_missed < 0.001 * riders[-1].distance_reference


def test_what_the_vehicle_cannot_reach_is_counted_and_leaves_nothing_to_unwind() -> None:
    """60 s at 80 km/h, which the drive limits to 50: the shortfall is counted, then 30 km/h is followed."""
    reference = [40.0] * 2000 + [80.0] * 6000 + [30.0] * 2000
    riders, scooters = ride(reference)
    limited = 3.6 * scooters[7999].speed
    assert 49.5 < limited < 50.5
    expected = 60.0 * (80.0 - limited - P.tolerance) / 3.6
    assert riders[7999].distance_missed - riders[1999].distance_missed == pytest.approx(expected, rel=0.03)
    assert riders[-1].time_missed - riders[1999].time_missed == pytest.approx(60.0, abs=1.0)
    after = [3.6 * x.speed for x in scooters[8000:]]
    assert min(after) > 30.0 - 2.0
    assert after[-1] == pytest.approx(30.0, abs=0.3)


@pytest.mark.parametrize("grade", [-0.1, 0.0, 0.1])
def test_a_full_stop_is_held_on_a_slope(grade: float) -> None:
    reference = [20.0] * 1500 + [0.0] * 2000
    riders, scooters = ride(reference, grade)
    assert scooters[-1].speed == 0.0
    assert scooters[2500].distance == scooters[-1].distance
    assert {(x.throttle, x.brake_force) for x in riders[2500:]} == {(0.0, P.standstill_brake_force)}


@given(
    st.lists(st.tuples(st.floats(-20.0, 200.0), st.floats(0.0, 150.0)), min_size=1, max_size=60),
)
def test_one_pedal_at_a_time_in_range_and_counts_that_only_grow(
    inputs: list[tuple[float, float]],
) -> None:
    x = Rider.initial(P, Rider.Inputs(*inputs[0]))
    for v_r, v in inputs:
        after = Rider.step(P, x, Rider.Inputs(v_r, v), DT)
        assert after.throttle == 0.0 or after.brake_force == 0.0
        assert 0.0 <= after.throttle <= 100.0
        assert 0.0 <= after.brake_force <= max(P.maximum_brake_force, P.standstill_brake_force)
        assert x.distance_missed <= after.distance_missed
        assert x.distance_reference <= after.distance_reference
        assert after.distance_missed <= after.distance_reference
        x = after


@given(st.floats(-1000.0, 1000.0))
def test_saturated_pedals_stop_the_integral(integral: float) -> None:
    full = Rider.State(integral=max(100.0, integral))
    assert Rider.step(P, full, Rider.Inputs(50.0, 10.0), DT).integral == full.integral
    braked = Rider.State(integral=min(-500.0, integral))
    assert Rider.step(P, braked, Rider.Inputs(10.0, 50.0), DT).integral == braked.integral


def test_a_saturated_pedal_still_lets_the_integral_come_back() -> None:
    full, braked = Rider.State(integral=1000.0), Rider.State(integral=-1000.0)
    assert Rider.step(P, full, Rider.Inputs(10.0, 11.0), DT).integral < full.integral
    assert Rider.step(P, braked, Rider.Inputs(11.0, 10.0), DT).integral > braked.integral


@given(st.floats(0.0, 50.0), st.floats(0.0, 3.0))
def test_inside_the_tolerance_nothing_is_missed(v: float, below: float) -> None:
    x = Rider.step(P, Rider.State(), Rider.Inputs(v + below, v), DT)
    assert (x.distance_missed, x.time_missed) == (0.0, 0.0)


@given(st.floats(-50.0, 150.0), st.floats(0.0, 60.0), st.floats(0.0, 60.0))
def test_a_rider_who_does_not_follow_turns_the_grip_and_brakes_not(
    grip: float, reference: float, speed: float
) -> None:
    p, u = Rider.Parameters(follows=False), Rider.Inputs(reference, speed, grip)
    x = Rider.step(p, Rider.initial(p, u), u, DT)
    assert (x.throttle, x.brake_force, x.integral) == (min(100.0, max(0.0, grip)), 0.0, 0.0)
    follower = Rider.step(P, Rider.initial(P, u), u, DT)
    assert (x.distance_missed, x.speed_error) == (follower.distance_missed, follower.speed_error)
    assert Rider.step(P, Rider.initial(P, u), Rider.Inputs(reference, speed), DT) == follower
