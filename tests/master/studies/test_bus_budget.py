"""The bus budget of systems that hold, break, fail and die."""

from __future__ import annotations

import json
import math
import resource
from pathlib import Path

import pytest

from evcosim import simulate
from evcosim.cosim.analysis.bus_budget import as_data
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.selection import metric_specs
from evcosim.cosim.system.system import load_system, system_names
from evcosim.fmus.build import build_model
from evcosim.master.studies.bus_budget import budget
from evcosim.master.studies.parallel import TaskError
from support import bus_models
from support.forked import forked
from support.needs import need_linux

SYSTEM = """name = "line"
[experiment]
stop_time = 1.0
[units.clock]
fmu = "Clock.fmu"
[units.picky]
isolation = "none" # so that its end is that of the process that measures
fmu = "Picky.fmu"
[buses.can0]
dbc = "line.dbc"
[[connect]]
from = "clock.way"
to = ["picky.way"]
via = "can0.Way.Meters"
[[metrics]]
name = "arrived"
signal = "picky.seen"
unit = "m"
[[metrics]]
name = "settled"
signal = "picky.seen"
reduce = "settling"
threshold = 1.0
unit = "s"
[budget]
metric = "arrived"
kind = "min"
limit = 97.5
"""
DBC = """VERSION ""
NS_ :
BS_:
BU_: A B
BO_ 16 Way: 2 A
 SG_ Meters : 0|16@1+ (0.5,0) [0|1000] "m" B
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_ "GenMsgCycleTime" BO_ 16 10;
"""


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    """A folder with a system that loses a meter with each step of delay and minds jumps."""
    folder = tmp_path_factory.mktemp("line")
    for model in (bus_models.Clock, bus_models.Picky):
        build_model(model, folder)
    (folder / "line.dbc").write_text(DBC)
    (folder / "line.toml").write_text(SYSTEM)
    return folder


@pytest.fixture(scope="module")
def measured(line):
    """Its budget, and what was told of the progress."""
    told = []
    found = budget(line / "line.toml", progress=lambda *args: told.append(args), trust=True)
    return found, told


# ---- runs


def value(found, label):
    """The point of a label."""
    return next(p for each in found.series for p in each.points if p.label == label)


def test_points_are_what_simulate_gives(line, measured):
    found, _ = measured
    for label in ("+0 steps", "+2 steps (20 ms)", "ideal", "DBC x 4", "x 2"):
        point = value(found, label)
        arrived = simulate(line / "line.toml", bus=point.bus, trust=True).metrics()[0]
        assert point.value == arrived.value
    nominal = value(found, "+0 steps").value
    delays = [p.value for p in found.series[0].points]
    assert delays == [nominal - d for d in range(4)]  # a meter for each step
    assert [found.summary(each) for each in found.series] == [
        "breaks at +2 steps (20 ms)",
        "fails at DBC x 8",
        "fails at x 4",
    ]


def test_a_failed_run_and_a_dead_process_are_failed_points(measured):
    found, told = measured
    failed, dead = value(found, "x 4"), value(found, "x 8")
    assert "a jump of 4 m" in failed.reason
    assert "t = 0.04 s" in failed.reason
    assert dead.reason == "its process died: exit code 7"
    assert math.isnan(failed.value) and math.isnan(dead.value)
    assert failed.failed and dead.failed
    assert "a jump of 4 m" in value(found, "DBC x 8").reason
    assert [(done, total) for done, total, _ in told] == [
        (i, 11) for i in range(1, 12)
    ]  # the nominal one once


def test_a_run_for_which_the_machine_has_no_room_is_no_broken_point(line, monkeypatch, tmp_path):
    need_linux()

    def measure() -> str:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
        with pytest.raises(TaskError) as caught:
            budget(line / "line.toml", workers=1, trust=True)
        return str(caught.value)

    found = forked(measure, limit=60.0)
    assert not found.crash, found.crash
    assert found.value.startswith("bus delay +0 steps: unit 'clock': ")
    assert "cannot be extracted: File too large: the limit of a file's size is 1 KiB" in found.value


@pytest.mark.usefixtures("warm_workers")
def test_same_outcome_however_many_workers(line, measured):
    assert budget(line / "line.toml", workers=3, trust=True) == measured[0]


def test_a_metric_without_a_value_is_broken(line):
    path = line / "settled.toml"
    path.write_text(SYSTEM.replace('metric = "arrived"', 'metric = "settled"'))
    found = budget(path, workers=1, stop_time=0.1, trust=True)
    assert found.summary(found.series[0]) == "broken as it is"
    assert found.rows()[0][2:] == ("-", "broken: it is beyond the threshold at the end")


# ---- errors before any run


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("[budget]", "[other]", "other: unknown key"),
        ('metric = "arrived"', 'metric = "arived"', r"'arived' \(did you mean 'arrived'\?\); there are"),
        ("limit = 97.5", "limit = inf", "budget.limit: .* finite"),
        ("limit = 97.5", "", "budget.limit: this key is needed"),
        ('kind = "min"', 'kind = "least"', "budget.kind: .*'max' or 'min'"),
        ('via = "can0.Way.Meters"', "", "no unit receives anything over a bus"),
        ('to = ["picky.way"]', "", "no unit receives anything over a bus"),
    ],
)
def test_wrong_budget_tables(line, old, new, text):
    assert old in SYSTEM
    path = line / "wrong.toml"
    path.write_text(SYSTEM.replace(old, new))
    with pytest.raises(ConfigError, match=text):
        budget(path, trust=True)


def test_no_budget_table(evcosim, line):
    path = line / "none.toml"
    path.write_text(SYSTEM.split("[budget]")[0])
    answer = evcosim("budget", path)
    assert (answer.code, answer.out) == (2, "")
    assert "none.toml: the system does not say what it is judged by; give it a table [budget]" in answer.err


# ---- the command


def test_timing_jitter_and_losses_over_seeds(line):
    """A frame is seen a step later, and one of a hundred that is lost is a jump or a meter less."""
    found = budget(line / "line.toml", workers=1, trust=True, seeds=2, stop_time=0.3)
    timing, losses = found.series[3:]
    assert timing.points[1].value == found.series[0].points[1].value  # a delay of one step
    assert [len(point.values) for point in losses.points] == [0, 2, 2, 2, 2]
    for point in (losses.points[2], timing.points[2]):
        for run, value in zip(point.runs(), point.values, strict=True):
            try:
                expected = simulate(line / "line.toml", bus=run, trust=True, stop_time=0.3).metrics()[0].value
            except RunError:
                expected = math.nan
            assert value == pytest.approx(expected, abs=0.0, nan_ok=True)
    lost = simulate(line / "line.toml", bus=losses.points[1].bus, trust=True, stop_time=0.3).manifest
    assert [(fault["action"], fault["probability"]) for fault in lost["faults"]] == [("lose", 0.01)]


@pytest.mark.parametrize("seeds", [-1, 1.5, True, 10**9])
def test_a_wrong_number_of_seeds(line, seeds):
    with pytest.raises(ConfigError, match=r"seeds = .* it is a whole number from 0 to 1000"):
        budget(line / "line.toml", seeds=seeds, trust=True)


@pytest.mark.usefixtures("warm_workers")
def test_command(evcosim, line, measured, tmp_path):
    answer = evcosim("budget", line / "line.toml", "-o", "out")
    assert (answer.code, answer.err) == (0, "")
    for text in (
        "line, arrived: at least 97.5 m (* as it is)",
        "bus delay          +0 steps *",
        "failed: its process died: exit code 7",
        "message cycle      fails at x 4",
        "in out: budget.md, budget.json, budget.png, budget.svg, budget.csv",
    ):
        assert text in answer.out, answer.out
    written = json.loads((tmp_path / "out" / "budget.json").read_text())
    assert Path(written.pop("settings")["system"]) == line / "line.toml"  # by which the folder is known again
    assert written == as_data(measured[0])
    assert "![arrived over each variation](budget.png)" in (tmp_path / "out" / "budget.md").read_text()


@pytest.mark.usefixtures("warm_workers")
def test_command_as_json_and_where_it_writes(evcosim, line, measured, tmp_path):
    data = evcosim("budget", line / "line.toml", "--json", "--workers", "1").json
    assert data["series"] == as_data(measured[0])["series"]
    assert data["folder"] == "results/line-budget"
    assert {p.name for p in (tmp_path / data["folder"]).iterdir()} == set(data["files"])


@pytest.mark.usefixtures("warm_workers")
def test_settings_count(evcosim, line):
    data = evcosim("budget", line / "line.toml", "--json", "--set", "picky.fails=5", "--workers", "1").json
    assert [each["first_broken"] for each in data["series"]] == ["+2 steps (20 ms)", None, "x 4"]


@pytest.mark.parametrize("name", system_names())
def test_every_system_names_a_metric_of_its_default_scenario(name):
    system = load_system(name)
    assert system.file.budget is not None
    assert system.file.budget.metric in {m.name for m in metric_specs(system, load_scenario(system))}
