"""Wire errors and CAN FD against an oracle of events: who is carried when, error counters, bus-off."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.timing.draws import drawn
from evcosim.cosim.can.timing.lengths import fd_bits
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender
from support.bus_oracle import Sent
from support.noisy_oracle import NoisyBus, Rates, fd_times

STEPS, STEP, PS = 60, 1e-3, 10**9


def message(name: str, identifier: int, length: int, sender: str, extended: bool, fd: bool) -> Message:
    """A message with one signal in the first of its bytes, six at most."""
    signals = {"S": Signal("S", 0, min(8 * length, 48))} if length else {}
    return Message("t.dbc", name, identifier, extended, length, senders=(sender,), signals=signals, fd=fd)


LAST_ONE_BREAKS = (
    [message("M0", 144 << 18, 64, "A", True, True), message("M1", 145, 1, "B", False, False)],
    [(1, 0), (1, 0)],
    BusSettings(timing="frame", bitrate=125_000, bit_error_rate=1e-3),
)
"""A bus on which an error ends the frame that has it at the end, while a newer one of its message waits."""


@st.composite
def noisy_buses(draw: st.DrawFn) -> tuple[list[Message], list[tuple[int, int]], BusSettings]:
    """Messages, classic and of CAN FD, of two or five nodes, with cycles and first steps; a noisy bus."""
    fd = draw(st.booleans())
    count, nodes = draw(st.integers(1, 5)), draw(st.sampled_from([2, 5]))
    ids = draw(st.lists(st.tuples(st.integers(0, 0x7FF), st.booleans()), min_size=count, max_size=count,
                        unique=True))  # fmt: skip # one call
    messages = []
    for i, (number, extended) in enumerate(ids):
        wide = fd and draw(st.booleans())
        length = draw(st.sampled_from([0, 5, 8, 12, 16, 20, 24, 32, 48, 64] if wide else [1, 4, 6, 8]))
        identifier = number << 18 | draw(st.integers(0, 2**18 - 1)) if extended else number
        messages.append(message(f"M{i}", identifier, length, "ABCDE"[i % nodes], extended, wide))
    times = [(draw(st.integers(1, 4)), draw(st.integers(0, 3))) for _ in messages]
    part = draw(st.sampled_from([0.0, 0.0, 0.3, 0.98]))  # of the cycle
    use = BusSettings(
        timing="frame",
        bitrate=draw(st.sampled_from([125_000, 500_000])),
        data_bitrate=draw(st.sampled_from([None, 2_000_000])) if fd else None,
        bit_error_rate=draw(st.sampled_from([1e-5, 1e-3, 4e-3, 0.02, 0.3])),
        seed=draw(st.integers(0, 50)),
        messages={
            m.name: {"jitter": part * every * STEP} for m, (every, _) in zip(messages, times, strict=True)
        },
    )
    return messages, times, use


@settings(deadline=None, max_examples=120)
@given(noisy_buses(), st.integers(0, 2**32))
@example(LAST_ONE_BREAKS, 0)
def test_frames_counters_and_bus_off_are_those_of_the_oracle(case, seed):
    messages, times, use = case
    count = len(messages)
    memory = np.zeros(2 * count)
    plans = []
    for i, (message, (every, first)) in enumerate(zip(messages, times, strict=True)):
        routes = tuple(
            SignalRoute(s, i, Affine(), ((count + i, Affine()),)) for s in message.signals.values()
        )
        plans.append(MessagePlan("can0", message, use, routes, {}, every, first, None,
                                 framing=framing_of(message, use)))  # fmt: skip # one call
    senders = [
        Sender(plan, MessageChannel(plan.message, plan.routes, use), memoryview(memory), None)
        for plan in plans
    ]
    path = FramePath(senders, memory, STEP, logs=True)
    values = np.random.default_rng(seed).integers(0, 2**48, (STEPS, count))
    values %= [1 << 8 * min(m.length, 6) for m in messages]
    for k in range(STEPS):
        memory[:count] = values[k]
        path.act(*path.operation(Action("arrive", 0)), k)
        for i, (every, first) in enumerate(times):
            if k >= first and (k - first) % every == 0:
                path.act(*path.operation(Action("send", i)), k)
        path.act(*path.operation(Action("contend", 0)), k)

    rates = Rates(
        *(round(1e12 / (r or use.bitrate)) for r in (use.bitrate, use.data_bitrate)),
        use.data_bitrate is not None,
    )
    name = int(path.arrays["buses"][0, T.NAME])
    sent = [
        Sent(m.name, m.frame_id, m.extended, every, first, round(use.jitter_of(m.name) * 1e12), m.senders[0],
             fd=m.fd)
        for m, (every, first) in zip(messages, times, strict=True)
    ]  # fmt: skip # one call
    wrong, late = (
        lambda m, n, purpose=purpose: drawn(use.seed, name, m.identifier | m.extended << 29, n, purpose)
        for purpose in (2, 1)
    )
    bus = NoisyBus(sent, rates, use.bit_error_rate, wrong, late)
    payloads = {
        (m.name, k): int(values[k, i]).to_bytes(6, "little")[: m.length].ljust(m.length, b"\0")
        for i, m in enumerate(messages)
        for k in range(STEPS)
    }
    expected = bus.carried(payloads, STEPS, PS)
    (log,) = path.log_of("can0").frames
    assert [(end, m.name, data) for _, end, m, data in log.frames()] == [
        (frame.end, frame.message.name, frame.payload) for frame in expected
    ]
    rows = {(row[T.ID], row[T.EXTENDED]): row for row in path.arrays["messages"].tolist()}
    for s in sent:
        row = rows[s.identifier, s.extended]
        assert (row[T.REPLACED], row[T.CARRIED] + row[T.ERRORS]) == (s.replaced, bus.attempts[s.name])
    columns = [T.ERROR_COUNT, T.RECEIVE_COUNT, T.BUS_OFFS]
    counted = path.arrays["nodes"][:, columns].tolist()
    assert counted == [[n.tec, n.rec, n.offs] for n in (bus.nodes[node] for _, node in path.nodes)]


@pytest.mark.parametrize("length", [0, 1, 7, 8, 12, 16, 20, 24, 32, 48, 64])
@pytest.mark.parametrize("extended", [False, True])
@pytest.mark.parametrize("switch", [False, True])
def test_bits_of_can_fd_are_those_of_the_oracle(length, extended, switch):
    chance = np.random.default_rng(length)
    for _ in range(20):
        few = chance.choice([0, 255, 0x55, 0x0F], length)
        payload = [int(byte) for byte in chance.choice([few, chance.integers(0, 256, length)])]
        identifier = int(chance.integers(0, 1 << (29 if extended else 11)))
        times = fd_times(
            Sent("M", identifier, extended, 1, 0, 0, fd=True), bytes(payload), Rates(7, 3, switch)
        )
        nominal, fast = fd_bits(identifier, extended, payload, 0, length, switch)
        assert (times.count(7), times.count(3)) == (nominal, fast)
