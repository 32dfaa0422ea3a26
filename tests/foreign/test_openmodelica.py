"""FMUs that OpenModelica made, as the package gemseo-fmu ships them, beside FMPy's own run of them."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest

from evcosim.master.cli import main
from evcosim.master.simulation import simulate

SYSTEM = """
name = "alone"
[experiment]
step_size = {step}
stop_time = 1.0
[units.unit]
fmu = "{fmu}"
isolation = "{isolation}"
{more}
"""

# step_size is 1 ms for the mass and damper: its solver is Euler's, which 10 ms lets diverge.
CASES = {
    "MassSpringSubSystem1": (0.01, ("x1", "v1")),
    "MassSpringSubSystem2": (0.01, ("x2", "v2")),
    "MassSpringSystem": (0.01, ("x1", "v1", "x2", "v2")),
    "Mass_Damper": (0.001, ("y",)),
    "add": (0.01, ("y",)),
    "ramp": (0.01, ("out",)),
}


def run(folder: Path, fmu: Path, step: float, isolation: str = "process", more: str = ""):
    """A system of this FMU alone, for its default experiment of 1 s; `more` are lines of its entry."""
    path = folder / "alone.toml"
    path.write_text(SYSTEM.format(fmu=fmu.as_posix(), step=step, isolation=isolation, more=more))
    return simulate(path, trust=True)


@pytest.mark.parametrize("name", CASES)
def test_it_is_described_and_runs_as_in_fmpy(shipped: Path, tmp_path: Path, capsys, name: str) -> None:
    fmu, (step, outputs) = shipped / f"{name}.fmu", CASES[name]
    assert main(["info", str(fmu)]) == 0
    shown = capsys.readouterr().out
    assert "FMI 2.0 Co-Simulation, Model Exchange" in shown
    assert 'Model Exchange, where interface = "model_exchange" asks for it' in " ".join(shown.split())
    assert "OpenModelica Compiler" in shown
    ours = run(tmp_path, fmu, step)
    assert ours.manifest["units"]["unit"]["isolation"] == "process"
    theirs = fmpy.simulate_fmu(
        str(fmu),
        fmi_type="CoSimulation",
        stop_time=1.0,
        step_size=step,
        output_interval=step,
        output=list(outputs),
        validate=False,
    )
    assert len(theirs) == len(ours.time)
    for output in outputs:
        np.testing.assert_allclose(ours[f"unit.{output}"], theirs[output], rtol=1e-9, atol=1e-12)


def test_the_process_changes_no_bit(shipped: Path, tmp_path: Path) -> None:
    fmu = shipped / "MassSpringSystem.fmu"
    apart, here = (run(tmp_path, fmu, 0.01, isolation) for isolation in ("process", "none"))
    assert np.array_equal(apart["unit.x1"], here["unit.x1"])


def test_too_large_a_step_diverges_and_substeps_mend_it(shipped: Path, tmp_path: Path) -> None:
    """Its status is OK all the way to 1e13; ten substeps give what a step of 1 ms gives."""
    fmu = shipped / "Mass_Damper.fmu"
    diverged = run(tmp_path, fmu, 0.01)
    assert np.max(np.abs(diverged["unit.y"])) > 1e9
    fine = run(tmp_path, fmu, 0.001)
    mended = run(tmp_path, fmu, 0.01, more="substeps = 10")
    np.testing.assert_allclose(mended["unit.y"], fine["unit.y"][::10], rtol=1e-9, atol=1e-12)


def test_an_array_beside_scalars_is_no_hindrance(shipped: Path, tmp_path: Path) -> None:
    """FMU3Model is of PythonFMU3 (FMI 3.0): what is no scalar is not offered, the rest runs."""
    results = run(tmp_path, shipped / "FMU3Model.fmu", 0.01)
    assert np.all(np.diff(results["unit.output"]) == 1.0)
    assert not any("vector" in name for name in results.units)


# ---- Model Exchange: the same files, whose equations we solve

EXCHANGED = 'interface = "model_exchange"\n'


def springs(t):
    """Two masses of 1 kg, three springs of 1 N/m: sum and difference turn at 1 and sqrt(3) rad/s."""
    w = np.sqrt(3.0)
    both, apart = np.cos(t) + np.sin(t), np.sin(w * t) / w - np.cos(w * t)
    both_rate, apart_rate = np.cos(t) - np.sin(t), np.cos(w * t) + w * np.sin(w * t)
    return {
        "x1": 0.5 * (both + apart),
        "x2": 0.5 * (both - apart),
        "v1": 0.5 * (both_rate + apart_rate),
        "v2": 0.5 * (both_rate - apart_rate),
    }


def damped(t):
    """1 kg, 10 N s/m and 10 kN/m: from rest at 0 to the spring's rest at -0.5 m, at 16 Hz."""
    w = np.sqrt(1e4 - 25.0)
    return {"y": -0.5 + 0.5 * np.exp(-5.0 * t) * (np.cos(w * t) + 5.0 / w * np.sin(w * t))}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize(
    ("name", "exact", "factor"), [("MassSpringSystem", springs, 1.0), ("Mass_Damper", damped, 50.0)]
)
def test_by_model_exchange_it_is_its_closed_form(
    shipped: Path, tmp_path: Path, name: str, exact, factor: float, tolerance: float
) -> None:
    """The tolerance bounds the error of a step; `factor` is how many of them the motion adds up to."""
    more = f"{EXCHANGED}tolerance = {tolerance}"
    results = run(tmp_path, shipped / f"{name}.fmu", 0.01, more=more)
    for output, values in exact(results.time).items():
        np.testing.assert_allclose(results[f"unit.{output}"], values, rtol=0.0, atol=factor * tolerance)


def test_its_own_co_simulation_converges_to_its_model_exchange(shipped: Path, tmp_path: Path) -> None:
    """That one is Euler's method: ten times the substeps are a tenth of the difference."""
    fmu = shipped / "MassSpringSystem.fmu"
    exchanged = run(tmp_path, fmu, 0.01, more=EXCHANGED)
    coarse, fine = (run(tmp_path, fmu, 0.01, more=f"substeps = {n}") for n in (1, 10))
    for name in ("unit.x1", "unit.x2", "unit.v1", "unit.v2"):
        far, near = (float(np.max(np.abs(r[name] - exchanged[name]))) for r in (coarse, fine))
        assert far > 1e-3
        assert near == pytest.approx(far / 10.0, rel=0.1)


@pytest.mark.parametrize(("name", "output"), [("add", "y"), ("ramp", "out")])
def test_without_states_both_interfaces_are_the_same(
    shipped: Path, tmp_path: Path, name: str, output: str
) -> None:
    fmu = shipped / f"{name}.fmu"
    simulated, exchanged = (run(tmp_path, fmu, 0.01, more=more) for more in ("", EXCHANGED))
    assert exchanged.manifest["units"]["unit"]["interface"] == "model_exchange"
    # by Co-Simulation the FMU computes at t + h, which may miss the next time by its last bit
    one_bit = np.spacing(np.abs(exchanged[f"unit.{output}"]))
    assert np.all(np.abs(simulated[f"unit.{output}"] - exchanged[f"unit.{output}"]) <= one_bit)


def test_by_model_exchange_too_the_process_changes_no_bit(shipped: Path, tmp_path: Path) -> None:
    fmu = shipped / "Mass_Damper.fmu"
    apart, here = (run(tmp_path, fmu, 0.01, kind, EXCHANGED) for kind in ("process", "none"))
    assert np.array_equal(apart["unit.y"], here["unit.y"])
