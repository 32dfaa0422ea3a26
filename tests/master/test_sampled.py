"""When an output of a stranger counts, and when one of ours: both engines, each version of FMI, swaps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.cosim.swap.sampled import sampled_in
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.prepare import prepare
from evcosim.master.simulation import Simulation, simulate
from support.watch import watch_fmu

SYSTEM = """
name = "stairs"
[experiment]
stop_time = 3.0
[units.a]
fmu = "{fmu}"
isolation = "{isolation}"
{more}
[units.b]
fmu = "{fmu}"
isolation = "none"
sampled = false
[[connect]]
from = "a.stairs"
to = ["b.count"]
[[connect]]
from = "a.begin"
to = ["b.u"]
"""
OTHER = '<VendorAnnotations><Tool name="other"><Sampled outputs="stairs"/></Tool></VendorAnnotations>'
OURS = OTHER.replace("</V", '<Tool name="evcosim"><Sampled outputs="{}"/></Tool></V')


def stairs(
    folder: Path, fmi: int = 2, more: str = "", isolation: str = "none", annotations: str = ""
) -> Path:
    fmu = watch_fmu(folder / f"watch{fmi}.fmu", fmi, annotations)
    path = folder / "stairs.toml"
    path.write_text(SYSTEM.format(fmu=fmu, isolation=isolation, more=more))
    return path


def change(results: Results, name: str) -> float:
    """The time [s] of the first change of a variable."""
    return float(results.time[np.flatnonzero(np.diff(results[name]))[0] + 1])


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_a_discrete_output_of_a_stranger_belongs_to_the_time_after_the_step(
    tmp_path: Path, fmi: int, engine: str
) -> None:
    results = simulate(stairs(tmp_path, fmi), engine=engine, trust=True)
    assert np.array_equal(results["a.stairs"], np.floor(results.time))
    assert change(results, "a.stairs") == change(results, "b.stairs") == 1.0
    # b steps after a and takes what a has newly computed, as of its continuous outputs
    assert change(results, "b.count") == 0.99


def test_isolated_and_in_jacobi_it_does_too(tmp_path: Path) -> None:
    here, apart = (simulate(stairs(tmp_path, isolation=i), trust=True) for i in ("none", "process"))
    assert np.array_equal(here.data, apart.data)
    results = simulate(stairs(tmp_path), algorithm="jacobi", trust=True)
    assert change(results, "a.stairs") == change(results, "b.count") == 1.0


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(
    ("more", "annotations", "sampled"),
    [
        ("", "", []),
        ("sampled = true", "", ["stairs", "copy"]),
        ('sampled = ["stairs", "begin"]', "", ["begin", "stairs"]),
        ("", OURS.format("stairs begin"), ["begin", "stairs"]),
        ("sampled = false", OURS.format("stairs"), []),
        ("", OURS.format(""), []),
        ("", OTHER, []),
    ],
)
def test_the_file_or_the_fmu_tells(
    tmp_path: Path, engine: str, more: str, annotations: str, sampled: list[str]
) -> None:
    with Simulation(
        stairs(tmp_path, more=more, annotations=annotations), engine=engine, trust=True
    ) as simulation:
        simulation.run()
        results = simulation.results
    assert results.manifest["units"]["a"]["sampled"] == sampled
    assert change(results, "a.stairs") == (0.99 if "stairs" in sampled else 1.0)
    assert change(results, "a.begin") == (0.01 if "begin" in sampled else 0.02)
    assert results.variable("a.begin").held == ("begin" in sampled)


def test_fmi_3_tells_by_an_annotation(tmp_path: Path) -> None:
    told = '<Annotations><Annotation type="evcosim"><Sampled outputs="stairs"/></Annotation></Annotations>'
    assert sampled_in(read_fmu(watch_fmu(tmp_path / "a.fmu", 3, told)).interface) == ("stairs",)


def test_what_is_wrong_in_the_file_names_it(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"stairs\.toml: units\.a\.sampled: unit 'a' has no variable 'stiars'"
    ):
        simulate(stairs(tmp_path, more='sampled = ["stiars"]'), trust=True)


def inheriting(folder: Path, more: str = "", **options: Any) -> Simulation:
    """The system with another file in the place of unit a, by a swap file that has `more`."""
    other = watch_fmu(folder / "other.fmu")
    (folder / "swap.toml").write_text(f'fmu = "{other}"\nisolation = "none"\n{more}\n')
    return Simulation(folder / "stairs.toml", **options or {"swaps": {"a": folder / "swap.toml"}}, trust=True)


@pytest.mark.parametrize("how", ["annotation", "file"])
def test_an_fmu_inherits_from_the_place_that_it_takes(tmp_path: Path, how: str) -> None:
    if how == "file":
        stairs(tmp_path, more='sampled = ["stairs"]')
    else:
        stairs(tmp_path, annotations=OURS.format("stairs"))
    for options in ({}, {"fmus": {"a": str(tmp_path / "other.fmu")}}):
        with inheriting(tmp_path, **options) as simulation:
            simulation.run()
            assert change(simulation.results, "a.stairs") == 0.99
            (said,) = [text for text in simulation.warnings if "sampled" in text]
            assert said.startswith("unit 'a': stairs of ")
    with inheriting(tmp_path, "sampled = false") as simulation:
        simulation.run()
        assert change(simulation.results, "a.stairs") == 1.0
        assert not [text for text in simulation.warnings if "sampled" in text]


@pytest.mark.parametrize(
    ("more", "time"),
    [('sampled = ["stairs"]', 0.99), ("sampled = true", 0.99), ("sampled = false", 1.0), ("", 1.0)],
)
def test_the_place_of_an_fmu_that_is_not_there_is_known_by_its_keys(
    tmp_path: Path, more: str, time: float
) -> None:
    path = stairs(tmp_path, more=more)
    path.write_text(path.read_text().replace("watch2.fmu", "gone.fmu", 1))
    for options in ({}, {"fmus": {"a": str(tmp_path / "other.fmu")}}):
        with inheriting(tmp_path, **options) as simulation:
            simulation.run()
            assert change(simulation.results, "a.stairs") == time
            said = [text for text in simulation.warnings if "sampled" in text]
        assert len(said) == (more != "sampled = false")
        assert ("are unknown: stairs, copy are not taken as sampled" in "".join(said)) == (not more)


def test_an_fmu_of_an_earlier_evcosim_is_warned_of(tmp_path: Path) -> None:
    path = stairs(tmp_path)
    assert not [text for text in prepare(path, trust=True).plan.warnings if "earlier" in text]
    old = watch_fmu(tmp_path / "watch2.fmu", tool="evcosim 0.1.0 with pythonfmu 0.6.9")
    (said,) = [
        text for text in prepare(path, trust=True).plan.warnings if "earlier" in text
    ]  # b says sampled = false
    assert said.startswith(f"unit 'a': {old} was built by an earlier evcosim")


def test_our_controllers_tell_theirs_and_plants_have_none(tmp_path: Path) -> None:
    controller = read_fmu(fmu_file("BoundController")).interface
    assert controller.tells_sampled
    assert "throttle" in sampled_in(controller)
    assert {v.name for v in controller.of_causality("output") if v.variability == "discrete"} == set(
        sampled_in(controller)
    )
    plant = read_fmu(fmu_file("Scooter")).interface
    assert plant.tells_sampled
    assert not [n for n in sampled_in(plant) if plant.variables[n].variability == "continuous"]


def test_check_says_what_is_inherited(evcosim: Any, tmp_path: Path) -> None:
    path = stairs(tmp_path, annotations=OURS.format("stairs begin"))
    said = evcosim("check", watch_fmu(tmp_path / "other.fmu"), "--as", f"{path}.a").out
    assert f"taken as sampled, as in {path}.a: stairs, begin; they hold" in " ".join(said.split())
