"""The longest response times of the messages on a bus, before any run.

R. I. Davis, A. Burns, R. J. Bril, J. J. Lukkien: Controller Area Network (CAN) schedulability analysis:
Refuted, revisited and revised. Real-Time Systems 35 (2007). With C the time of a message's longest frame, T
its cycle, J its jitter of queueing, B the longest of the frames of lower priority, all in whole ps:

    busy period of m   t = B + sum over k >= m of ceil((t + J_k) / T_k) C_k
    instance q of it   w = B + q C + sum over k > m of ceil((w + J_k + tau) / T_k) C_k
    response time      R = max over q of J + w - q T + C

k > m stands for the messages of higher priority; tau is the time of a bit. Start delays are left out of
account, so that R holds for any phases. R counts from the sampling, to which a jitter belongs, to the end of
the frame: without the interframe space, which the next frame has to wait for.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from fractions import Fraction

_MOST = 10**6  # instances or rounds; more stand for a bus that is never free


@dataclasses.dataclass(frozen=True)
class Sent:
    """A message on a bus for the analysis: all times in ps.

    `key` is its arbitration key, `time` that of its longest frame with the interframe space, `cycle` the
    least time between two of them, `jitter` the longest from sampling to queueing.
    """

    name: str
    key: int
    time: int
    cycle: int
    jitter: int = 0


def response_times(messages: Sequence[Sent], bit: int, interframe: int = 0) -> dict[str, int | None]:
    """Return the longest response time [ps] of each message by name; None: it has no bound.

    `bit` is the time of a bit of the arbitration, `interframe` that of the interframe space, both in ps.
    """
    ordered = sorted(messages, key=lambda m: m.key)
    found = {}
    for i, message in enumerate(ordered):
        blocked = max((m.time for m in ordered[i + 1 :]), default=0)
        longest = _response(message, ordered[:i], blocked, bit)
        found[message.name] = None if longest is None else longest - interframe
    return {m.name: found[m.name] for m in messages}


def _response(message: Sent, higher: Sequence[Sent], blocked: int, bit: int) -> int | None:
    # exact in integers: the busy period ends only where these messages leave time
    if _fills_the_bus([*higher, message]):
        return None
    busy = _busy_period([*higher, message], blocked, message.time)
    if busy is None:
        return None
    count, longest = _ceil(busy + message.jitter, message.cycle), 0
    if count > _MOST:
        return None
    wait = blocked
    for q in range(count):
        wait = max(wait, blocked + q * message.time)
        found = _waiting(higher, blocked + q * message.time, wait, bit)
        if found is None:
            return None
        wait = found
        longest = max(longest, message.jitter + wait - q * message.cycle + message.time)
    return longest


def _fills_the_bus(messages: Sequence[Sent]) -> bool:
    return sum(Fraction(m.time, m.cycle) for m in messages) >= 1


def _busy_period(messages: Sequence[Sent], blocked: int, first: int) -> int | None:
    time = first
    for _ in range(_MOST):
        longer = blocked + sum(_ceil(time + m.jitter, m.cycle) * m.time for m in messages)
        if longer <= time:
            return time
        time = longer
    return None


def _waiting(higher: Sequence[Sent], least: int, wait: int, bit: int) -> int | None:
    for _ in range(_MOST):
        longer = least + sum(_ceil(wait + m.jitter + bit, m.cycle) * m.time for m in higher)
        if longer <= wait:
            return wait
        wait = longer
    return None


def _ceil(a: int, b: int) -> int:
    return -(-a // b)
