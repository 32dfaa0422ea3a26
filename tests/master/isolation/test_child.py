"""The process of a unit loads what a unit needs, and none of the packages that a system or a run needs."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import Fmu, read_fmu
from evcosim.master.isolation.process import ProcessLimits
from evcosim.master.isolation.unit import IsolatedUnit
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.simulation import Simulation
from support.c_fmu import mixed_fmu

# packages, some of 100 ms and more of a process's start, and rooms of this project that lead to them
HEAVY = (
    "can", "cantools", "jinja2", "llvmlite", "lxml", "matplotlib", "numba", "pandas", "pint", "pydantic",
    "rich", "scipy", "tomllib", "typer", "evcosim.cosim.can", "evcosim.cosim.results", "evcosim.cosim.system",
    "evcosim.cosim.plan.plan", "evcosim.cosim.plan.resolve", "evcosim.cosim.row_store", "evcosim.fmus.build",
    "evcosim.master.cli", "evcosim.master.engine", "evcosim.master.prepare",
    "evcosim.master.simulation", "evcosim.master.isolation.process", "evcosim.master.isolation.unit",
)  # fmt: skip # one list


def modules_of(fmu: Fmu, monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """The modules that the process of an isolated unit has imported when its FMU is loaded."""
    monkeypatch.setenv("PYTHONPROFILEIMPORTTIME", "1")  # which prints a line for each
    unit = IsolatedUnit(fmu, "a", fmu.interface, ProcessLimits())
    try:
        assert unit.get(next(iter(fmu.interface.variables))) is not None  # it waits until that is done
        output = unit._process._output
        output.seek(0)
        lines = output.read().decode().splitlines()
    finally:
        unit.free()
    return {line.rpartition("|")[2].strip() for line in lines if line.startswith("import time:")}


@pytest.mark.parametrize("kind", ["C", "pythonfmu"])
def test_a_process_loads_no_heavy_module(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = mixed_fmu(tmp_path / "mixed.fmu", 2) if kind == "C" else fmu_file("Rider")
    modules = modules_of(read_fmu(path), monkeypatch)
    assert {"evcosim.master.fmi.fmi2", "evcosim.master.isolation.shared"} <= modules
    assert ("fmpy" in modules) == (kind == "C")  # what FMPy read comes as FMPy's objects
    assert sorted(modules.intersection(HEAVY)) == []


def test_a_unit_in_c_needs_nothing_of_those_in_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    modules = modules_of(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2)), monkeypatch)
    assert not modules.intersection(("pythonfmu", "evcosim.models"))
    fmus = {module for module in modules if module.startswith("evcosim.fmus")}
    assert fmus <= {"evcosim.fmus", "evcosim.fmus.cache"}  # the cache is where unpacked ones stand


@pytest.mark.skipif(not POSSIBLE, reason="a handover needs futexes and the order of stores of x86")
def test_a_process_with_machine_code_loads_no_compiler(tmp_path: Path) -> None:
    path = tmp_path / "one.toml"
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 2)
    path.write_text(f"name = 'one'\n[units.a]\nfmu = '{fmu}'\n[experiment]\nstop_time = 0.1\n")
    with Simulation(path, engine="compiled", isolation="process") as simulation:
        simulation.step(5)
        process = simulation.units["a"]._process.number
        mapped = Path(f"/proc/{process}/maps").read_text()
    assert "evcosim-code" in mapped
    assert "llvmlite" not in mapped and "numba" not in mapped
