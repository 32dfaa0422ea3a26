"""A unit of FMI 3.0: its integers of every size, Float32, and what its step returns beside the status."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.interface import UnitInterface
from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.fmi.fmi3 import Fmi3Unit, resources_path
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.simulation import simulate
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu


def alone(folder: Path, behavior: int) -> Path:
    """A system of one unit, which does wrong at t = 0.5 s."""
    fmu = mixed_fmu(folder / "mixed.fmu", 3, behavior)
    path = folder / "one.toml"
    path.write_text(
        f'name = "one"\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "{fmu}"\nisolation = "none"\n'
    )
    return path


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("int8", -128), ("uint8", 254), ("int16", -32768), ("uint16", 65534), ("uint32", 2**32 - 2),
        ("int64", -(2**53)), ("uint64", 2**53 - 1),
    ],
)  # fmt: skip # pairs
def test_the_integers_of_fmi_3(tmp_path: Path, kind: str, value: int) -> None:
    unit = Fmi3Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 3)), "a")
    try:
        unit.enter_initialization(0.0, None)
        unit.exit_initialization()
        unit.set(f"{kind}_in", value)
        unit.start_step(FmuSteps.equal(0.0, 0.01, 1))
        assert unit.get(kind) == value + 1
    finally:
        unit.free()


def test_types_of_fmi_3_in_a_run(tmp_path: Path) -> None:
    """Inputs of eight C types in one group of the plan; a Float32 is rounded as one."""
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 3)
    start = (
        "start = { single_in = 0.1, int8_in = -3, uint64_in = 77, int64_in = 9007199254740991, count_in = 5 }"
    )
    (tmp_path / "one.toml").write_text(
        f'name = "one"\n[experiment]\nstop_time = 0.02\n'
        f'[units.a]\nfmu = "{fmu}"\nisolation = "none"\n{start}\n'
    )
    results = simulate(tmp_path / "one.toml", trust=True)
    assert results["a.single"][-1] == float(np.float32(0.1))
    found = [int(results[f"a.{n}"][-1]) for n in ("int8", "uint64", "int64", "count", "uint8")]
    assert found == [-2, 78, 2**53, 6, 1]


def test_an_integer_that_no_double_holds_is_an_error(tmp_path: Path) -> None:
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 3)
    (tmp_path / "one.toml").write_text(
        f'name = "one"\n[experiment]\nstop_time = 0.02\n[units.a]\nfmu = "{fmu}"\nisolation = "none"\n'
        "start = { int64_in = 9007199254740992 }\n"
    )
    with pytest.raises(RunError, match=r"unit 'a': int64 = 9007199254740993 is more than a double holds"):
        simulate(tmp_path / "one.toml", trust=True)


def test_an_array_is_refused_by_name(tmp_path: Path) -> None:
    interface: UnitInterface = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 3)).interface
    assert "wheels" not in interface.variables
    with pytest.raises(
        ConfigError, match=r"here: unit 'a': wheels is an array, Float64\[2\]; arrays are not"
    ):
        interface.require("a", "wheels", ("output",), "here")


def test_what_a_step_returns_beside_its_status(tmp_path: Path) -> None:
    reason = r"fmi3DoStep returned early, at t = 0.51 s, though early return is not"
    with pytest.raises(RunError, match=rf"t = 0.5 s \(step 50\): unit 'a': {reason}"):
        simulate(alone(tmp_path, 4), trust=True)
    ended = simulate(alone(tmp_path, 3), trust=True)
    assert ended.time[-1] == 0.51
    assert ended.manifest["ended"] == "unit 'a' asked to end the simulation at t = 0.51 s"


@pytest.mark.parametrize("kind", ["int8", "uint8", "int16", "uint16", "uint32", "int64", "uint64"])
def test_a_number_beyond_its_type_is_refused(tmp_path: Path, kind: str) -> None:
    unit = Fmi3Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 3)), "a")
    try:
        limits = unit.type_of(unit.interface.variables[f"{kind}_in"])
        for number in (limits.low, limits.high):
            unit.set(f"{kind}_in", int(number))
            assert unit.get(f"{kind}_in") == number
        for number in (limits.low - 1, limits.high + 1):
            with pytest.raises(UnitError, match=rf"unit 'a': {kind}_in cannot be set to .*: it is of type "):
                unit.set(f"{kind}_in", int(number))
    finally:
        unit.free()


def test_the_path_of_the_resources_ends_with_a_separator() -> None:
    assert resources_path(Path("/units/a b")) == b"/units/a b/resources/"
