"""The same unit in FMI 1.0, 2.0 and 3.0: the same numbers, every common type, every status of a step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.simulation import simulate
from evcosim.master.unit import Unit
from support.c_fmu import mixed_fmu

VERSIONS = (1, 2, 3)

SYSTEM = """
name = "loop"
[experiment]
stop_time = 1.0
algorithm = "{algorithm}"
[units.a]
fmu = "{fmu}"
isolation = "none"
parameters = {{ gain = -1.5, title = "a" }}
start = {{ u = 1.0 }}
[units.b]
fmu = "{fmu}"
isolation = "none"
substeps = 2
[[connect]]
from = "a.y"
to = ["b.u"]
[[connect]]
from = "b.count"
to = ["a.count_in"]
[[connect]]
from = "a.switch"
to = ["b.switch_in"]
"""


def loop(folder: Path, fmi: int, algorithm: str = "gauss_seidel", behavior: int = 0) -> Path:
    fmu = mixed_fmu(folder / f"mixed{fmi}{behavior}.fmu", fmi, behavior)
    path = folder / "loop.toml"
    path.write_text(SYSTEM.format(fmu=fmu, algorithm=algorithm))
    return path


def unit_of(path: Path) -> Unit:
    fmu = read_fmu(path)
    return load_unit(fmu, "a", fmu.interface)


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_the_versions_of_fmi_give_the_same_numbers(tmp_path: Path, algorithm: str) -> None:
    first, second, third = (simulate(loop(tmp_path, fmi, algorithm), trust=True) for fmi in VERSIONS)
    for name in first.names:
        assert np.array_equal(first[name], second[name]), name
        assert np.array_equal(first[name], third[name]), name
    assert first["a.y"][-1] == pytest.approx(-1.5 * (1.0 - 0.99**100))
    assert second["a.count"][-1] > 0


@pytest.mark.parametrize("fmi", VERSIONS)
def test_every_common_type_can_be_set_and_read(tmp_path: Path, fmi: int) -> None:
    unit = unit_of(mixed_fmu(tmp_path / "mixed.fmu", fmi))
    try:
        unit.set("title", "Grüße")
        unit.enter_initialization(0.0, None)
        unit.set("count_in", -7)
        unit.set("switch_in", True)
        unit.exit_initialization()
        unit.start_step(FmuSteps.equal(0.0, 0.01, 1))
        unit.finish_step()
        assert [unit.get(n) for n in ("count", "switch", "shown")] == [-6, False, "Grüße"]
        unit.terminate()
    finally:
        unit.free()


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(
    ("status", "word"), [(2, "Discard"), (3, "Error"), (4, "Fatal"), (7, "no FMI status")]
)
def test_every_status_of_a_step_is_told(tmp_path: Path, fmi: int, status: int, word: str) -> None:
    with pytest.raises(RunError) as caught:
        simulate(loop(tmp_path, fmi, behavior=10 + status), trust=True)
    prefix = {1: "fmi", 2: "fmi2", 3: "fmi3"}[fmi]
    assert f"t = 0.5 s (step 50): unit 'a': {prefix}DoStep returned {word} ({status})" in str(caught.value)
    assert "as it was told, 100 %" in str(caught.value)
    assert len(caught.value.results) == 50


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_warning_is_counted_and_goes_on(tmp_path: Path, fmi: int) -> None:
    results = simulate(loop(tmp_path, fmi, behavior=11), trust=True)
    assert len(results) == 101
    (warning, _) = results.manifest["warnings"]
    assert warning.startswith("unit 'a' gave ")


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(("behavior", "call"), [(23, "Set"), (33, "Get")])
def test_a_value_that_cannot_be_passed_on_is_named(
    tmp_path: Path, fmi: int, behavior: int, call: str
) -> None:
    with pytest.raises(
        RunError, match=rf"unit 'a': fmi\d?{call}\w+ of \w+ returned Error \(3\)|{call}\w+ returned Error"
    ):
        simulate(loop(tmp_path, fmi, behavior=behavior), trust=True)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_nan_stops_the_run(tmp_path: Path, fmi: int) -> None:
    with pytest.raises(RunError, match=r"t = 0.5 s \(step 50\): a.y = nan: an output must be finite"):
        simulate(loop(tmp_path, fmi, behavior=2), trust=True)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_an_fmu_that_refuses_to_be_instantiated(tmp_path: Path, fmi: int) -> None:
    with pytest.raises(FmuError, match=r"mixed\d1.fmu: cannot be instantiated"):
        simulate(loop(tmp_path, fmi, behavior=1), trust=True)
