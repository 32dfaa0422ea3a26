"""The scooter over both bounds, and consumption at equal mean speed."""

from __future__ import annotations

import math
import pickle

import pytest

from evcosim.master.reproduce import scooter_bounds as bounds
from evcosim.master.reproduce.scooter_bounds import ACCELERATION_BOUNDS, FREE, SPEED_BOUNDS, Pull


@pytest.fixture
def found():
    """A map made up: overshoot and switches grow with a_b, and rides that use 2 Wh/km a km/h."""
    pulls = {
        f"a_b = {a:g}, v_b = {v:g}": Pull(a, v, 0.1 * a, int(5 * a), 0.3, 40.0 + v)
        for a in ACCELERATION_BOUNDS
        for v in SPEED_BOUNDS
    }
    rides = {f"ride v_b = {v:g}": (2.0 * (v - 5.0), v - 5.0) for v in FREE}
    return pulls | rides | {"dwell": Pull(4.0, 30.0, 1.0, 6, 0.3, 48.0), "ride a_b = 1": (70.0, 34.0)}


def test_tasks_have_names_of_their_own_and_can_be_sent():
    tasks = bounds.tasks()
    assert len({task.name for task in tasks}) == len(tasks)
    assert len(tasks) == len(ACCELERATION_BOUNDS) * len(SPEED_BOUNDS) + 2 + len(bounds.ALONE) + len(FREE)
    assert pickle.loads(pickle.dumps(tasks)) == tasks


def test_a_dwell_time_takes_most_switches_away():
    many, few = bounds.pull(4.0, 30.0), bounds.pull(4.0, 30.0, bounds.DWELL)
    assert (many.switches, few.switches) == (26, 6)
    assert many.overshoot == pytest.approx(few.overshoot)
    assert many.consumption == pytest.approx(48.3, abs=0.1)


def test_a_bound_of_no_acceleration_keeps_the_vehicle_where_it_is():
    rest = bounds.pull(0.0, 30.0)
    assert (rest.distance, rest.overshoot) == (0.0, 0.0)
    assert math.isnan(rest.consumption)


def test_consumptions_are_compared_at_equal_mean_speed(found):
    assert bounds.at_equal_speed(found, 1.0) == pytest.approx((34.0, 70.0, 68.0))
    found["ride a_b = 1"] = (70.0, 60.0)
    with pytest.raises(ValueError, match=r"no ride is as fast as 60\.0 km/h"):
        bounds.at_equal_speed(found, 1.0)


def test_the_figure_shows_a_line_for_each_speed_bound_and_the_dwell_time(found):
    overshoot, switches, consumption = bounds.figure(found).axes
    assert len(overshoot.lines) == len(consumption.lines) == len(SPEED_BOUNDS)
    assert list(switches.lines[0].get_ydata()) == [int(5 * a) for a in ACCELERATION_BOUNDS]
    assert list(switches.lines[-1].get_ydata()) == [6]
    texts = [text.get_text() for text in switches.get_legend().get_texts()]
    assert texts == ["v_b = 30 km/h", "v_b = 40 km/h", "v_b = 50 km/h", "v_b = 30 km/h,\ndwell time 0.5 s"]
