"""Pages of multiplexed messages that take time: they have one buffer in the queue, against the oracle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.timing.draws import drawn
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender
from support.bus_oracle import Sent, carried

STEPS, STEP = 30, 1e-3
PAGED = st.tuples(st.integers(1, 3), st.integers(1, 3), st.integers(0, 3))
"""The number of pages of a message, its cycle and its first step."""


def path_of(
    messages: Sequence[Message], paged: Sequence[tuple[int, int, int]], use: BusSettings
) -> FramePath:
    """The frame path: all pages of message i are sampled from slot i, each in its turn."""
    plans = []
    for i, (message, (pages, cycle, first)) in enumerate(zip(messages, paged, strict=True)):
        routes = (SignalRoute(message.signals["S"], i, Affine(), ((len(messages), Affine()),)),)
        plans += [
            MessagePlan("can0", message, use, routes, {"S": "a.y"}, pages * cycle, first + page * cycle, None,
                        framing=framing_of(message, use))
            for page in range(pages)
        ]  # fmt: skip # one call
    memory = np.zeros(len(messages) + 1)
    senders = [
        Sender(plan, MessageChannel(plan.message, plan.routes, use), memoryview(memory), None)
        for plan in plans
    ]
    return FramePath(senders, memory, STEP, logs=True)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(PAGED, min_size=1, max_size=4),
    st.sampled_from([0.0, 0.4, 0.999]),
    st.sampled_from([60_000, 125_000, 500_000]),
    st.integers(0, 2**32),
)
def test_the_pages_of_a_message_are_one_message_of_the_oracle(paged, part, bitrate, seed):
    messages = [
        Message("t.dbc", f"M{i}", 7 * i, False, 6, senders=("N",), signals={"S": Signal("S", 0, 48)})
        for i in range(len(paged))
    ]
    late = {m.name: {"jitter": part * p[1] * STEP} for m, p in zip(messages, paged, strict=True)}
    use = BusSettings.model_validate({"timing": "frame", "bitrate": bitrate, "seed": 3, "messages": late})
    path = path_of(messages, paged, use)
    values = np.random.default_rng(seed).integers(0, 2**48, (STEPS, len(messages)))
    plans = [s.plan for s in path._all]
    for k in range(STEPS):
        path.wire.memory[: len(messages)] = values[k].astype(float)
        path.act(*path.operation(Action("arrive", 0)), k)
        for i, plan in enumerate(plans):
            if k >= plan.first and (k - plan.first) % plan.every == 0:
                path.act(*path.operation(Action("send", i)), k)
        path.act(*path.operation(Action("contend", 0)), k)
    sent = [
        Sent(m.name, m.frame_id, False, cycle, first, round(use.jitter_of(m.name) * 1e12), "N")
        for m, (_, cycle, first) in zip(messages, paged, strict=True)
    ]
    pages, name = (
        {s.name: p[0] for s, p in zip(sent, paged, strict=True)},
        int(path.arrays["buses"][0, T.NAME]),
    )

    def share(message: Sent, n: int) -> float:
        instance, page = divmod(n - 1, pages[message.name])
        return drawn(use.seed, name, message.identifier, instance + 1, 1 | page << 8)

    payloads = {
        (m.name, k): int(values[k, i]).to_bytes(6, "little")
        for i, m in enumerate(messages)
        for k in range(STEPS)
    }
    expected = carried(sent, payloads, STEPS, 10**9, round(1e12 / bitrate), share)
    (log,) = path.log_of("can0").frames
    assert [(end, m.name, data) for _, end, m, data in log.frames()] == [
        (frame.end, frame.message.name, frame.payload) for frame in expected
    ]
    rows = path.arrays["messages"]
    replaced = {s.name: int(rows[rows[:, T.ID] == s.identifier, T.REPLACED].sum()) for s in sent}
    assert replaced == {s.name: s.replaced for s in sent}
    waiting = [s for s in sent if s.waiting or s.sampled]
    assert (path.arrays["buses"][0, T.PENDING] > 0) == bool(waiting)
