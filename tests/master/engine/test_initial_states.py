"""Start values of states: local variables and outputs whose initial value an FMU lets be given."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.simulation import simulate
from support.c_fmu import vehicle_fmu
from support.initial import initial_fmu

KINDS = [(1, "CS"), (1, "ME"), (2, "CS"), (3, "CS"), (2, "ME"), (3, "ME")]
WAYS = [("none", "python"), ("none", "compiled"), ("process", "compiled")]
STATE = "start = { u = 2.0, h = 2.5 }"


def run(fmu: Path, unit: str = "", scenario: str = "", **options: Any) -> Results:
    """A system of this FMU alone for ten steps, in which its local variable h is recorded."""
    path = fmu.with_name("alone.toml")
    path.write_text(
        f'name = "alone"\nrecord = ["*", "a.h"]\n[experiment]\nstop_time = 0.1\n[units.a]\n'
        f'fmu = "{fmu.name}"\n{unit}\n'
    )
    if not scenario:
        return simulate(path, **options, trust=True)
    (fmu.parent / "driven.toml").write_text(scenario)
    return simulate(path, fmu.parent / "driven.toml", **options, trust=True)


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
@pytest.mark.parametrize(("isolation", "engine"), WAYS)
def test_a_state_begins_where_it_is_told(
    tmp_path: Path, fmi: int, kind: str, isolation: str, engine: str
) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    results = run(fmu, STATE, isolation=isolation, engine=engine)
    rate = 2.0 if kind == "CS" else 0.0  # h sums up the steps times u in Co-Simulation
    np.testing.assert_allclose(results["a.h"], 2.5 + rate * results.time, rtol=1e-12)
    assert results.manifest["units"]["a"]["start"] == {"u": 2.0, "h": 2.5}


@pytest.mark.parametrize(("fmi", "kind"), KINDS)
def test_it_is_as_fmpy_does_it(tmp_path: Path, fmi: int, kind: str) -> None:
    from fmpy import simulate_fmu

    fmu = initial_fmu(tmp_path / "initial.fmu", fmi, kind)
    theirs = simulate_fmu(
        str(fmu), stop_time=0.1, output_interval=0.01, step_size=0.01, start_values={"u": 2.0, "h": 2.5},
        output=["h"], fmi_type={"CS": "CoSimulation", "ME": "ModelExchange"}[kind],
    )  # fmt: skip # what the run below has
    np.testing.assert_allclose(run(fmu, STATE, isolation="none")["a.h"], theirs["h"], rtol=1e-12)


def test_the_scenario_comes_before_the_system_and_the_option_before_both(tmp_path: Path) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 2)
    scenario = "[start.a]\nh = 3.5\n"
    assert run(fmu, STATE, scenario, isolation="none")["a.h"][0] == 3.5
    option = {"a.h": 4.5, "a.p": 5.0, "a.u": 3.0}
    results = run(fmu, STATE, scenario, isolation="none", parameters=option)
    assert results["a.h"][0] == 4.5
    assert (results["a.u"][0], results["a.y"][0]) == (3.0, 15.0)
    assert results.manifest["units"]["a"]["parameters"] == {"p": 5.0}


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_output_begins_where_it_is_told(tmp_path: Path, fmi: int) -> None:
    fmu = vehicle_fmu(tmp_path / "vehicle.fmu", fmi)
    path = tmp_path / "alone.toml"
    path.write_text(
        f'name = "alone"\n[experiment]\nstop_time = 0.1\n[units.a]\nfmu = "{fmu.name}"\n'
        'isolation = "none"\nstart = { v = 7.0 }\n'
    )
    assert simulate(path, trust=True)["a.v"][0] == 7.0


def test_a_state_goes_by_the_name_and_the_sign_of_the_system(tmp_path: Path) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 2)
    path = tmp_path / "mapped.toml"
    path.write_text(
        f'name = "alone"\n[experiment]\nstop_time = 0.1\n[units.a]\nfmu = "{fmu.name}"\nisolation = "none"\n'
        "start = { depth = 2.5, u = 2.0 }\n"
        '[units.a.map.outputs]\ndepth = { variable = "h", invert = true }\n'
    )
    results = simulate(path, trust=True)
    np.testing.assert_allclose(results["a.depth"], 2.5 - 2.0 * results.time, rtol=1e-12)


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        ("y = 1.0", "a.y is a continuous output whose initial value the FMU computes or fixes"),
        ("der_h = 1.0", "a.der_h is a continuous local whose initial value"),
        ("p = 1.0", "a.p is of causality parameter, not input or output or local"),
        ('h = "high"', "h is a finite Real number, not 'high'"),
        ("nothing = 1.0", "unit 'a' has no variable 'nothing'"),
    ],
)
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_what_cannot_be_given_is_refused_by_name(tmp_path: Path, fmi: int, start: str, reason: str) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", fmi)
    with pytest.raises(ConfigError, match=rf"alone.toml: units.a.start.\w+: .*{reason}"):
        run(fmu, f"start = {{ {start} }}")


def test_a_driven_input_has_no_start_value_by_option(tmp_path: Path) -> None:
    fmu = initial_fmu(tmp_path / "initial.fmu", 2)
    with pytest.raises(
        ConfigError, match=r"parameter a.u: the input is driven by a stimulus of .*driven.toml"
    ):
        run(fmu, scenario='[[stimulus]]\nto = "a.u"\nconstant = 3.0\n', parameters={"a.u": 1.0})


def test_our_own_fmus_compute_their_outputs() -> None:
    variables = read_fmu(fmu_file("Scooter")).interface.of_causality("output", "local")
    assert variables and not any(v.takes_start for v in variables)
