"""The relative tolerance that an FMU is told, who says it, and that the manifest names both."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.fmi.tolerance import tolerance_of
from evcosim.master.simulation import simulate
from support.initial import initial_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

KINDS = [(2, "CS"), (3, "CS"), (1, "ME"), (2, "ME"), (3, "ME")]
_DEFAULT = {"CS": (None, "none"), "ME": (1e-6, "default")}


def told(fmu: Path, unit: str = "", **options: Any) -> tuple[float | None, float | None, str]:
    """What the FMU was told (None: nothing), and the two keys of the manifest."""
    path = fmu.with_suffix(".toml")
    path.write_text(f'name = "one"\n[experiment]\nstop_time = 0.02\n[units.a]\nfmu = "{fmu.name}"\n{unit}\n')
    results = simulate(path, **options)
    seen, about = results["a.told"][0], results.manifest["units"]["a"]
    return None if seen < 0.0 else seen, about["tolerance"], about["tolerance_from"]


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize("isolation", ["none", "process"])
def test_the_fmu_is_told_the_system_s_tolerance_else_its_own(
    tmp_path: Path, fmi: int, kind: str, isolation: str
) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind, tolerance="1e-4")
    assert told(fmu, isolation=isolation) == (1e-4, 1e-4, "fmu")
    assert told(fmu, "tolerance = 1e-3", isolation=isolation) == (1e-3, 1e-3, "system")


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize("declared", ["", "0", "2.0", "-1e-4", "no number", "nan"])
def test_without_one_it_is_our_solver_s_or_none(tmp_path: Path, fmi: int, kind: str, declared: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind, tolerance=declared)
    number, origin = _DEFAULT[kind]
    assert told(fmu, isolation="none") == (number, number, origin)


def test_a_slave_of_fmi_1_has_no_way_to_be_told(tmp_path: Path) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 1, tolerance="1e-4")
    assert tolerance_of(read_fmu(fmu), None) == (None, "none")
    assert told(fmu, isolation="none") == (None, None, "none")


@pytest.mark.parametrize("isolation", ["none", "process"])
def test_a_tolerance_for_a_slave_of_fmi_1_is_a_warning(tmp_path: Path, isolation: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 1)
    assert told(fmu, "tolerance = 1e-3", isolation=isolation) == (None, None, "none")
    alone = simulate(fmu, stop_time=0.02, step_size=0.01, tolerance=1e-3, isolation=isolation)
    said = [w for w in alone.manifest["warnings"] if "tolerance" in w]
    assert said == ["unit 'fmu' is not told tolerance = 0.001: Co-Simulation of FMI 1.0 knows none"]
