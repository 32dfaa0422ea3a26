"""Frames that take time: against an oracle of events, and in both engines."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.timing.draws import drawn
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.system.system import system_names
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender
from evcosim.master.simulation import Simulation
from support.bus_oracle import Sent, carried
from support.timed import timed

STEPS, STEP = 30, 1e-3


@st.composite
def buses(draw: st.DrawFn) -> tuple[list[Message], list[tuple[int, int]], BusSettings]:
    """Messages of one signal that fills them, with their cycles and first steps, and a bus."""
    count = draw(st.integers(1, 6))
    ids = draw(st.lists(st.tuples(st.integers(0, 0x7FF), st.booleans()), min_size=count, max_size=count,
                        unique=True))  # fmt: skip # one call
    messages = []
    for i, (number, extended) in enumerate(ids):
        length = draw(st.integers(1, 6))
        signal = Signal("S", 0, 8 * length)
        identifier = number << 18 | draw(st.integers(0, 2**18 - 1)) if extended else number
        messages.append(
            Message("test.dbc", f"M{i}", identifier, extended, length, senders=("N",), signals={"S": signal})
        )
    times = [(draw(st.integers(1, 4)), draw(st.integers(0, 3))) for _ in messages]
    use = BusSettings(
        timing="frame",
        bitrate=draw(st.sampled_from([83_333, 125_000, 500_000, 1_000_000])),
        jitter=draw(st.sampled_from([0.0, 2e-4, 9e-4])),
        delay=draw(st.sampled_from([0.0, 1e-3, 2.3e-3])),
        seed=draw(st.integers(0, 3)),
    )
    return messages, times, use


def path_of(messages, times, use) -> tuple[FramePath, np.ndarray]:
    """The frame path: message i is sampled from slot i and received in the slot behind all of those."""
    memory = np.zeros(2 * len(messages))
    senders = []
    for i, (message, (every, first)) in enumerate(zip(messages, times, strict=True)):
        routes = (SignalRoute(message.signals["S"], i, Affine(), ((len(messages) + i, Affine()),)),)
        plan = MessagePlan("can0", message, use, routes, {"S": "a.y"}, every, first, None,
                           framing=framing_of(message, use))  # fmt: skip # one call
        senders.append(Sender(plan, MessageChannel(message, routes, use), memoryview(memory), None))
    return FramePath(senders, memory, STEP, logs=True), memory


@settings(deadline=None, max_examples=60)
@given(buses(), st.integers(0, 2**32))
def test_who_is_carried_when_and_what_is_seen(case, seed):
    messages, times, use = case
    path, memory = path_of(messages, times, use)
    values = np.random.default_rng(seed).integers(0, 2**48, (STEPS, len(messages)))
    values %= [1 << 8 * m.length for m in messages]
    received = np.zeros((STEPS, len(messages)))
    for k in range(STEPS):
        memory[: len(messages)] = values[k]
        path.act(*path.operation(Action("arrive", 0)), k)
        received[k] = memory[len(messages) :]
        for i, (every, first) in enumerate(times):
            if k >= first and (k - first) % every == 0:
                path.act(*path.operation(Action("send", i)), k)
        path.act(*path.operation(Action("contend", 0)), k)
    sent = [
        Sent(m.name, m.frame_id, m.extended, every, first, round(use.jitter * 1e12))
        for m, (every, first) in zip(messages, times, strict=True)
    ]
    payloads = {
        (m.name, k): int(values[k, i]).to_bytes(m.length, "little")
        for i, m in enumerate(messages)
        for k in range(STEPS)
    }
    name = int(path.arrays["buses"][0, T.NAME])
    expected = carried(
        sent, payloads, STEPS, 10**9, round(1e12 / use.bitrate),
        lambda m, n: drawn(use.seed, name, m.identifier | m.extended << 29, n, 1),
    )  # fmt: skip # one call
    log = path.log_of("can0").frames
    assert [(end, m.name, data) for _, end, m, data in log.frames()] == [
        (frame.end, frame.message.name, frame.payload) for frame in expected
    ]
    counts = {row[T.ID]: row for row in path.arrays["messages"].tolist()}
    assert [counts[s.identifier][T.REPLACED] for s in sent] == [s.replaced for s in sent]
    for k, (i, m) in itertools.product(range(STEPS), enumerate(messages)):
        seen = [
            f for f in expected if f.message.name == m.name and f.end + round(use.delay * 1e12) <= k * 10**9
        ]
        assert received[k, i] == (int.from_bytes(seen[-1].payload, "little") if seen else 0.0)


def ran(tmp_path, engine, system, **options):
    """The bits of a run, its log, and the tables of counts."""
    with Simulation(system, engine=engine, isolation="none", log_frames=True, **options) as simulation:
        simulation.step(min(200, simulation.plan.steps))
        simulation.write_can_log(tmp_path / "bus.log")
        arrays = simulation._engine.frames.arrays
        counted = arrays["messages"].tobytes() + arrays["nodes"].tobytes() + arrays["buses"].tobytes()
        return simulation.results.data.tobytes(), (tmp_path / "bus.log").read_bytes(), counted


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("name", system_names())
def test_both_engines_are_equal(tmp_path, name, algorithm):
    system = timed(name, jitter=0.004, bit_error_rate=2e-3, seed=5, delay=0.0007)
    python = ran(tmp_path, "python", system, algorithm=algorithm)
    assert ran(tmp_path, "compiled", system, algorithm=algorithm) == python
    assert python[1]


def test_at_10_ms_steps_every_frame_is_seen_one_step_later(tmp_path):
    """As with a delay of one step: our systems load a bus of 500 kbit/s with less."""
    by_time = ran(tmp_path, "compiled", timed("scooter"))[0]
    assert by_time == ran(tmp_path, "compiled", "scooter", delay=0.01)[0]


def test_a_seed_is_another_noise_and_the_same_one_the_same(tmp_path):
    logs = [
        ran(tmp_path, "compiled", timed("scooter", bit_error_rate=1e-3, seed=seed))[1] for seed in (1, 1, 2)
    ]
    assert logs[0] == logs[1] != logs[2]
