"""A unit of FMI 1.0 has no initialization mode: before its first step its values are those that were set.

That its Model Exchange is that of FMI 2.0 and 3.0, event for event, stands in test_exchange.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.results.results import Results
from evcosim.master.fmi.fmi1 import Fmi1ModelExchange, Fmi1Unit
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.simulation import simulate
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu
from support.descriptions import redescribed
from support.equations import equations_fmu


@pytest.fixture
def unit(tmp_path: Path) -> Iterator[Fmi1Unit]:
    made = Fmi1Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 1)), "a")
    yield made
    made.free()


def test_before_the_initialization_a_value_is_the_one_that_was_set_else_the_start(unit: Fmi1Unit) -> None:
    assert [unit.get(name) for name in ("u", "gain", "title", "count_in")] == [0.0, 1.0, "some text", 0]
    assert [unit.get(name) for name in ("y", "count", "switch", "shown")] == [0.0, 0, False, ""]
    unit.set("gain", 2.5)
    unit.set("title", "another")
    assert [unit.get("gain"), unit.get("title")] == [2.5, "another"]
    unit.enter_initialization(0.0, 1.0)
    unit.exit_initialization()
    assert [unit.get("gain"), unit.get("title")] == [2.5, "another"]  # now the slave says so


def test_its_functions_have_the_name_of_the_model_before_them(unit: Fmi1Unit) -> None:
    assert unit._prefix() == "mixed_"
    assert unit.function("fmiDoStep") is not None


def test_it_is_told_no_tolerance(tmp_path: Path) -> None:
    unit = Fmi1Unit(read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 1)), "a", tolerance=1e-3)
    assert unit.tolerance is None
    unit.free()


def test_it_saves_no_state(unit: Fmi1Unit) -> None:
    with pytest.raises(UnitError, match=r"unit 'a': FMI 1.0 has no functions that save a state"):
        unit.save_state()


def test_without_an_initialization_there_is_nothing_to_terminate(unit: Fmi1Unit) -> None:
    unit.terminate()
    assert unit.step_call is None


# ---- Model Exchange

NEAR = 'isolation = "none"\n'


def run(fmu: Path, unit: str = "", scenario: str = "", **options: Any) -> Results:
    """A system of this FMU alone, for 3 s."""
    path = fmu.with_suffix(".toml")
    path.write_text(
        f'name = "alone"\n[experiment]\nstop_time = 3.0\n[units.a]\nfmu = "{fmu.name}"\n{unit or NEAR}'
    )
    if not scenario:
        return simulate(path, trust=True, **options)
    path.with_name("driven.toml").write_text(scenario)
    return simulate(path, path.with_name("driven.toml"), trust=True, **options)


def exchanged(tmp_path: Path, model: str = "oscillator", behavior: int = 0) -> Fmi1ModelExchange:
    return Fmi1ModelExchange(read_fmu(equations_fmu(tmp_path / "a.fmu", model, 1, behavior=behavior)), "a")


def test_its_values_are_those_that_were_set_before_it_gives_its_own(tmp_path: Path) -> None:
    unit = exchanged(tmp_path, "timer")
    assert [unit.get(name) for name in ("label", "level", "count")] == ["a label", 0.0, 0]
    unit.set("label", "another")
    assert (unit.get("label"), unit.get("shown")) == ("another", "")
    unit.enter_initialization(0.0, 1.0)
    unit.exit_initialization()
    assert (unit.get("label"), unit.get("shown"), unit.get("on")) == ("another", "another", True)
    unit.terminate()
    unit.free()


def test_it_saves_no_state_either(tmp_path: Path) -> None:
    unit = exchanged(tmp_path)
    with pytest.raises(UnitError, match=r"unit 'a': FMI 1.0 has no functions that save a state"):
        unit.save_state()
    unit.free()


def test_types_of_another_platform_are_refused(tmp_path: Path) -> None:
    with pytest.raises(
        FmuError, match=r"a.fmu: the types of its library are those of the platform 'standard64'"
    ):
        exchanged(tmp_path, behavior=10)


def test_an_fmu_that_refuses_its_guid_says_so_before_it_has_a_component(tmp_path: Path) -> None:
    fmu = redescribed(equations_fmu(tmp_path / "a.fmu", "ball", 1), ('guid="e"', 'guid="another"'))
    with pytest.raises(FmuError, match=r"the GUID 'another' of modelDescription.xml.*\n.*the GUID is not e"):
        Fmi1ModelExchange(read_fmu(fmu), "a")


DRIVEN = """
[[stimulus]]
to = "a.u"
table = [[0.0, 2.0], [1.0, 0.0]]
interpolation = "hold"
"""


def test_inputs_that_come_late_are_an_event(tmp_path: Path) -> None:
    """u = 2 passes the relay's threshold at 0 s; given before the initialization it is no event."""
    early, late = (
        run(equations_fmu(tmp_path / f"relay{behavior}.fmu", "relay", 1, behavior=behavior), "", DRIVEN)
        for behavior in (0, 11)
    )
    assert (early["a.count"][0], late["a.count"][0]) == (0, 1)
    np.testing.assert_array_equal(early["a.x0"], late["a.x0"])
    (warning,) = late.manifest["warnings"]
    assert "fmiSetReal of u returned Error (3) before the initialization" in warning
    assert "it gets its inputs after it only" in warning


def test_events_that_the_initialization_leaves_are_iterated(tmp_path: Path) -> None:
    for model in ("ball", "timer"):
        whole, left = (
            run(equations_fmu(tmp_path / "a.fmu", model, 1, behavior=behavior)) for behavior in (0, 12)
        )
        for name in whole.names:
            np.testing.assert_array_equal(whole[name], left[name], err_msg=name)


def test_an_initialization_that_fails_is_named(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"unit 'a': fmiInitialize returned Error \(3\)"):
        run(equations_fmu(tmp_path / "a.fmu", "ball", 1, behavior=13))


def test_a_state_without_a_variable_is_named_by_its_number(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"there der\(state 2\) = nan, at t = 0.5"):
        run(equations_fmu(tmp_path / "a.fmu", "oscillator", 1, behavior=1))


def test_an_enumeration_takes_the_names_of_its_items(tmp_path: Path) -> None:
    fmu = equations_fmu(
        tmp_path / "timer.fmu", "timer", 1, types={"demand": "Enumeration", "seen": "Enumeration"}
    )
    scenario = '[[stimulus]]\nto = "a.demand"\ntable = [[0.0, "level 2"], [1.0, "level 7"]]\n'
    results = run(fmu, "", scenario)
    assert set(results["a.seen"]) == {3.0, 8.0}


def test_a_text_is_an_event_at_its_point(tmp_path: Path) -> None:
    fmu = equations_fmu(tmp_path / "timer.fmu", "timer", 1)
    first, second = (
        run(
            fmu,
            f'isolation = "{isolation}"',
            '[[stimulus]]\nto = "a.label"\ntable = [[0.0, "one"], [1.0, "two"]]\n',
        )
        for isolation in ("none", "process")
    )
    shown = list(first["a.shown"])
    assert (shown[0], shown[100], shown[101], shown[-1]) == ("one", "one", "two", "two")
    assert shown == list(second["a.shown"])


@pytest.mark.parametrize("model", ["ball", "relay", "timer"])
def test_both_engines_are_equal(tmp_path: Path, model: str) -> None:
    fmu = equations_fmu(tmp_path / "a.fmu", model, 1)
    one, other = (run(fmu, "", DRIVEN, engine=engine) for engine in ("python", "compiled"))
    np.testing.assert_array_equal(one.data, other.data)


@pytest.mark.parametrize("model", ["oscillator", "relay", "timer", "decay"])
def test_it_is_as_fmpy_does_it(tmp_path: Path, model: str) -> None:
    from fmpy import simulate_fmu

    fmu = equations_fmu(tmp_path / "a.fmu", model, 1, behavior=14, tolerance="1e-9")
    theirs = simulate_fmu(
        str(fmu), stop_time=3.0, output_interval=0.01, relative_tolerance=1e-9, record_events=False,
        output=["x0", "y", "count"],
    )  # fmt: skip # what the run below has
    ours = run(fmu)
    assert len(ours) == len(theirs)
    for name in ("x0", "y", "count"):
        np.testing.assert_allclose(ours[f"a.{name}"], theirs[name], atol=1e-6, err_msg=name)


def test_it_takes_the_place_of_another_unit(tmp_path: Path, evcosim) -> None:
    """By a swap file that `check` writes."""
    for name, fmi in (("first", 1), ("second", 2)):
        equations_fmu(tmp_path / f"{name}.fmu", "relay", fmi)
    unit = '[units.{0}]\nfmu = "second.fmu"\n'
    (tmp_path / "pair.toml").write_text(
        'name = "pair"\n[experiment]\nstop_time = 1.0\n'
        + unit.format("a")
        + unit.format("b")
        + '[[connect]]\nfrom = "a.y"\nto = ["b.u"]\n'
    )
    (tmp_path / "driven.toml").write_text(DRIVEN)
    driven = ("-s", "driven.toml")
    assert evcosim("check", "first.fmu", "--as", "pair.toml.a", "--write", "swap.toml").code == 0
    assert evcosim("run", "pair.toml", *driven, "-o", "plain").code == 0
    assert evcosim("run", "pair.toml", *driven, "-o", "swapped", "--swap", "a=swap.toml").code == 0
    plain, swapped = (Results.read(tmp_path / name / "results.csv") for name in ("plain", "swapped"))
    assert set(swapped.names) >= {"a.y", "b.u", "b.x0", "b.count"}
    for name in swapped.names:
        np.testing.assert_array_equal(swapped[name], plain[name], err_msg=name)
