"""BrakeActuator: a pure delay and a first-order lag from the requested torque to the brake's torque.

Source: Tanelli, Prandini, Codecà, Moia, Savaresi, "Analysing the interaction between braking control and
speed estimation: the case of two-wheeled vehicles", IEEE CDC 2008.

    y(t) = T_request(t - delay),  0 before the first request                   torque [N.m]      (A1)
    T' = 2 pi f (y - T)                                                                          (A2)

The output is the mean of T over the step just made, so that a wheel that holds it over the next step receives
the exact impulse ("Derivations" in docs/systems/braking.md).

published: f = 10 Hz, delay = 10 ms.
chosen: a negative request counts as 0; QUEUE = 8.

At the edges: at the start the brake is empty (T = 0). The state is a queue of the requests on their way, each
with the time for which it acts; a request equal to the one before only makes that one act longer. Of more
than QUEUE different requests, the two neighbors that act shortest together become their mean: no impulse is
lost, and (A1) is blurred over 2 delay/QUEUE = 2.5 ms, a sixth of the lag.

Step: (A1) and (A2) are solved exactly for requests that are held from step to step, for every step size and
delay, as long as the queue holds them.
"""

from __future__ import annotations

from functools import cached_property
from math import exp, pi
from operator import attrgetter

from .base import Model, record, var
from .constants import SAME_TIME

QUEUE = 8

Waiting = tuple[float, float]  # a request [N.m], and the time for which it acts [s]


class BrakeActuator(Model):
    """Requested torque in, brake torque out."""

    @record
    class Parameters:
        """The brake; published."""

        bandwidth: float = var(10.0, "Hz", "Bandwidth of the first-order lag (f)", min=1e-3)
        delay: float = var(0.01, "s", "Pure delay before the lag", min=0.0)

        @cached_property
        def rate(self) -> float:
            """2 pi f [1/s]."""
            return 2.0 * pi * self.bandwidth

    @record
    class Inputs:
        """The request of the controller."""

        torque_request: float = var(0.0, "N.m", "Torque asked for; negative counts as 0", nominal=100.0)

    @record
    class State:
        """The lag, and the requests on their way from the oldest: value, and time for which each acts."""

        torque: float = var(0.0, "N.m", "Torque now (T)")
        mean_torque: float = var(0.0, "N.m", "Mean of the torque over the last step")
        waiting: int = var(0, "", "Number of requests on their way", min=0, max=QUEUE)
        request_1: float = var(0.0, "N.m", "Oldest request on its way")
        request_2: float = var(0.0, "N.m", "Second request")
        request_3: float = var(0.0, "N.m", "Third request")
        request_4: float = var(0.0, "N.m", "Fourth request")
        request_5: float = var(0.0, "N.m", "Fifth request")
        request_6: float = var(0.0, "N.m", "Sixth request")
        request_7: float = var(0.0, "N.m", "Seventh request")
        request_8: float = var(0.0, "N.m", "Eighth request")
        time_1: float = var(0.0, "s", "For how long the oldest request acts")
        time_2: float = var(0.0, "s", "For how long the second request acts")
        time_3: float = var(0.0, "s", "For how long the third request acts")
        time_4: float = var(0.0, "s", "For how long the fourth request acts")
        time_5: float = var(0.0, "s", "For how long the fifth request acts")
        time_6: float = var(0.0, "s", "For how long the sixth request acts")
        time_7: float = var(0.0, "s", "For how long the seventh request acts")
        time_8: float = var(0.0, "s", "For how long the eighth request acts")

    @record
    class Outputs:
        """The torque on the wheel."""

        torque: float = var(0.0, "N.m", "Brake torque, mean over the last step", min=0.0, nominal=100.0)

    @staticmethod
    def initial(p: BrakeActuator.Parameters, u: BrakeActuator.Inputs) -> BrakeActuator.State:
        """Return an empty brake: no torque, and a request of 0 for the length of the delay."""
        if p.delay <= SAME_TIME:
            return BrakeActuator.State()
        return BrakeActuator.State(waiting=1, time_1=p.delay)

    @staticmethod
    def step(
        p: BrakeActuator.Parameters, x: BrakeActuator.State, u: BrakeActuator.Inputs, dt: float
    ) -> BrakeActuator.State:
        """Return the torque after `dt` [s] of a held request, its mean over that time, and the queue."""
        queue = list(zip(_requests(x)[: x.waiting], _times(x)[: x.waiting], strict=True))
        request = max(0.0, u.torque_request)
        if queue and queue[-1][0] == request:
            queue[-1] = (request, queue[-1][1] + dt)
        else:
            queue.append((request, dt))
        torque, impulse, left = x.torque, 0.0, dt
        while left > SAME_TIME:
            y, acts = queue[0]  # (A1)
            if acts > left + SAME_TIME:
                h = left
                queue[0] = (y, acts - h)
            else:
                h = min(acts, left)
                queue.pop(0)
            end = y + (torque - y) * exp(-p.rate * h)  # (A2)
            impulse += y * h + (torque - end) / p.rate
            torque = end
            left -= h
        return _state(torque, impulse / dt, _joined(queue))

    @staticmethod
    def outputs(p: BrakeActuator.Parameters, x: BrakeActuator.State) -> BrakeActuator.Outputs:
        """Return the mean torque over the step just made."""
        return BrakeActuator.Outputs(x.mean_torque)


_NUMBERS = range(1, QUEUE + 1)
_requests = attrgetter(*(f"request_{i}" for i in _NUMBERS))
_times = attrgetter(*(f"time_{i}" for i in _NUMBERS))
_NONE = (0.0,) * QUEUE


def _joined(queue: list[Waiting]) -> list[Waiting]:
    """Return at most QUEUE requests: the neighbors that act shortest together become their mean."""
    while len(queue) > QUEUE:
        i = min(range(len(queue) - 1), key=lambda j: queue[j][1] + queue[j + 1][1])
        (a, time_a), (b, time_b) = queue[i : i + 2]
        time = time_a + time_b
        queue[i : i + 2] = [((a * time_a + b * time_b) / time, time)]
    return queue


def _state(torque: float, mean: float, queue: list[Waiting]) -> BrakeActuator.State:
    n = len(queue)
    requests = (*(request for request, _ in queue), *_NONE[n:])
    times = (*(time for _, time in queue), *_NONE[n:])
    return BrakeActuator.State(torque, max(0.0, mean), n, *requests, *times)
