"""The experiment of an identification: rest, working points, the sweep, and the windows of each."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.analysis.sweep import sweep_of
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.identification_spec import IdentificationSpec
from evcosim.master.simulation import Simulation
from evcosim.master.studies.identification_run import IdentificationRun, longest
from evcosim.master.studies.identification_target import one_unit_system

KNOWN = {"input": "throttle", "output": "speed", "amplitude": 2.0, "sweep": (0.02, 0.6), "duration": 150.0}


def spec(**changes):
    return IdentificationSpec(**(KNOWN | changes))


@pytest.fixture
def started():
    """Start the experiment on the scooter alone, at 30 km/h."""
    simulations = []

    def start(spec, progress=lambda phase, share: None):
        system, sweep = one_unit_system("Scooter"), sweep_of(spec)
        stop_time = longest(sweep, system.file.experiment.step_size)
        parameters = {"fmu.initial_speed": 30.0 / 3.6}
        simulations.append(Simulation(system, stop_time=stop_time, parameters=parameters))
        return IdentificationRun(simulations[-1], spec, sweep, "fmu.", progress)

    yield start
    for simulation in simulations:
        simulation.close(orderly=False)


@pytest.mark.parametrize("step", [0.01, 0.003])
def test_the_stop_time_is_a_multiple_of_the_step_beyond_all_phases(step):
    sweep = sweep_of(spec())
    stop = longest(sweep, step)
    assert stop / step == pytest.approx(round(stop / step), abs=1e-6)
    assert stop > sweep.length + 6 / sweep.start


def test_an_output_is_converted_to_the_unit_of_the_spec(started):
    run = started(spec(unit="km/h"))
    assert (run.output_unit, run.convert.scale) == ("km/h", pytest.approx(3.6))
    assert started(spec()).output_unit == "m/s"


def test_the_working_point_of_an_input_holds_it_until_the_output_rests(started):
    phases = []
    run = started(spec(unit="km/h", at_input=[28.2]), lambda phase, share: phases.append((phase, share)))
    u, y = run.working_point()
    assert (u, y) == (28.2, pytest.approx(30.0, abs=0.05))
    assert run.simulation["fmu.throttle"] == 28.2
    assert phases[0] == ("waiting for rest at throttle = 28.2", 0.0)
    assert all(0.0 <= share < 1.0 for _, share in phases)


def test_the_working_point_of_an_output_that_cannot_be_reached(started):
    run = started(spec(unit="km/h", at=[80.0]))
    with pytest.raises(RunError, match=r"no steady speed = 80 km/h was found: throttle = .* % gives 49\."):
        run.working_point()


def test_the_sweep_moves_the_input_around_the_working_point(started):
    run = started(spec(unit="km/h", at_input=[28.2]))
    u_0, y_0 = run.working_point()
    u, y, saturated = run.swept(u_0)
    assert len(y) == len(u) + 1
    assert len(u) * run.step == pytest.approx(run.sweep.length, abs=run.hold * run.step)
    assert np.abs(u - u_0).max() == pytest.approx(2.0, rel=1e-3)
    held = u[: len(u) // run.hold * run.hold].reshape(-1, run.hold)
    assert (held == held[:, :1]).all()
    assert y[0] == pytest.approx(y_0, abs=0.05)
    assert saturated == []


def test_centers_are_the_middles_of_stretches(started):
    run = started(spec())
    assert run.centers(3, 4) == pytest.approx([0.02, 0.06, 0.10])


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"input": "throtle"}, r"input throtle: it is not there \(did you mean 'throttle'\?\)"),
        ({"input": "speed"}, "input speed: it is of causality output"),
        ({"unit": "N"}, "speed in unit N: .* different quantities"),
        ({"sweep": (0.02, 60.0)}, "Nyquist"),
    ],
)
def test_what_does_not_fit(started, changes, text):
    with pytest.raises(ConfigError, match=text):
        started(spec(**changes))
