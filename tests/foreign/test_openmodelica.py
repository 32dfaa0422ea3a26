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


def run(folder: Path, fmu: Path, step: float, isolation: str = "process"):
    """A system of this FMU alone, for its default experiment of 1 s."""
    path = folder / "alone.toml"
    path.write_text(SYSTEM.format(fmu=fmu.as_posix(), step=step, isolation=isolation))
    return simulate(path)


@pytest.mark.parametrize("name", CASES)
def test_it_is_described_and_runs_as_in_fmpy(shipped: Path, tmp_path: Path, capsys, name: str) -> None:
    fmu, (step, outputs) = shipped / f"{name}.fmu", CASES[name]
    assert main(["info", str(fmu)]) == 0
    shown = capsys.readouterr().out
    assert "FMI 2.0 Co-Simulation, Model Exchange" in shown
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
    path = tmp_path / "alone.toml"
    path.write_text(SYSTEM.format(fmu=fmu.as_posix(), step=0.01, isolation="process") + "substeps = 10\n")
    np.testing.assert_allclose(simulate(path)["unit.y"], fine["unit.y"][::10], rtol=1e-9, atol=1e-12)


def test_an_array_beside_scalars_is_no_hindrance(shipped: Path, tmp_path: Path) -> None:
    """FMU3Model is of PythonFMU3 (FMI 3.0): what is no scalar is not offered, the rest runs."""
    results = run(tmp_path, shipped / "FMU3Model.fmu", 0.01)
    assert np.all(np.diff(results["unit.output"]) == 1.0)
    assert not any("vector" in name for name in results.units)
