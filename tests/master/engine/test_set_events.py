"""Tunable parameters and free inputs that are set in a run, by an event and by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import Value, VariableInfo
from evcosim.master.simulation import Simulation, simulate
from evcosim.master.unit import UnitError
from support.initial import initial_fmu
from support.mocks import MockUnit, plan_of, real, started

KINDS = [(2, "CS"), (3, "CS"), (2, "ME"), (3, "ME")]
WAYS = [("none", "python"), ("none", "compiled"), ("process", "compiled")]
EVENTS = """
[[event]]
time = 0.03
action = "set"
variable = "a.p"
value = 5.0
[[event]]
time = 0.06
action = "set"
variable = "a.u"
value = 3.0
"""


def system(fmu: Path, events: str = EVENTS) -> tuple[Path, Path]:
    """A system of this FMU alone, and a scenario with events."""
    path, scenario = fmu.with_name("alone.toml"), fmu.with_name("events.toml")
    path.write_text(
        f'name = "alone"\n[experiment]\nstop_time = 0.1\n[units.a]\nfmu = "{fmu.name}"\n'
        "start = { u = 2.0 }\nparameters = { p = 4.0 }\n"
    )
    scenario.write_text(events)
    return path, scenario


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize(("isolation", "engine"), WAYS)
def test_an_event_sets_from_its_step_on(
    tmp_path: Path, fmi: int, kind: str, isolation: str, engine: str
) -> None:
    paths = system(initial_fmu(tmp_path / "initial.fmu", fmi, kind))
    results = simulate(*paths, isolation=isolation, engine=engine)
    k = np.arange(11)
    p, u = np.where(k < 3, 4.0, 5.0), np.where(k < 6, 2.0, 3.0)
    np.testing.assert_array_equal(results["a.u"], u)
    np.testing.assert_array_equal(results["a.y"], p * u)
    assert results["a.gain"][-1] == 4.0  # what the FMU was initialized with
    assert results.manifest["units"]["a"]["parameters"] == {"p": 4.0}


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(("fmi", "kind"), KINDS)
def test_set_by_hand_is_the_same(tmp_path: Path, fmi: int, kind: str, engine: str) -> None:
    path, scenario = system(initial_fmu(tmp_path / "initial.fmu", fmi, kind))
    by_event = simulate(path, scenario, isolation="none", engine=engine)
    with Simulation(path, isolation="none", engine=engine) as sim:
        sim.step(3)
        sim.set("a.p", 5)
        assert sim["a.p"] == 5.0
        sim.step(3)
        sim.set("a.u", 3.0)
        sim.run()
        by_hand = sim.results
    np.testing.assert_array_equal(by_event.data, by_hand.data)


def test_parameters_of_fmi_1_are_fixed(tmp_path: Path) -> None:
    path, scenario = system(initial_fmu(tmp_path / "initial.fmu", 1))
    with pytest.raises(ConfigError, match=r"event 1.variable: a.p is a fixed parameter"):
        simulate(path, scenario)


class Refusing(MockUnit):
    """Takes no parameter in a run."""

    def set(self, name: str, value: Value) -> None:
        if "exit" in self.log:
            raise UnitError(f"unit '{self.name}': {name} was refused")
        super().set(name, value)


def test_a_unit_that_refuses_ends_the_run_with_its_time() -> None:
    unit = Refusing("a", [VariableInfo("p", "Real", "parameter", "tunable"), real("y", "output")])
    event = {"time": 0.03, "action": "set", "variable": "a.p", "value": 1.0}
    engine = started([unit], plan_of([unit], {}, {"event": [event]}))
    with pytest.raises(UnitError, match=r"^at t = 0.03 s \(step 3\): unit 'a': p was refused"):
        engine.advance(10)
    assert engine.k == 3 and not engine.whole
    assert engine.recorded().shape[0] == 3
