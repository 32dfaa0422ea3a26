"""LaneKeepingController: optimal gain and exact prefilter for any vehicle; what cannot be is refused."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_lyapunov

from evcosim.models import lane_keeping_controller as design
from evcosim.models.lane_keeping_controller import TAKEN
from evcosim.models.lane_keeping_controller import LaneKeepingController as Controller

P = Controller.Parameters()
DT = 0.01
vehicles = st.builds(
    Controller.Parameters,
    mass=st.floats(600.0, 3000.0),
    yaw_inertia=st.floats(800.0, 5000.0),
    front_cornering_stiffness=st.floats(1e4, 1e5),
    rear_cornering_stiffness=st.floats(1e4, 1e5),
    front_axle_distance=st.floats(0.8, 2.0),
    rear_axle_distance=st.floats(0.8, 2.0),
    speed=st.floats(3.0, 60.0),
    displacement_weight=st.floats(0.1, 10.0),
    front_steering_weight=st.floats(0.1, 10.0),
    rear_steering_weight=st.floats(0.1, 10.0),
)
numbers = st.floats(-1.0, 1.0)
inputs = st.builds(Controller.Inputs, *[numbers] * 6)


def weights(p: Controller.Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Q and R."""
    q = (p.lateral_velocity_weight, p.heading_angle_weight, p.yaw_rate_weight, p.displacement_weight)
    return np.diag(q), np.diag((p.front_steering_weight, p.rear_steering_weight))


@settings(max_examples=40)
@given(vehicles)
def test_the_gain_is_that_of_its_own_cost(p: Controller.Parameters) -> None:
    """P of the loop with K (Lyapunov) gives K back: the fixed point of policy iteration is the optimum."""
    a, b, k = np.array(p.a), np.array(p.b), np.array(p.gain)
    q, r = weights(p)
    closed = a - b @ k
    assert np.linalg.eigvals(closed).real.max() < 0.0
    cost = solve_continuous_lyapunov(closed.T, -(q + k.T @ r @ k))
    assert np.linalg.solve(r, b.T @ cost) == pytest.approx(k, rel=1e-6, abs=1e-6)


@settings(max_examples=40)
@given(vehicles, numbers, numbers)
def test_in_steady_state_the_tracked_outputs_are_the_references(
    p: Controller.Parameters, r_1: float, r_2: float
) -> None:
    a, b, k, s = (np.array(m) for m in (p.a, p.b, p.gain, p.prefilter))
    y, theta, w, beta = -np.linalg.solve(a - b @ k, b @ s @ [r_1, r_2])
    assert [y, theta + beta] == pytest.approx([r_1, r_2], abs=1e-6)
    assert w == pytest.approx(0.0, abs=1e-6)
    front, rear = request(p, Controller.Inputs(y, theta, w, beta, r_1, r_2))
    assert a @ [y, theta, w, beta] + b @ [front, rear] == pytest.approx(np.zeros(4), abs=1e-4)


def request(p: Controller.Parameters, u: Controller.Inputs) -> tuple[float, ...]:
    """The angles asked for in the sample of these inputs."""
    x = Controller.step(p, Controller.initial(p, u), u, DT)
    return dataclasses.astuple(Controller.outputs(p, x))


@given(inputs, inputs)
def test_requests_add_up(u: Controller.Inputs, w: Controller.Inputs) -> None:
    both = [i + j for i, j in zip(dataclasses.astuple(u), dataclasses.astuple(w), strict=True)]
    expected = np.add(request(P, u), request(P, w))
    assert request(P, Controller.Inputs(*both)) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("delay", [1, 2, 3])
def test_a_late_controller_asks_the_same_so_many_samples_later(delay: int) -> None:
    late = dataclasses.replace(P, delay_steps=delay)
    samples = [Controller.Inputs(displacement=math.sin(k)) for k in range(12)]
    prompt_x, late_x = Controller.initial(P, samples[0]), Controller.initial(late, samples[0])
    asked, given_out = [], []
    for u in samples:
        prompt_x, late_x = Controller.step(P, prompt_x, u, DT), Controller.step(late, late_x, u, DT)
        asked.append(Controller.outputs(P, prompt_x))
        given_out.append(Controller.outputs(late, late_x))
    assert given_out[delay:] == asked[:-delay]
    assert given_out[:delay] == [asked[0]] * delay


def test_the_design_is_made_once_for_a_set_of_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Controller.Parameters(speed=33.0).gain != P.gain
    monkeypatch.setattr(design, "stabilizing_solution", lambda *_: pytest.fail("computed again"))
    assert Controller.Parameters(speed=33.0).gain == Controller.Parameters(speed=33.0).gain


IMPOSSIBLE = {
    "no tire force": (
        {"front_cornering_stiffness": 0.0, "rear_cornering_stiffness": 0.0},
        "not stabilizable: no steering moves the eigenvalue 0 1/s of A; front_cornering_stiffness = 0, ",
    ),
    "force on one axle": (
        {"rear_cornering_stiffness": 0.0},
        "not stabilizable.*rear_cornering_stiffness = 0",
    ),
    "no lever": (
        {"front_axle_distance": 0.0, "rear_axle_distance": 0.0},
        "not stabilizable.*front_axle_distance = 0, rear_axle_distance = 0",
    ),
    "the outputs of the paper's text": (
        {"tracked_displacement": 0.0},
        r"no prefilter S: C \(A - B K\)\^-1 B is singular.*tracked_heading = 1, tracked_displacement = 0",
    ),
    "nothing but y' tracked": (
        {"tracked_heading": 0.0, "tracked_displacement": 0.0},
        "no prefilter S.*tracked_heading = 0, tracked_displacement = 0",
    ),
    "displacement for nothing": (
        {"displacement_weight": 0.0},
        "no stabilizing gain K: every state.*yaw_rate_weight = 1, displacement_weight = 0",
    ),
    "displacement for nothing, at a speed of 1 m/s": (
        {"displacement_weight": 0.0, "speed": 1.0},
        "no stabilizing gain K: every state.*yaw_rate_weight = 1, displacement_weight = 0",
    ),
    "no cost at all": (
        {f"{name}_weight": 0.0 for name in ("lateral_velocity", "heading_angle", "yaw_rate", "displacement")},
        "no stabilizing gain K: every state",
    ),
}


@pytest.mark.parametrize(("changed", "message"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_what_cannot_be_is_refused_at_the_start(changed: dict[str, float], message: str) -> None:
    p = dataclasses.replace(P, **changed)
    with pytest.raises(ValueError, match=message):
        Controller.initial(p, Controller.Inputs())


@settings(max_examples=30)
@given(st.lists(inputs, min_size=1, max_size=6), st.sampled_from(TAKEN))
def test_a_status_that_is_good_changes_no_bit(samples: list[Controller.Inputs], status: int) -> None:
    for reads in (True, False):
        p = dataclasses.replace(P, reads_status=reads)
        told = [dataclasses.replace(u, camera_status=status) for u in samples]
        assert requests(p, told) == requests(P, samples)


def requests(p: Controller.Parameters, samples: list[Controller.Inputs]) -> list[Controller.Outputs]:
    """The angles asked for in each sample."""
    x, found = Controller.initial(p, samples[0]), []
    for u in samples:
        x = Controller.step(p, x, u, DT)
        found.append(Controller.outputs(p, x))
    return found


@pytest.mark.parametrize("status", [1, 2, 8, 64])
def test_without_the_camera_the_place_is_predicted_from_the_inertial_sensors(status: int) -> None:
    """(C5): whatever stands at the inputs of the camera."""
    start = Controller.Inputs(0.1, 0.02, 0.05, 0.3)
    blind = [Controller.Inputs(0.1, 9.0, 0.05, 9.0, camera_status=status)] * 3
    theta = [0.02 + 0.05 * DT * k for k in range(4)]
    beta = [0.3]
    for k in range(3):
        beta.append(beta[-1] - DT * (0.1 + P.speed * theta[k]))
    seen = [Controller.Inputs(0.1, theta[k], 0.05, beta[k]) for k in range(4)]
    for found, expected in zip(requests(P, [start, *blind]), requests(P, seen), strict=True):
        assert dataclasses.astuple(found) == pytest.approx(dataclasses.astuple(expected), abs=1e-12)
    # the first frame that is taken counts again, whatever was predicted
    again = Controller.Inputs(0.1, 0.0, 0.05, 0.0)
    assert requests(P, [start, *blind, again])[-1] == requests(P, [again])[-1]


def test_the_steering_fades_to_straight_when_the_camera_stays_away() -> None:
    """(C6), after 0.1 s within 0.2 s."""
    p = dataclasses.replace(P, prediction_time=0.1, fade_time=0.2)
    u = Controller.Inputs(displacement_reference=0.3, camera_status=1)
    asked = [found.front_steering_angle for found in requests(p, [u] * 40)]
    assert asked[:10] == [asked[0]] * 10
    assert asked[19] == pytest.approx(0.5 * asked[0])
    assert asked[30:] == [0.0] * 10
