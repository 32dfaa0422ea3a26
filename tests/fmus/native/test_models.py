"""Every model of the catalog as a native FMU: compilers and validators are silent, every bit is Python's."""

from __future__ import annotations

import importlib
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from evcosim import simulate
from evcosim.cosim.system.system import load_system, system_names
from evcosim.fmus.catalog import CATALOG
from evcosim.fmus.native import toolchain
from evcosim.fmus.native.build import extracted_library, native_built, why_not
from evcosim.fmus.native.check import Counts, first_difference
from evcosim.models.base import Model
from support.needs import need_c_compiler

WARNINGS = ("-Wall", "-Wextra", "-pedantic", "-Werror")
SLOW = {"TwoMotorVehicle": 200}
"""Steps of models of which a step can be millions of Python's instructions."""
STEPS, SEEDS = 1000, 4
UNITS = {"scooter": 1.0, "lane_keeping": 1.0, "multi_drive": 0.2, "braking": 0.3}
"""Seconds of each system that are run with both kinds of units."""


@pytest.fixture(autouse=True)
def _compiler() -> None:
    need_c_compiler()


def model_named(name: str) -> type[Model]:
    """Return a model of the catalog."""
    found: type[Model] = getattr(importlib.import_module(f"evcosim.models.{CATALOG[name].module}"), name)
    return found


@pytest.mark.parametrize("name", CATALOG)
def test_it_becomes_native(name: str) -> None:
    assert why_not(name) == ""


@pytest.mark.parametrize("name", CATALOG)
def test_no_compiler_warns(name: str, tmp_path: Path) -> None:
    with zipfile.ZipFile(native_built(name)) as archive:
        archive.extractall(tmp_path)
    for compiler, what in (("gcc", "-c"), ("clang", "-fsyntax-only")):  # gcc finds some as it optimizes
        if shutil.which(compiler):
            command = [compiler, *toolchain.EXACT, *WARNINGS, "-O1", what, "model.c"]
            done = subprocess.run(command, cwd=tmp_path / "sources", capture_output=True, text=True)
            assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("name", CATALOG)
def test_validators_are_silent(name: str) -> None:
    assert validate_fmu(str(native_built(name))) == []


@pytest.mark.parametrize("name", CATALOG)
def test_every_bit_is_python_s(name: str, tmp_path: Path) -> None:
    path, counts = native_built(name), Counts()
    token, library = fmpy.read_model_description(path).guid, extracted_library(path, tmp_path)
    steps = SLOW.get(name, STEPS) // SEEDS
    for seed in range(1, 1 + SEEDS):
        assert first_difference(model_named(name), library, token, steps, seed, counts) == ""
    assert counts.steps > SEEDS * steps // 2  # where it fails is the same too, and ends a run
    assert counts.values >= counts.steps
    assert counts.restored >= steps // 40


WRONG = {
    "another version of the model": ("model.c", "power / 3600.0", "power / 3600.0000000000005"),  # Wh
    "a state that is not taken back": (
        "saved.c",
        "memcpy(m->state, const_block_of(saved, STATE)",
        "memcpy(m->state, m->state",
    ),
    "bytes that lose a value": ("saved.c", "read |= (uint64_t)part << (8 * k)", "read |= part"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_difference_is_found(what: str, tmp_path: Path) -> None:
    """The comparison can fail: the library of a model does not pass for another version of it."""
    path = native_built("Battery")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    file, right, wrong = WRONG[what]
    source = tmp_path / "sources" / file
    text = source.read_text()
    assert text.count(right) == 1
    source.write_text(text.replace(right, wrong))
    files = [file.name for file in source.parent.glob("*.c")]
    library = tmp_path / "other.so"
    library.write_bytes(toolchain.compiled(source.parent, files, toolchain.here()))
    token = fmpy.read_model_description(path).guid
    said = first_difference(model_named("Battery"), library, token, 400, 0)
    assert " is " in said or "native refused" in said


@pytest.mark.parametrize("system", system_names())
def test_a_system_of_native_units_has_the_results_of_python_units(system: str, tmp_path: Path) -> None:
    units = load_system(system).file.units
    results = simulate(system, stop_time=UNITS[system])
    python = results.to_csv(tmp_path / "python.csv").read_bytes()
    used = dict.fromkeys(name.partition(".")[0] for name in results.names)
    fmus = {unit: native_built(units[unit].fmu) for unit in used if unit in units}
    assert len(fmus) >= 2
    native = simulate(system, stop_time=UNITS[system], fmus=fmus).to_csv(tmp_path / "native.csv")
    assert native.read_bytes() == python
    assert python.count(b"\n") > 10
