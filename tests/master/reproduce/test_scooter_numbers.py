"""The numbers of the scooter: its linearization, and each number of a run."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import scooter_numbers as numbers
from evcosim.master.reproduce.scooter_numbers import linearized


@pytest.mark.parametrize(
    ("speed", "pole"),
    [(25.0, 0.0411), (30.0, 0.0300), (35.0, 0.0253), (40.0, 0.0228), (45.0, 0.0214), (49.0, 0.0206)],
)
def test_the_scooters_linearization(speed, pole):
    gain, found = linearized(speed)
    assert gain == pytest.approx(0.46, rel=1e-3)
    assert found == pytest.approx(pole, abs=5e-5)


@pytest.fixture
def run():
    """A made-up run of 40 s: driver to 10 s, acceleration to 20 s, velocity to the end."""
    time = np.arange(4001) * 0.01
    state = np.select([time < 10.0, time < 20.0], [0.0, 1.0], 2.0)
    columns = {
        "ecu.state": state,
        "ecu.throttle": 20.0 + 5.0 * (state == 1.0) + 0.1 * np.sin(time),
        "ecu.throttle_request": 40.0 + 2.0 * (time >= 10.0),
        "ecu.speed_bound": np.full(4001, 30.0),
        "vehicle.acceleration": np.select([time < 12.0, time < 13.0], [3.0, 1.2], 1.0),
        "ecu.acceleration_bound": np.full(4001, 1.0),
        "vehicle.speed": (30.0 + 0.3 * np.cos(time)) / 3.6,
        "vehicle.distance": 10.0 * time,
        "battery.energy_drawn": 0.5 * time,
    }
    return Results(time, np.column_stack(list(columns.values())), [ResultVariable(name) for name in columns])


def test_switches_and_times_in_states(run):
    times, states = numbers.switches(run)
    assert times == pytest.approx([10.0, 20.0])
    assert states == [0, 1, 2]
    assert numbers.time_in_states(run) == pytest.approx([10.0, 10.0, 20.0])
    since = numbers.since_switch(run)
    assert (since[500], since[1500], since[4000]) == pytest.approx((0.0, 5.0, 20.0))


def test_speed_over_the_bound(run):
    assert numbers.over_bound(run)[0] == pytest.approx(0.3)
    assert numbers.settled_error(run) == pytest.approx(0.3, rel=1e-4)


def test_the_settled_acceleration_is_that_in_velocity(run):
    assert numbers.settled_acceleration(run) == 1.0


def test_ripple_leaves_the_switches_out(run):
    assert numbers.ripple(run) == pytest.approx(0.1 / np.sqrt(2.0), rel=0.05)


def test_the_jump_at_a_switch_is_beyond_that_of_the_rider(run):
    assert numbers.largest_jump(run) == pytest.approx(
        5.0, abs=0.01
    )  # at 20 s; at 10 s the rider moves 2 of 5


def test_time_above_the_bound_counts_in_acceleration_alone(run):
    assert numbers.time_above_bound(run) == pytest.approx(3.0)


def test_the_drive_clips_the_throttle():
    assert numbers.throttle_limits() == (0.0, 100.0)


def test_the_boost_is_a_ratio_of_accelerations():
    assert numbers.boost(30.0, 30.0) == 1.0
    assert numbers.boost(24.0, 40.0) > 2.0


def test_energy_and_speed(run):
    assert numbers.energy_and_speed(run) == pytest.approx((20.0 / 0.4, 36.0))


def test_the_steady_throttle_is_that_of_the_gain():
    assert numbers.steady_throttle(30.0) == pytest.approx(28.2, abs=0.01)
