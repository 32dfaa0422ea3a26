"""Where results of Model Exchange differ from FMPy's, and why: closed forms decide (docs/fmpy.md)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy import extract
from fmpy.fmi2 import FMU2Slave
from numpy.typing import NDArray

from evcosim import simulate
from evcosim.master.fmi import exchange
from evcosim.master.fmi.fmu import read_fmu
from support.beside_fmpy import FINEST, Course, distance, in_evcosim, in_fmpy, told
from support.c_fmu import SOURCES, compile_fmu
from support.descriptions import redescribed
from support.equations import equations_fmu

Array = NDArray[np.float64]
NEAR = {"trust": True, "isolation": "none"}


def both(fmu: Path, tolerance: float, stop: float, step: float = 0.01) -> tuple[Course, Course]:
    """The outputs of evcosim and of FMPy."""
    read = read_fmu(fmu)
    ours = in_evcosim(read, tolerance, stop_time=stop, step_size=step, **NEAR)
    return ours, in_fmpy(read, tolerance, ours.time)


def height(time: Array, gravity: float = 9.81, restitution: float = 0.7) -> Array:
    """The height of the ball that falls from 1 m, shape (n,), up to its 29th bounce."""
    first, speed = np.sqrt(2.0 / gravity), np.sqrt(2.0 * gravity)
    sums = np.cumsum(restitution ** np.arange(29)) - 1.0
    bounces = first * (1.0 + 2.0 * sums)
    count = np.searchsorted(bounces, time, side="right")
    since = time - np.where(count > 0, bounces[count - 1], -first)
    return np.where(count > 0, restitution**count, 1.0) * speed * since - 0.5 * gravity * since**2


def error(course: Course, exact: Array) -> float:
    return float(np.max(np.abs(course.values["x0"] - exact)))


def ball(path: Path) -> Path:
    """The ball with every function that FMPy looks up, and a parameter p0, its gravity, that FMPy sets."""
    declared = 'name="p0" valueReference="6" causality="internal" variability="parameter"><Real'
    fmu = equations_fmu(path / "ball.fmu", "ball", 1, behavior=14)
    return redescribed(fmu, (f"{declared}/>", f'{declared} start="9.81"/>'))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_after_impacts_evcosim_is_nearer_to_the_closed_form(tmp_path: Path, tolerance: float) -> None:
    ours, theirs = both(ball(tmp_path), tolerance, 2.0)
    exact = height(ours.time)
    assert error(ours, exact) < 0.2 * error(theirs, exact)
    assert error(theirs, exact) < 100.0 * tolerance
    assert distance(ours, theirs).share < 1.5 * error(theirs, exact)  # what they are apart is FMPy's error


def test_both_come_to_the_closed_form(tmp_path: Path) -> None:
    for course in both(ball(tmp_path), 1e-11, 2.0):
        assert error(course, height(course.time)) < 1e-9


def test_the_absolute_tolerance_makes_it_after_an_impact(tmp_path: Path, monkeypatch) -> None:
    """FMPy's is 100 times larger; with the same one evcosim has an error as large."""
    fmu = ball(tmp_path)
    fine, theirs = both(fmu, 1e-6, 2.0)
    monkeypatch.setattr(exchange, "_ABSOLUTE", 1.0)
    coarse, _ = both(fmu, 1e-6, 2.0)
    exact = height(fine.time)
    assert 5.0 * error(fine, exact) < error(coarse, exact)
    assert 0.3 * error(theirs, exact) < error(coarse, exact) < 3.0 * error(theirs, exact)


def test_a_solver_that_steps_to_each_row_is_nearer_than_one_that_interpolates(tmp_path: Path) -> None:
    """x0 = exp(-t): no event; with rows 1 s apart evcosim's solver takes long steps too."""
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 1, behavior=14)
    ours, theirs = both(fmu, 1e-4, 3.0)
    exact = np.exp(-ours.time)
    assert error(ours, exact) < 0.1 * error(theirs, exact)
    seldom, _ = both(fmu, 1e-4, 3.0, step=1.0)
    assert error(seldom, np.exp(-seldom.time)) > 3.0 * error(ours, exact)


def test_a_row_next_to_an_impact_shows_all_of_it_or_nothing(tmp_path: Path) -> None:
    """The impact at 0.5 s + 100 ns is behind the row at 0.5 s; FMPy has it 200 ns too early, so before it."""
    later = 0.5 + 1e-7
    fmu = read_fmu(redescribed(ball(tmp_path), ('start="9.81"', f'start="{2.0 / later**2!r}"')))
    given = {"parameters": {"p0": 2.0 / later**2}}
    ours = in_evcosim(fmu, 1e-6, stop_time=0.6, step_size=0.01, **given, **NEAR)
    theirs = in_fmpy(fmu, 1e-6, ours.time, p0=2.0 / later**2)
    row = int(np.argmin(np.abs(ours.time - 0.5)))
    assert (ours.values["count"][row], theirs.values["count"][row]) == (0.0, 1.0)
    assert abs(ours.values["x0"][row] - theirs.values["x0"][row]) < 3e-6


@pytest.mark.parametrize("step", [0.1, 0.01])
def test_inputs_are_held_between_two_rows(tmp_path: Path, step: float) -> None:
    """u = t, and x0' = u - x0: x0 follows a stair, which is off by half a step from what follows the ramp."""
    fmu = equations_fmu(tmp_path / "relay.fmu", "relay", 1)
    (tmp_path / "ramp.csv").write_text("time,u\n0,0\n3,3\n")
    inputs = {"u": str(tmp_path / "ramp.csv")}
    results = simulate(fmu, stop_time=3.0, step_size=step, tolerance=1e-10, inputs=inputs, **NEAR)
    held = np.zeros_like(results.time)
    for k, u in enumerate(results.time[:-1]):
        held[k + 1] = held[k] * np.exp(-step) - u * np.expm1(-step)
    ramp = results.time - 1.0 + np.exp(-results.time)
    np.testing.assert_allclose(results["fmu.x0"], held, atol=1e-7)
    assert np.max(np.abs(held - ramp)) == pytest.approx(0.5 * step, rel=0.1)


COUNTING = """<fmiModelDescription fmiVersion="2.0" modelName="counting" guid="c">
<CoSimulation modelIdentifier="counting" canHandleVariableCommunicationStepSize="true"/>
<ModelVariables><ScalarVariable name="y" valueReference="0" causality="output"><Real/></ScalarVariable>
</ModelVariables><ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>"""


@pytest.mark.parametrize(("step", "differ"), [(0.01, True), (0.02, True), (2.0**-7, False), (0.25, False)])
def test_an_fmu_with_steps_of_its_own_counts_the_last_digit_of_times(
    tmp_path: Path, step: float, differ: bool
) -> None:
    """One internal step more or less, unless the step is a power of two: then all times are the same."""
    fmu = compile_fmu(tmp_path / "counting.fmu", SOURCES / "counting.c", COUNTING, "counting")
    ours, theirs = both(fmu, 1e-6, 40 * step, step)
    apart = np.abs(ours.values["y"] - theirs.values["y"])
    assert np.max(apart) == (1.0 if differ else 0.0)
    assert np.max(np.abs(ours.values["y"] - ours.time / 0.01)) < 2.0
    unit = FMU2Slave(
        guid="c", unzipDirectory=extract(fmu), modelIdentifier="counting", instanceName="by hand"
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    by_hand = [0.0]
    for time in ours.time[:-1]:
        unit.doStep(time, step)
        by_hand += unit.getReal([0])
    assert by_hand == ours.values["y"].tolist()


def test_the_program_says_how_far_apart_they_are(tmp_path: Path) -> None:
    fmu = redescribed(ball(tmp_path), ('tolerance="1e-8"', 'tolerance="1e-4" stopTime="1" stepSize="0.1"'))
    first, *shares = told(fmu, None, None).splitlines()
    assert first == "ball.fmu, ModelExchange, 11 rows, tolerance 0.0001"
    apart, theirs, ours, limit = (
        float(line.partition(" of the range of ")[0].split()[-1]) for line in shares
    )
    assert ours < theirs and limit < 1e-9 and apart == pytest.approx(theirs, rel=0.2)
    assert shares[-1].startswith(f"apart at {FINEST:g} ")
