"""The numbers of the two-motor car, from made-up runs."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import multi_drive_numbers as numbers


def run(**columns):
    """A run of 10 s with these columns of unit__variable, each a function of time or a number."""
    time = np.arange(1001) * 0.01
    values = {
        name.replace("__", "."): value(time) if callable(value) else np.full(1001, value)
        for name, value in columns.items()
    }
    return Results(time, np.column_stack(list(values.values())), [ResultVariable(name) for name in values])


def maneuver(shift=0.0):
    return run(
        vehicle__steering_angle=lambda t: np.select(
            [t < 2.0 + shift, t < 4.0, t < 5.0], [0.0, -0.02, 0.0], 0.02
        ),
        vehicle__road_grade=lambda t: np.select([t < 3.0, t < 5.0], [0.0, np.arctan(0.1)], -np.arctan(0.1)),
        differential__speed_reference=60.0,
    )


def test_the_events_are_those_of_the_paper():
    assert all(found.holds for found in numbers.inputs(maneuver()).values())


def test_a_curve_that_comes_late_does_not_hold():
    found = numbers.inputs(maneuver(shift=0.1))
    assert found["right curve"].obtained == "2.1 s"
    assert [by for by, each in found.items() if not each.holds] == ["right curve"]


def test_a_launch():
    found = numbers.launch(run(vehicle__speed=lambda t: np.minimum(2.0 * t, 60.0 / 3.6 + 0.01)))
    assert found.rise == pytest.approx(0.8 * 60.0 / 3.6 / 2.0, abs=0.01)
    assert found.overshoot == pytest.approx(0.06, abs=1e-3)
    assert found.behind == pytest.approx(-0.036, abs=1e-6)


def test_the_error_after_a_jump_leaves_the_jump_out():
    def error(t):
        return np.where((t >= 2.0) & (t < 2.2), 0.5, 0.001)

    jumped = run(controller__left_error=error, controller__right_error=error)
    assert numbers.largest_error(jumped) == 0.5
    assert numbers.after_jumps(jumped) == 0.001
