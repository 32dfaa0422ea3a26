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

from .base import Model, record, var
from .constants import SAME_TIME

QUEUE = 8


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
        requests = [
            x.request_1, x.request_2, x.request_3, x.request_4,
            x.request_5, x.request_6, x.request_7, x.request_8, 0.0,
        ]  # fmt: skip # one place more than the state has
        times = [
            x.time_1, x.time_2, x.time_3, x.time_4,
            x.time_5, x.time_6, x.time_7, x.time_8, 0.0,
        ]  # fmt: skip # of the requests above
        n = _asked(requests, times, x.waiting, max(0.0, u.torque_request), dt)
        torque, impulse, left = x.torque, 0.0, dt
        first = 0
        while left > SAME_TIME:
            y, acts = requests[first], times[first]  # (A1)
            if acts > left + SAME_TIME:
                h = left
                times[first] = acts - h
            else:
                h = min(acts, left)
                first += 1
            end = y + (torque - y) * exp(-p.rate * h)  # (A2)
            impulse += y * h + (torque - end) / p.rate
            torque = end
            left -= h
        if n - first > QUEUE:
            _join(requests, times)
            n -= 1
        _move_up(requests, first, n)
        _move_up(times, first, n)
        return BrakeActuator.State(
            torque, max(0.0, impulse / dt), n - first,
            requests[0], requests[1], requests[2], requests[3],
            requests[4], requests[5], requests[6], requests[7],
            times[0], times[1], times[2], times[3],
            times[4], times[5], times[6], times[7],
        )  # fmt: skip # the lag, requests, times

    @staticmethod
    def outputs(p: BrakeActuator.Parameters, x: BrakeActuator.State) -> BrakeActuator.Outputs:
        """Return the mean torque over the step just made."""
        return BrakeActuator.Outputs(x.mean_torque)


def _asked(requests: list[float], times: list[float], n: int, request: float, dt: float) -> int:
    """Put a request [N.m] that acts for `dt` [s] behind n others; return the number of all."""
    if n > 0 and requests[n - 1] == request:
        times[n - 1] += dt
        return n
    requests[n], times[n] = request, dt
    return n + 1


def _join(requests: list[float], times: list[float]) -> None:
    """Make QUEUE requests of one more: the neighbors that act shortest together become their mean."""
    shortest, i = times[0] + times[1], 0
    for j in range(1, QUEUE):
        if times[j] + times[j + 1] < shortest:
            shortest, i = times[j] + times[j + 1], j
    requests[i] = (requests[i] * times[i] + requests[i + 1] * times[i + 1]) / shortest
    times[i] = shortest
    for j in range(i + 1, QUEUE):
        requests[j], times[j] = requests[j + 1], times[j + 1]


def _move_up(values: list[float], first: int, n: int) -> None:
    """Move the values from `first` to n to the front; 0 stands behind them."""
    for i in range(QUEUE):
        values[i] = values[first + i] if first + i < n else 0.0
