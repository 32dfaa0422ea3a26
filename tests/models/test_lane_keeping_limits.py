"""What outputs let one observe, and what the step asks of the tires, against the model's own motion."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from evcosim.models import lane_keeping_limits as limits
from evcosim.models.bicycle import discretized
from evcosim.models.lane_keeping_controller import LaneKeepingController

P = LaneKeepingController.Parameters()
TEXT = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))  # y' and theta, the outputs of the paper's text
TRACKED = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 1.0))  # y' and theta + beta, those of its printed S


def test_the_outputs_of_the_text_do_not_show_the_displacement() -> None:
    assert limits.observability_rank(P, TEXT) == 3
    assert np.abs(limits.unobservable(P, TEXT)) == pytest.approx(np.array([[0.0, 0.0, 0.0, 1.0]]), abs=1e-12)


def test_the_tracked_outputs_show_every_state() -> None:
    assert limits.observability_rank(P, TRACKED) == 4
    assert limits.unobservable(P, TRACKED).shape == (0, 4)


@pytest.mark.parametrize("speed", [3.0, 21.3, 60.0])
def test_the_rank_does_not_hang_on_the_speed(speed: float) -> None:
    p = dataclasses.replace(P, speed=speed)
    assert [limits.observability_rank(p, c) for c in (TEXT, TRACKED, TEXT[:1], TRACKED[1:])] == [3, 4, 2, 4]


def test_states_that_differ_where_nothing_is_observed_have_equal_outputs() -> None:
    """Two vehicles beside each other in the lane, steered alike: y' and theta stay equal."""
    drive = np.array(discretized(P.a, P.b, 0.01))[:, :6]
    one, other = np.array([0.1, 0.02, 0.3, 0.0]), np.array([0.1, 0.02, 0.3, 0.7])
    for k in range(100):
        angles = [0.01 * np.sin(0.3 * k), 0.02 * np.cos(0.2 * k)]
        one, other = drive @ [*one, *angles], drive @ [*other, *angles]
    assert np.array_equal(one[:3], other[:3])
    assert other[3] - one[3] == pytest.approx(0.7)


def test_the_forces_are_those_of_the_motion() -> None:
    """m (y'' + v_x w_z) and J_z w_z' of the model's A and B, for any state and steering."""
    draw = np.random.default_rng(1)
    states, angles = draw.normal(size=(20, 4)), draw.normal(size=(20, 2))
    rates = states @ np.array(P.a).T + angles @ np.array(P.b).T
    forces = limits.side_forces(P, states, angles)
    acceleration = limits.lateral_acceleration(P, forces)
    assert acceleration == pytest.approx(rates[:, 0] + P.speed * states[:, 2])
    moment = forces @ [P.front_axle_distance, -P.rear_axle_distance]
    assert moment == pytest.approx(P.yaw_inertia * rates[:, 2])


def test_the_loads_carry_the_vehicle_and_turn_it_not() -> None:
    front, rear = limits.axle_loads(P)
    assert front + rear == pytest.approx(P.mass * 9.81)
    assert front * P.front_axle_distance == pytest.approx(rear * P.rear_axle_distance)


def test_the_step_asks_for_more_than_any_tire_has() -> None:
    """Just after the step of 0.3 m the vehicle still goes straight, and u = S r."""
    forces = limits.side_forces(P, np.zeros((1, 4)), [np.array(P.prefilter) @ [0.0, 0.3]])
    assert np.abs(forces[0]) == pytest.approx([16.92e3, 6.14e3], rel=1e-3)
    assert limits.axle_loads(P)[0] == pytest.approx(6.82e3, rel=1e-3)
    assert limits.needed_friction(P, forces)[0, 0] == pytest.approx(2.48, abs=0.005)
    assert limits.lateral_acceleration(P, forces)[0] == pytest.approx(-7.81, abs=0.01)
