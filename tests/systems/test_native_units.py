"""Native units in the systems: the same results as units in Python, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim import Simulation, budget, identify, simulate
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import system_names
from evcosim.fmus.native import build
from evcosim.master import builtin
from evcosim.master.reproduce import papers
from evcosim.master.studies import bus_budget, identification
from evcosim.master.studies.parallel import Task
from support.needs import need_c_compiler

DETAILED = {"fmus": {"vehicle": "DetailedTwoWheeler"}}
RUNS = [
    *((name, None, {}) for name in system_names()),
    ("scooter", "ece15", {"stop_time": 60.0}),
    ("multi_drive", None, {"parameters": {"left_drive.ideal": False, "right_drive.ideal": False}}),
    ("braking", None, DETAILED),
    ("lane_keeping", "crosswind", {}),
]


@pytest.fixture(autouse=True)
def _compiler():
    need_c_compiler()


@pytest.mark.parametrize(("system", "scenario", "options"), RUNS)
@pytest.mark.parametrize("engine", ["compiled", "python"])
def test_native_units_give_the_bits_of_units_in_python(system, scenario, options, engine):
    python = simulate(system, scenario, engine=engine, **options)
    native = simulate(system, scenario, engine=engine, units="native", **options)
    assert python.names == native.names
    for name in python.names:
        assert np.array_equal(python[name], native[name], equal_nan=python[name].dtype.kind == "f"), name
    assert python.metrics == native.metrics
    assert all("_native_" in unit["file"] for unit in native.manifest["units"].values())
    assert all("_native_" not in unit["file"] for unit in python.manifest["units"].values())


def test_native_units_run_in_this_process_and_the_command_repeats_them():
    with Simulation("scooter", "fig8", units="native", stop_time=0.1) as run:
        assert set(run.isolation.values()) == {"none"}
        assert "--units native" in run.results.manifest["command"]


def test_auto_takes_what_is_equal_and_leaves_the_rest_in_python(monkeypatch):
    monkeypatch.setattr(build, "difference", lambda name: "y differs" if name == "Battery" else "")
    assert builtin.left_in_python("Battery") == "y differs"
    with Simulation("scooter", "fig8", units="auto", stop_time=0.1) as run:
        files = {name: unit["file"] for name, unit in run.results.manifest["units"].items()}
    assert {name for name, file in files.items() if "_native_" not in file} == {"battery"}


def test_a_unit_that_cannot_be_native_is_refused_with_the_reason(monkeypatch):
    monkeypatch.setattr(build, "why_not", lambda name: "there is no C compiler" if name == "Battery" else "")
    with pytest.raises(ConfigError, match=r"units\.battery\.fmu: Battery cannot be a native unit: there"):
        simulate("scooter", "fig8", units="native", stop_time=0.1)
    assert simulate("scooter", "fig8", units="auto", stop_time=0.1).time[-1] == 0.1


class _Asked(Exception):
    """The kind of units that somebody asked for."""


def _asking(*_, **options):
    raise _Asked(options["units"])


@pytest.mark.parametrize(("given", "asked"), [({}, "auto"), ({"units": "python"}, "python")])
def test_what_runs_many_times_takes_native_units_by_itself(monkeypatch, given, asked):
    monkeypatch.setattr(bus_budget, "prepare", _asking)
    with pytest.raises(_Asked, match=asked):
        budget("scooter", **given)
    monkeypatch.setattr(identification, "Simulation", _asking)
    with pytest.raises(_Asked, match=asked):
        identify("scooter", **given)


def test_tasks_of_papers_run_with_the_kind_of_units_that_was_asked_for():
    file = papers._of_kind("native", Task("", builtin.fmu_file, ("Rider",)))
    assert "_native_" in file.name
    assert "_native_" not in builtin.fmu_file("Rider").name
