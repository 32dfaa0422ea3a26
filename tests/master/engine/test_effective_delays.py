"""The time from sampling to use: counted in both engines as frames in a log say it."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from evcosim.cosim.plan.readers import readers
from evcosim.cosim.system.system import System, load_system
from evcosim.master.engine.effective_delays import effective_delays
from evcosim.master.simulation import Simulation, simulate


def system(delay: float = 0.0, **unit: Any) -> System:
    """The scooter's, whose ECU and vehicle have a period and an offset."""
    found = load_system("scooter")
    units = found.file.units | {"ecu": found.file.units["ecu"].model_copy(update=unit)}
    buses = {"can0": found.file.buses["can0"].model_copy(update={"delay": delay})}
    return dataclasses.replace(found, file=found.file.model_copy(update={"units": units, "buses": buses}))


def test_without_delay_the_scooter_has_none_and_with_frames_the_step():
    """The units that receive messages stand behind those that send them, or receive what is valid."""
    for variation, expected in (("instant", 0.0), ("frame", 0.01)):
        frames = load_system("scooter")
        bus = frames.file.buses["can0"].model_copy(update={"timing": variation})
        frames = dataclasses.replace(frames, file=frames.file.model_copy(update={"buses": {"can0": bus}}))
        found = simulate(frames, stop_time=1.0).manifest["effective_delays"]
        assert found["can0.EMD_Status"]["ecu"] == {"min": expected, "mean": expected, "max": expected}
        assert found["can0.VCU_Request"]["vehicle"]["max"] == expected
    late = simulate("scooter", stop_time=1.0, delay=0.03).manifest["effective_delays"]
    assert late["can0.EMD_Status"]["ecu"]["max"] == pytest.approx(0.03)


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(("timing", "delay"), [("frame", 0.0), ("frame", 0.0123), ("instant", 0.02)])
def test_it_is_what_the_frames_of_a_log_say(engine, timing, delay):
    found = system(delay, period=0.05, offset=0.03)
    bus = found.file.buses["can0"].model_copy(update={"timing": timing, "jitter": 0.004, "seed": 2})
    found = dataclasses.replace(found, file=found.file.model_copy(update={"buses": {"can0": bus}}))
    with Simulation(found, "fig8", engine=engine, log_frames=True, isolation="none") as simulation:
        simulation.step(300)
        told = effective_delays(simulation.plan, simulation._engine.frames, 300)["can0.EMD_Status"]["ecu"]
        log = simulation._engine.frames.log_of("can0").frames[0]
    if timing == "frame":
        frames = [(k, end) for k, end, m, _ in log.frames() if m.name == "EMD_Status"]
    else:
        frames = [(k, k * 10**10) for k in range(300)]
    used = {}
    for turn in range(3, 300, 5):
        there = [k for k, end in frames if end + round(delay * 1e12) <= turn * 10**10]
        if there:
            used.setdefault(there[-1], turn)
    times = [(turn - k) * 0.01 for k, turn in used.items()]
    assert told["min"] == pytest.approx(min(times))
    assert told["mean"] == pytest.approx(sum(times) / len(times))
    assert told["max"] == pytest.approx(max(times))


def test_values_and_frames_without_time_tell_the_same():
    """A status makes a frame of the message, which arrives when it is sent."""
    plain = system(period=0.04, offset=0.01)
    manifest = simulate(plain, "fig8", stop_time=2.0).manifest
    own = {"EMD_Status": {"timeout": 3}, "VCU_Request": {"timeout": 3}}
    bus = type(plain.file.buses["can0"]).model_validate(
        plain.file.buses["can0"].model_dump(exclude_unset=True) | {"messages": own}
    )
    framed = dataclasses.replace(plain, file=plain.file.model_copy(update={"buses": {"can0": bus}}))
    other = simulate(framed, "fig8", stop_time=2.0).manifest
    assert other["frames"]["can0"]["messages"]
    assert manifest["effective_delays"] == other["effective_delays"]
    with Simulation(framed, "fig8") as simulation:
        assert any(readers(simulation.plan))
