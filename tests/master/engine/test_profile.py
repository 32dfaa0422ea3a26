"""The profile of a run adds up to its time and changes no result."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.master.engine.profile import Profile
from evcosim.master.simulation import Simulation

pytestmark = pytest.mark.usefixtures("warm_units")


@pytest.mark.parametrize("engine", ["compiled", "python"])
def test_a_profile_adds_up_to_the_time_of_the_steps_and_changes_no_result(ring, engine):
    system = ring()
    with Simulation(system, engine=engine, profile=True, trust=True) as simulation:
        simulation.run()
        rows = simulation.profile
        data = np.asarray(simulation.results.data)
    with Simulation(system, engine=engine, trust=True) as simulation:
        simulation.run()
        assert np.array_equal(np.asarray(simulation.results.data), data)
        assert simulation.profile == []
    named = {(row["name"], row["what"]) for row in rows}
    step = "step" if engine == "compiled" else "set and step"
    assert {
        ("n0", "set"),
        ("n2", step),
        ("n1", "get"),
        ("can0.M0_0", "channel"),
        ("results", "record"),
    } <= named
    assert all(row["seconds"] >= 0.0 for row in rows)
    assert sum(row["seconds"] for row in rows[:-1]) == pytest.approx(rows[-1]["seconds"], rel=1e-9)


def test_the_option_shows_the_profile(evcosim):
    answer = evcosim("run", "scooter", "--stop-time", "1", "--profile", "--no-plot")
    assert answer.code == 0
    assert "us a step" in answer.out


def test_the_last_rows_are_the_rest_and_the_total():
    profile = Profile()
    profile.add(("vehicle", "step"), 0.25)
    profile.add(("results", "record"), 0.125)
    profile.add(("vehicle", "step"), 0.25)
    assert profile.rows(1.0, 1000) == [
        ("vehicle", "step", 0.5, 500.0, 0.5),
        ("results", "record", 0.125, 125.0, 0.125),
        ("master", "between", 0.375, 375.0, 0.375),
        ("total", "", 1.0, 1000.0, 1.0),
    ]


def test_no_step_takes_no_time():
    assert Profile().rows(0.0, 0) == [("master", "between", 0.0, 0.0, 0.0), ("total", "", 0.0, 0.0, 0.0)]


@pytest.mark.parametrize("engine", ["compiled", "python"])
def test_the_time_for_which_the_master_waits_is_called_so(engine):
    with Simulation("scooter", stop_time=0.2, engine=engine, isolation="process", profile=True) as simulation:
        simulation.run()
        named = {(row["name"], row["what"]) for row in simulation.profile}
    assert {("vehicle", "wait"), ("vehicle", "send")} <= named
    assert not {("vehicle", "step"), ("vehicle", "set and step")} & named
