"""BrakeActuator: closed form of lag and delay, any step size, nothing lost on the way."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.models.brake_actuator import QUEUE, BrakeActuator

P = BrakeActuator.Parameters()
RATE = 2.0 * math.pi * 10.0
State = BrakeActuator.State


def run(
    requests: list[float], dt: float = 0.01, p: BrakeActuator.Parameters = P, splits: int = 1
) -> list[State]:
    """The states after each request, held for `dt` in `splits` steps."""
    x = BrakeActuator.initial(p, BrakeActuator.Inputs())
    found = []
    for request in requests:
        for _ in range(splits):
            x = BrakeActuator.step(p, x, BrakeActuator.Inputs(request), dt / splits)
        found.append(x)
    return found


def test_a_step_arrives_after_the_delay_and_rises_with_the_lag() -> None:
    for k, x in enumerate(run([100.0] * 20), 1):
        t = max(0.0, 0.01 * k - 0.01)
        assert x.torque == pytest.approx(100.0 * (1.0 - math.exp(-RATE * t)), abs=1e-10)


def test_what_it_shows_is_the_mean_over_the_step() -> None:
    """The integral of y - T over a step is (T_1 - T_0)/(2 pi f)."""
    x = run([100.0, 300.0, 50.0])
    shown = [BrakeActuator.outputs(P, s).torque for s in x]
    assert shown[0] == 0.0
    for k, delayed in ((1, 100.0), (2, 300.0)):
        assert shown[k] == pytest.approx(delayed - (x[k].torque - x[k - 1].torque) / (RATE * 0.01), abs=1e-9)


@settings(max_examples=60)
@given(
    st.lists(st.floats(0.0, 2000.0), min_size=1, max_size=12),
    st.sampled_from([0.0, 0.004, 0.01, 0.0137, 0.03, 0.05]),
    st.integers(2, 7),
)
def test_the_step_size_does_not_matter(requests: list[float], delay: float, splits: int) -> None:
    p = BrakeActuator.Parameters(delay=delay)
    once, often = run(requests, p=p), run(requests, p=p, splits=splits)
    assert [x.torque for x in often] == pytest.approx([x.torque for x in once], abs=1e-6)


@pytest.mark.parametrize("delay", [0.01, 0.02, 0.03, 0.045])
def test_a_delay_is_a_shift(delay: float) -> None:
    requests = [float(37 * k % 400) for k in range(30)]
    late = run([r for r in requests for _ in range(2)], 0.005, BrakeActuator.Parameters(delay=delay))
    early = run([r for r in requests for _ in range(2)], 0.005, BrakeActuator.Parameters(delay=0.0))
    shift = round(delay / 0.005)
    assert [x.torque for x in late[shift:]] == pytest.approx([x.torque for x in early[:-shift]], abs=1e-6)


def test_the_means_add_up_to_the_impulse_even_of_too_many_requests() -> None:
    """At 1 kHz more requests are on their way than the queue holds: blurred, but not lost."""
    requests = [float(37 * k % 400) for k in range(100)] + [0.0] * 400
    x = run(requests, 0.001)
    assert max(s.waiting for s in x) == QUEUE
    assert sum(s.mean_torque for s in x) == pytest.approx(sum(requests), rel=1e-6)
    exact = run(requests, 0.001, BrakeActuator.Parameters(delay=0.0))
    worst = max(abs(a.torque - b.torque) for a, b in zip(x[10:], exact, strict=False))
    assert worst < RATE * 0.00125 * 400.0  # a jump that arrives 1.25 ms early or late


def test_time_does_not_leak() -> None:
    """After many steps of a size that has no exact binary form, the delay is the same."""
    x = run([float(k % 3) for k in range(20000)])[-1]
    assert x.waiting == 1
    assert x.time_1 == pytest.approx(0.01, abs=1e-12)


def test_a_negative_request_is_none() -> None:
    assert run([-50.0] * 5)[-1] == run([0.0] * 5)[-1]


Waiting = list[tuple[float, float]]


def by_a_list(p: BrakeActuator.Parameters, queue: Waiting, torque: float, request: float, dt: float) -> float:
    """The torque after a step, of a queue [(request, time)] that grows and shrinks."""
    if queue and queue[-1][0] == request:
        queue[-1] = (request, queue[-1][1] + dt)
    else:
        queue.append((request, dt))
    left = dt
    while left > 1e-9:
        y, acts = queue.pop(0)
        h = left if acts > left + 1e-9 else min(acts, left)
        if acts > left + 1e-9:
            queue.insert(0, (y, acts - h))
        torque = y + (torque - y) * math.exp(-p.rate * h)
        left -= h
    if len(queue) > QUEUE:
        i = min(range(QUEUE), key=lambda j: queue[j][1] + queue[j + 1][1])
        (a, time_a), (b, time_b) = queue[i : i + 2]
        time = time_a + time_b
        queue[i : i + 2] = [((a * time_a + b * time_b) / time, time)]
    return torque


@settings(max_examples=60)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.sampled_from([0.001, 0.0013, 0.004, 0.01, 0.05])), max_size=60),
    st.sampled_from([0.0, 0.004, 0.01, 0.0137, 0.05]),
)
def test_the_places_of_the_state_are_a_queue_to_the_last_bit(
    steps: list[tuple[int, float]], delay: float
) -> None:
    p = BrakeActuator.Parameters(delay=delay)
    x = BrakeActuator.initial(p, BrakeActuator.Inputs())
    queue, torque = [(0.0, delay)] if delay else [], 0.0
    for request, dt in steps:
        x = BrakeActuator.step(p, x, BrakeActuator.Inputs(float(request)), dt)
        torque = by_a_list(p, queue, torque, float(request), dt)
        padded = [*queue, *[(0.0, 0.0)] * (QUEUE - len(queue))]
        assert (x.torque, x.waiting) == (torque, len(queue))
        assert [getattr(x, f"request_{i}") for i in range(1, QUEUE + 1)] == [value for value, _ in padded]
        assert [getattr(x, f"time_{i}") for i in range(1, QUEUE + 1)] == [time for _, time in padded]
