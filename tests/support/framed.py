"""Plans whose messages all take the frame path, and messages with random layouts."""

from __future__ import annotations

import dataclasses

from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import Framing
from evcosim.cosim.plan.plan import MessagePlan, Plan


def framed(plan: Plan) -> Plan:
    """The plan with a framing for each message: frames end in mailboxes, also where there is a delay."""
    return dataclasses.replace(plan, messages=tuple(_framed(message) for message in plan.messages))


def _framed(plan: MessagePlan) -> MessagePlan:
    mailbox = dict(plan.arrivals)
    routes = tuple(
        dataclasses.replace(route, sinks=tuple((mailbox.get(slot, slot), map_) for slot, map_ in route.sinks))
        for route in plan.routes
    )
    return dataclasses.replace(plan, routes=routes, arrivals=(), framing=Framing())


@st.composite
def layouts(draw: st.DrawFn, bytes_: int = 0) -> Message:
    """A message with signals in both byte orders that share no bit."""
    length = bytes_ or draw(st.sampled_from([1, 2, 3, 7, 8, 12, 64]))
    taken: set[int] = set()
    signals: dict[str, Signal] = {}
    for i in range(draw(st.integers(1, 8))):
        is_float = draw(st.integers(0, 4)) == 0
        bits = draw(st.sampled_from([32, 64]) if is_float else st.integers(1, 64))
        signal = Signal(
            f"S{i}",
            draw(st.integers(0, 8 * length - 1)),
            bits,
            little_endian=draw(st.booleans()),
            signed=draw(st.booleans()),
            is_float=is_float,
        )
        own = set(signal.bits)
        if max(own) < 8 * length and not own & taken:
            taken |= own
            signals[signal.name] = signal
    return Message("test.dbc", "M", 0x123, length=length, signals=signals, fd=length > 8)
