"""Frames that take time: against an oracle of events, and in both engines."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.send_types import Sending
from evcosim.cosim.can.timing.draws import drawn
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.faults import babblers, framed, planned
from evcosim.cosim.plan.plan import FaultPlan, MessagePlan
from evcosim.cosim.system.fault_spec import Babble, BusOff, Delay, Fault
from evcosim.cosim.system.system import system_names
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.fault_tables import hits_of
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender
from evcosim.master.simulation import Simulation
from support.bus_oracle import Babbler, Frame, Off, Sent, carried, requested
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
        delay=draw(st.sampled_from([0.0, 1e-3, 2.3e-3])),
        seed=draw(st.integers(0, 3)),
    )
    return messages, times, use


def path_of(messages, times, use, faults, sendings) -> tuple[FramePath, np.ndarray, Sequence[FaultPlan]]:
    """The frame path: message i is sampled from slot i and received in the slot behind all of those."""
    memory = np.zeros(2 * len(messages))
    plans = []
    for i, (message, (every, first), sending) in enumerate(zip(messages, times, sendings, strict=False)):
        routes = (SignalRoute(message.signals["S"], i, Affine(), ((len(messages) + i, Affine()),)),)
        plans.append(MessagePlan("can0", message, use, routes, {"S": "a.y"}, every, first, None,
                                 framing=framing_of(message, use), sending=sending))  # fmt: skip # one call
    found = planned(faults, plans, 0.0, "test.toml")
    plans = [*framed(plans, found), *babblers(found, plans)]
    senders = [
        Sender(plan, MessageChannel(plan.message, plan.routes, use), memoryview(memory), None)
        for plan in plans
    ]
    return FramePath(senders, memory, STEP, logs=True, faults=found), memory, found


def faults_of(draw: st.DrawFn, messages: list[Message]) -> list[Fault]:
    """Late frames of the first message, the node A off the bus, and an identifier that nobody else has."""
    times = {"time": draw(st.integers(0, 20)) / 1e3 + draw(st.sampled_from([0.0, 3.3e-4]))}
    times["duration"] = draw(st.integers(1, 12)) / 1e3 - draw(st.sampled_from([0.0, 4.7e-4]))
    found: list[Fault] = []
    if draw(st.booleans()):
        late = draw(st.sampled_from([3e-4, 2e-3, 5.1e-3]))
        found.append(Delay(action="delay", message="can0.M0", by=late, **times))
    if draw(st.booleans()):
        found.append(BusOff(action="bus_off", node="can0.A", **times))
    if draw(st.booleans()):
        taken = {m.frame_id for m in messages if not m.extended}
        number = next(i for i in range(draw(st.sampled_from([0, 0x400])), 0x7FF) if i not in taken)
        period = draw(st.sampled_from([None, 1e-4, 7.3e-4, 2e-3]))
        where = draw(st.sampled_from([{"bus": "can0"}, {"node": "can0.A"}]))
        length = draw(st.integers(0, 8))
        found.append(Babble(action="babble", id=number, period=period, length=length, **where, **times))
    return found


@st.composite
def faulty_buses(draw: st.DrawFn) -> tuple[Any, ...]:
    """A bus of `buses`, whose messages are of the nodes A and B in turn, and faults on it."""
    messages, times, use = draw(buses())
    messages = [dataclasses.replace(m, senders=("AB"[i % 2],)) for i, m in enumerate(messages)]
    return messages, times, use, faults_of(draw, messages)


SENDINGS = st.builds(
    Sending,
    kind=st.sampled_from(["cyclic", "on_change", "cyclic_and_on_change", "if_active", "on_write"]),
    cycle=st.integers(1, 6),
    interval=st.integers(0, 5),
)


@settings(deadline=None, max_examples=100)
@given(
    faulty_buses(),
    st.lists(SENDINGS, min_size=6, max_size=6),
    st.sampled_from([0.0, 0.2, 0.9, 0.999]),
    st.integers(0, 2**32),
)
def test_who_is_carried_when_and_what_is_seen(case, sendings, part, seed):
    messages, times, use, faults = case
    times = [
        (every, first) if sending.kind == "cyclic" else (1, first)
        for (every, first), sending in zip(times, sendings, strict=False)
    ]
    apart = [
        every if s.kind == "cyclic" else max(every, s.interval)
        for (every, _), s in zip(times, sendings, strict=False)
    ]
    late = {m.name: {"jitter": part * steps * STEP} for m, steps in zip(messages, apart, strict=True)}
    use = BusSettings.model_validate(use.model_dump() | {"messages": late})
    path, memory, plans = path_of(messages, times, use, faults, sendings)
    random = np.random.default_rng(seed)
    values = random.integers(0, 2**48, (STEPS, len(messages)))
    values[random.random(values.shape) < 0.3] = 0  # the start value, at which a message is not active
    for k in range(1, STEPS):  # values that stay for some steps
        values[k] = np.where(random.random(len(messages)) < 0.6, values[k - 1], values[k])
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
        Sent(m.name, m.frame_id, m.extended, every if one.kind == "cyclic" else one.cycle, first,
             round(use.jitter_of(m.name) * 1e12), m.senders[0], kind=one.kind, interval=one.interval)
        for m, (every, first), one in zip(messages, times, sendings, strict=False)
    ]  # fmt: skip # one call
    sent_at = {s.name: requested(s, values[:, i].tolist(), 0) for i, s in enumerate(sent)}
    payloads = {
        (m.name, k): int(values[k, i]).to_bytes(m.length, "little")
        for i, m in enumerate(messages)
        for k in range(STEPS)
    }
    offs, babbling, late = of_the_oracle(plans)
    name = int(path.arrays["buses"][0, T.NAME])
    expected = carried(
        sent, payloads, STEPS, 10**9, round(1e12 / use.bitrate),
        lambda m, n: drawn(use.seed, name, m.identifier | m.extended << 29, n, 1), offs, babbling, sent_at,
    )  # fmt: skip # one call
    log = path.log_of("can0").frames[0]
    assert [(end, m.name, data) for _, end, m, data in log.frames()] == [
        (frame.end, frame.message.name, frame.payload) for frame in expected
    ]
    rows = {(row[T.ID], row[T.EXTENDED]): row for row in path.arrays["messages"].tolist()}
    assert [rows[s.identifier, s.extended][T.REPLACED] for s in sent] == [s.replaced for s in sent]

    def arrival(frame: Frame) -> int:
        hit = frame.message.name == "M0" and late and late.since <= frame.sampled < late.until
        return frame.end + round(use.delay * 1e12) + (round(late.fault.by * 1e12) if hit else 0)

    for i, m in enumerate(messages):
        frames = sorted((f for f in expected if f.message.name == m.name), key=lambda f: (arrival(f), f.end))
        for k in range(STEPS):
            seen = [f for f in frames if arrival(f) <= k * 10**9]
            assert received[k, i] == (int.from_bytes(seen[-1].payload, "little") if seen else 0.0)
    counted = hits_of(path.arrays, plans)
    for n, plan in enumerate(plans):
        match plan.fault:
            case Babble():
                assert counted[n] == sum(f.message.name == plan.message for f in expected)
            case Delay():
                assert counted[n] == sum(
                    f.message.name == "M0" and plan.since <= f.sampled < plan.until for f in expected
                )
            case BusOff():
                bit = round(1e12 / use.bitrate)
                back = offs[0].back([f for f in expected if f.start < offs[0].back(expected, bit)], bit)
                away = [k for k in range(STEPS) if plan.since <= k * 10**9 < back]
                own = [m.name for m in messages if m.senders[0] == "A"]
                due = sum(k in sent_at[name] for k in away for name in own)
                assert counted[n] == due


def of_the_oracle(plans: Sequence[FaultPlan]) -> tuple[list[Off], list[Babbler], FaultPlan | None]:
    """The faults in the words of the oracle; those that make frames late as they are."""
    offs, babblers, late = [], [], None
    for plan in plans:
        match plan.fault:
            case BusOff():
                offs.append(Off(plan.node, plan.since, plan.until))
            case Babble() as fault:
                message = Sent(plan.message, fault.id, fault.extended, 1, 0, 0, plan.node or "nobody else")
                period = round((fault.period or 0.0) * 1e12)
                babblers.append(Babbler(message, fault.length, plan.since, plan.until, period))
            case Delay():
                late = plan
    return offs, babblers, late


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
