"""Frames against values: what a receiver gets, what is counted, and the bytes, bit for bit."""

from __future__ import annotations

import dataclasses
import struct

import numpy as np
import pytest
from hypothesis import given, settings

from evcosim.cosim.can.bus_settings import BusSettings, BusVariation
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import Framing
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.errors import RunError
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.system.system import System, load_system, system_names
from evcosim.cosim.units.measure import Affine
from evcosim.master import simulation
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.schedule import Action
from evcosim.master.engine.sender import Sender
from support.channels import cases
from support.framed import framed


def sender(plan: MessagePlan, memory: np.ndarray, log_raw: bool) -> Sender:
    channel = MessageChannel(plan.message, plan.routes, plan.settings, log_raw)
    return Sender(plan, channel, memoryview(memory), None)


@settings(deadline=None, max_examples=150)
@given(cases())
def test_a_frame_carries_what_the_channel_carries(case):
    signal, use, values = case
    little = dataclasses.replace(signal, start=5)
    message = Message("test.dbc", "M", 1, length=64, signals={"S": little}, fd=True)
    routes = (SignalRoute(little, 0, Affine(2.0, 0.25), ((1, Affine()), (2, Affine(0.5, -3.0)))),)
    plan = MessagePlan("can0", message, use, routes, {"S": "a.y"}, 1, 0, None)
    by_value, by_frame = np.zeros(3), np.zeros(3)
    old = sender(plan, by_value, True)
    new = sender(dataclasses.replace(plan, framing=Framing()), by_frame, False)
    path = FramePath([new], by_frame, 0.01, logs=True)
    send = path.operation(Action("send", 0))
    assert send is not None
    for k, value in enumerate(values):
        by_value[0] = by_frame[0] = value
        assert outcome(old.send, k) == outcome(path.act, *send, k)
        assert by_value.tobytes() == by_frame.tobytes()
    path.flush()
    assert old.channel.saturations == new.channel.saturations
    raws = [raw for _, row in old.channel.log.stretches() for raw in row["S"].tolist()]
    log = path.log_of("can0").frames[0]
    assert log is not None
    assert [data for *_, data in log.frames()] == [encoder(message)({"S": raw}) for raw in raws]


def outcome(act, *arguments) -> str:
    try:
        act(*arguments)
    except RunError as error:
        return str(error)
    return ""


def unprotected(name: str) -> System:
    """A built-in system without the settings of single messages, all of which could be values."""
    found = load_system(name)
    buses = {bus: of.model_copy(update={"messages": {}}) for bus, of in found.file.buses.items()}
    return dataclasses.replace(found, file=found.file.model_copy(update={"buses": buses}))


def ran(monkeypatch, tmp_path, system: str, engine: str, on_wire: bool, **options) -> tuple:
    """Bits of the results, the log, and what was counted, with all messages as values or all as frames."""
    prepare = simulation.prepare

    def prepared(*arguments, **more):
        found = prepare(*arguments, **more)
        return dataclasses.replace(found, plan=framed(found.plan)) if on_wire else found

    with monkeypatch.context() as patch:
        patch.setattr(simulation, "prepare", prepared)
        with simulation.Simulation(
            unprotected(system), engine=engine, log_frames=True, isolation="none", **options
        ) as run:
            run.step(min(150, run.plan.steps))
            results = run.results
            run.write_can_log(tmp_path / "frames.log")
            bits = np.stack([results[v.name] for v in results.variables])
            return bits.tobytes(), (tmp_path / "frames.log").read_text(), run.saturations()


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("system", system_names())
def test_a_system_whose_messages_are_all_frames(monkeypatch, tmp_path, system, engine):
    by_value = ran(monkeypatch, tmp_path, system, engine, False)
    assert by_value[1]  # there are frames to compare
    assert ran(monkeypatch, tmp_path, system, engine, True) == by_value


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_frames_on_buses_with_a_delay(monkeypatch, tmp_path, engine, algorithm):
    given = {"algorithm": algorithm, "bus": BusVariation(delay_steps=3, cycle=2)}
    by_value = ran(monkeypatch, tmp_path, "scooter", engine, False, **given)
    assert ran(monkeypatch, tmp_path, "scooter", engine, True, **given) == by_value


def test_a_signal_of_64_bits_comes_from_python():
    """An integer that no double holds is sent and received as one."""
    signal = Signal("S", 0, 64, signed=True)
    message = Message("test.dbc", "M", 1, signals={"S": signal})
    memory = np.array([-(2.0**62), 0.0])
    routes = (SignalRoute(signal, 0, Affine(), ((1, Affine()),)),)
    plan = MessagePlan("can0", message, BusSettings(), routes, {}, 1, 0, None, framing=Framing())
    path = FramePath([sender(plan, memory, False)], memory, 0.01, logs=True)
    path.act(*path.operation(Action("send", 0)), 0)
    assert memory[1] == -(2.0**62)
    ((*_, data),) = path.log_of("can0").frames[0].frames()
    assert struct.unpack("<q", data) == (-(2**62),)
