"""What a run says of its buses."""

from __future__ import annotations

import pytest

from evcosim.master.simulation import Simulation
from support.timed import timed


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_counts_and_times_of_each_message(engine):
    with Simulation(timed("scooter", bit_error_rate=1e-4), engine=engine, isolation="none") as simulation:
        simulation.step(100)
        about = simulation.manifest()["frames"]["can0"]
    assert about["load"] == pytest.approx(sum(m["load"] for m in about["messages"].values()))
    assert 0.01 < about["load"] < 0.2
    for message in about["messages"].values():
        assert message["sent"] == message["carried"] + message["replaced"]
        assert 0 <= message["carried"] - message["arrived"] <= 1  # the last ones are under way
        assert (
            5e-5 < message["latency"]["min"] <= message["latency"]["mean"] <= message["latency"]["max"] < 0.01
        )
        assert message["seen"]["min"] == message["seen"]["max"] == pytest.approx(0.01)
    assert {"tec", "rec", "bus_off"} == {*next(iter(about["nodes"].values()))}


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("steps", [7, 40, 41])
def test_a_bus_is_busy_within_the_run_alone(engine, steps):
    """At 10 kbit/s it is always busy, and its last frame ends after the run."""
    with Simulation(timed("scooter", bitrate=10_000), engine=engine, isolation="none") as simulation:
        simulation.step(steps)
        about = simulation.manifest()["frames"]["can0"]
    assert 0.99 < about["load"] <= 1.0 + 1e-12
    assert about["load"] == pytest.approx(sum(m["load"] for m in about["messages"].values()))


def test_a_bus_without_frames_has_its_settings_alone():
    with Simulation("scooter", engine="python", isolation="none") as simulation:
        assert "frames" not in simulation.manifest()["buses"]["can0"]
