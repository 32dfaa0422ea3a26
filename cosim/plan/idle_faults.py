"""Faults of a scenario, and their keys, that do nothing in a run, with what would make them count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..clock import Clock, picoseconds
from ..system.fault_spec import Babble, BusOff, Delay, FrameFault, Freeze, Lose
from .nodes import hits
from .plan import FaultPlan, MessagePlan


def idle_faults(
    faults: Sequence[FaultPlan], messages: Sequence[MessagePlan], clock: Clock, path: str
) -> list[str]:
    """Return a sentence for each fault of the file `path`, or key of one, that changes nothing."""
    found: list[str] = []
    for number, plan in enumerate(faults, 1):
        if not isinstance(plan.fault, BusOff | Babble):
            own = [message for message in messages if hits(plan, message)]
            found += _idle(plan, plan.fault, own, clock, f"{path}: fault {number}")
    return found


def _idle(
    plan: FaultPlan, fault: FrameFault, messages: Sequence[MessagePlan], clock: Clock, place: str
) -> Iterator[str]:
    if fault.probability == 0.0:
        yield f"{place}.probability = 0 hits no frame; without it all are hit"
    elif fault.seed and fault.probability == 1.0:
        yield (
            f"{place}.seed = {fault.seed} does nothing: each frame is hit; it counts with a `probability` "
            "below 1"
        )
    if isinstance(fault, Freeze) and fault.counter == "frozen" and not any(map(_counts, messages)):
        yield (
            f'{place}.counter = "frozen" does nothing: no message that it hits has a counter; it counts with '
            "`e2e`, or with a `checksum_counter`"
        )
    if isinstance(fault, Lose | Delay) and not any(map(_heard, messages)):
        what = "that frames are lost" if isinstance(fault, Lose) else "that frames are late"
        yield f"{place}: nobody receives what it hits: {what} changes nothing but counts and logs"
    if plan.until > 0 and not any(_met(plan, message, clock) for message in messages):
        begin, end = (clock.start + time * 1e-12 for time in (plan.since, plan.until))
        yield (
            f"{place} hits no frame: none is sampled from {begin:.9g} s on and before {end:.9g} s; give it a "
            "longer `duration`"
        )


def _counts(message: MessagePlan) -> bool:
    protection = message.framing.protection if message.framing is not None else None
    return protection is not None and protection.counter is not None


def _heard(message: MessagePlan) -> bool:
    status = message.framing.status if message.framing is not None else ()
    return bool(status) or any(route.sinks for route in message.routes)


def _met(plan: FaultPlan, message: MessagePlan, clock: Clock) -> bool:
    """Return False where a fault ends between two of the times at which a message may be sampled."""
    if message.replayed:
        return True
    step = picoseconds(clock.step)
    due = -(-plan.since // step)  # the first step in its time
    due = max(message.first, message.first - (message.first - due) // message.every * message.every)
    return due * step < plan.until
