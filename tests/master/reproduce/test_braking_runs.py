"""The numbers of a stop and of a lock."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import braking_runs as runs


def results(speed, front_slip, rear_slip, distance=30.0):
    """A run of 0.1 s a step; its stopping distance is known at the last one."""
    columns = {
        "vehicle.speed": speed,
        "vehicle.front_slip": front_slip,
        "vehicle.rear_slip": rear_slip,
        "vehicle.stopping_distance": [0.0] * (len(speed) - 1) + [distance],
    }
    variables = [ResultVariable(name) for name in columns]
    return Results(0.1 * np.arange(len(speed)), np.column_stack(list(columns.values())), variables)


def test_stop_of_a_run():
    stop = runs.stop_of(results([20.0, 10.0, 2.0, 0.0], [0.1, 0.4, 1.0, 0.0], [0.0] * 4))
    assert stop == (30.0, 0.4, 2.0)


def test_a_run_that_ends_too_early_has_no_distance():
    stop = runs.stop_of(results([20.0, 10.0], [0.1, 0.2], [0.0] * 2, distance=0.0))
    assert math.isnan(stop.distance)
    assert math.isnan(stop.lock_speed)


@pytest.mark.parametrize(
    ("front", "rear", "expected"),
    [
        ([0.0, 1.0, 1.0, 0.0], [0.0, 0.5, 1.0, 0.0], (0.2, 5.0, True)),
        ([0.0, 1.0, 0.2, 0.0], [0.0, 1.0, 1.0, 0.0], (0.1, 10.0, False)),
    ],
    ids=["to standstill", "released"],
)
def test_lock_of_a_run(front, rear, expected):
    assert runs.lock_of(results([20.0, 10.0, 5.0, 0.0], front, rear)) == pytest.approx(expected)


def test_no_lock():
    lock = runs.lock_of(results([20.0, 0.0], [0.2, 0.0], [0.2, 0.0]))
    assert math.isnan(lock.time)
    assert not lock.stays
