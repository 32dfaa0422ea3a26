"""The loop of the paper's Figs. 8 and 9 in plain Python: the numbers that the scooter system must reach."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any

import pytest

from evcosim.models.bound_controller import BoundController, ControllerState
from support.closed_loop import FIG9, Row, fig8_rider, fig9_rider, ripple, run, switches

DRIVER, ACCELERATION, VELOCITY = ControllerState
QUANTIZED_THROTTLE = pytest.mark.parametrize("throttle_resolution", [0.0, 0.4])


@cache
def fig8(**options: Any) -> list[Row]:
    """Fig. 8, 40 s."""
    return run(fig8_rider, 40.0, **options)


@cache
def fig9(**options: Any) -> list[Row]:
    """Fig. 9, 120 s."""
    return run(fig9_rider, 120.0, planner=FIG9, **options)


def between(rows: list[Row], start: float, stop: float) -> list[Row]:
    """The rows of start <= t < stop [s]."""
    return [r for r in rows if start <= r.time < stop]


@QUANTIZED_THROTTLE
def test_fig8_states_and_how_long_they_last(throttle_resolution: float) -> None:
    rows = fig8(throttle_resolution=throttle_resolution)
    assert [state for _, state in switches(rows)] == [DRIVER, ACCELERATION, VELOCITY, DRIVER]
    last = {s: sum(r.ecu.state == s for r in rows) * 0.01 for s in ControllerState}
    assert last == pytest.approx({DRIVER: 10.9, ACCELERATION: 8.1, VELOCITY: 21.1}, abs=0.2)


@QUANTIZED_THROTTLE
def test_fig8_keeps_the_speed_bound(throttle_resolution: float) -> None:
    rows = fig8(throttle_resolution=throttle_resolution)
    assert max(r.speed for r in rows) - 30.0 <= 1.5
    assert max(abs(r.speed - 30.0) for r in between(rows, 20.0, 30.0)) <= 0.55
    assert max(abs(r.ecu.speed_estimate - r.speed) for r in between(rows, 20.0, 30.0)) <= 0.5


def test_fig8_keeps_the_acceleration_bound() -> None:
    """The true acceleration in ACCELERATION: its mean, and its peak once the rider's step is taken back."""
    rows = [r for r in fig8() if r.ecu.state == ACCELERATION]
    mean = (rows[-1].speed - rows[0].speed) / 3.6 / (rows[-1].time - rows[0].time)
    assert mean == pytest.approx(1.0, abs=0.02)
    assert max(r.acceleration for r in between(rows, 3.0, 40.0)) <= 1.1


@QUANTIZED_THROTTLE
def test_the_observer_calms_the_throttle(throttle_resolution: float) -> None:
    raw = BoundController.Parameters(use_observer=False)
    with_observer = fig8(throttle_resolution=throttle_resolution)
    without = fig8(ecu=raw, throttle_resolution=throttle_resolution)
    assert ripple(without) / ripple(with_observer) >= 20.0


@pytest.mark.parametrize("ride", [fig8, fig9], ids=["fig8", "fig9"])
def test_switches_are_bumpless(ride: Callable[[], list[Row]]) -> None:
    """Beyond the rider's own step, at T_t = T_s (the default): 1 %."""
    jumps = [
        abs(b.ecu.throttle - a.ecu.throttle) - abs(b.request - a.request)
        for a, b in pairwise(ride())
        if a.ecu.state != b.ecu.state
    ]
    assert jumps
    assert max(jumps) <= 1.0


def test_without_quantization_the_loop_is_the_same_but_quieter() -> None:
    rows = fig8(speed_resolution=0.0)
    assert [state for _, state in switches(rows)] == [DRIVER, ACCELERATION, VELOCITY, DRIVER]
    assert max(r.speed for r in rows) - 30.0 <= 1.5
    assert max(abs(r.ecu.speed_estimate - r.speed) for r in between(rows, 20.0, 30.0)) <= 0.01


@QUANTIZED_THROTTLE
def test_fig9_switches_through_three_pulls(throttle_resolution: float) -> None:
    states = [state for _, state in switches(fig9(throttle_resolution=throttle_resolution))]
    assert states == [DRIVER, ACCELERATION, VELOCITY] * 3 + [DRIVER]


@QUANTIZED_THROTTLE
def test_fig9_keeps_both_moving_bounds(throttle_resolution: float) -> None:
    """The speed bound with the overshoot of an entry, and within the rounding once 10 s in VELOCITY."""
    rows = fig9(throttle_resolution=throttle_resolution)
    entries = [*switches(rows), (120.0, DRIVER)]
    for (start, state), (stop, _) in pairwise(entries):
        here = between(rows, start, stop)
        if state == VELOCITY:
            assert max(r.speed - r.speed_bound for r in here) <= 2.0
            assert max(r.speed - r.speed_bound for r in between(here, start + 10.0, stop)) <= 1.0
        if state == ACCELERATION:
            after = between(here, start + 1.0, stop)
            assert max(r.acceleration - r.acceleration_bound for r in after) <= 0.4


def test_disabled_the_rider_drives() -> None:
    rows = fig8(ecu=BoundController.Parameters(enabled=False))
    assert {r.ecu.state for r in rows} == {DRIVER}
    assert max(r.speed for r in rows) > 45.0
    assert all(r.ecu.throttle == r.request for r in rows)


def test_a_downhill_road_is_still_bounded() -> None:
    """As far as a closed throttle can: the bound holds where the slope alone does not exceed it."""
    rows = fig8(grade=_downhill)
    assert max(r.speed for r in rows) - 30.0 <= 1.5


def _downhill(t: float) -> float:
    return -0.03


def test_a_dwell_time_limits_the_switching_at_part_throttle() -> None:
    """The paper's remark: near the bound at part throttle the states alternate; a dwell time calms that."""

    def half(t: float) -> float:
        return 50.0 if t > 1.0 else 0.0

    counts = [
        len(switches(run(half, 30.0, planner=FIG9, ecu=BoundController.Parameters(dwell_time=dwell))))
        for dwell in (0.0, 0.5)
    ]
    assert counts[1] < 0.5 * counts[0]
