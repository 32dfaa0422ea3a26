"""The sections of a page from a manifest: of a whole run, of an earlier evcosim, and of anything at all."""

from __future__ import annotations

import math
import re

import pytest

from evcosim import Simulation
from evcosim.cosim.report import facts
from evcosim.cosim.results.metrics import Metric
from support.pages import hostile_run
from support.small_bench import bench

SECTIONS = (
    facts.first_of_all,
    facts.buses_section,
    facts.units_section,
    facts.parameters_section,
    facts.versions_section,
    facts.repeat_section,
    facts.events_of,
    lambda about: facts.metrics_section([], about),
    lambda about: facts.headline(about, 3, (0.0, 1.0)),
    lambda about: facts.manifest_section(about, []),
)


@pytest.fixture(scope="module")
def about():
    options = {"parameters": {"vehicle.mass": 180.0, "ecu.dwell_time": 0.0}, "engine": "python"}
    with Simulation("scooter", stop_time=1.0, **options) as sim:
        sim.run()
        return facts.plain(sim.manifest() | {"status": "done"})


def test_what_differs_between_equal_runs_is_left_out(about):
    assert "loop_seconds" not in about and about["steps"] == 100
    assert "process" not in facts.plain({"process": {"since": "now"}, "x": float("nan")})


def test_parameters_that_differ_and_no_others(about):
    made = facts.parameters_section(about)
    assert "vehicle.mass" in made and "180 kg" in made and "200 kg" in made
    assert "ecu.dwell_time" not in made or about["defaults"]["ecu"]["dwell_time"]["value"] != 0.0
    assert "Every parameter" in facts.parameters_section(about | {"units": {}})


def test_units_with_their_order_and_its_reason(about):
    made = facts.units_section(about)
    assert made.index("1 planner") < made.index("2 ecu") < made.index("3 vehicle")
    assert "gauss_seidel" in made and "ecu (in the same step)" in made and "<svg" in made


def test_the_head_says_how_it_ended(about):
    assert "status: done" in facts.headline(about, 101, (0.0, 1.0))
    assert "No warnings" in facts.first_of_all(about | {"warnings": []})
    failed = facts.first_of_all({"error": "unit 'x': bad", "warnings": ["w"]})
    assert failed.index("The run failed") < failed.index("bad") < failed.index("Warnings")
    assert "not complete: killed" in facts.first_of_all({"status": "killed"})


def test_metrics_with_a_reason_where_there_is_no_value():
    made = facts.metrics_section([Metric("a", 1.5, "km/h"), Metric("b", math.nan, "m", "too short")], {})
    assert "1.5 km/h" in made and "- (too short)" in made
    kept = facts.metrics_section(
        [], {"metrics": {"a": {"value": 2.0, "unit": "m/s2"}, "b": {"value": None, "unit": "1"}}}
    )
    assert "2 m/s²" in kept and ">-<" in kept


def test_buses_and_saturations(about):
    assert "can/ev.dbc" in facts.buses_section(about) and "No signal was saturated" in facts.buses_section(
        about
    )
    counts = {"saturations": {"can0.A.B": {"count": 3, "first_time": 0.5}}}
    assert "can0.A.B" in facts.buses_section(about | counts)
    assert "Left out" in facts.buses_section(about | {"ideal": True})


def test_the_command_and_the_files():
    made = facts.repeat_section({"command": "evcosim run x", "files": {"system": "/home/x.toml"}})
    assert "evcosim run x" in made and "system: /home/x.toml" in made
    assert "from Python" in facts.repeat_section({"system": "x"})


def test_events_in_words():
    events = [{"time": 1.0, "action": "override", "variable": "a.b", "value": True}, {"time": "x"}]
    faults = [{"time": 2.0, "action": "lose", "on": "can0.M", "frames": 50}, {"time": 3.0}]
    assert facts.events_of({"events": events, "faults": faults}) == [
        (1.0, "override a.b = true"),
        (2.0, "lose can0.M (50 frames)"),
    ]


@pytest.mark.parametrize(
    "value", [None, 3, "text", [], [3], ["text"], [{}], {}, {"a": 3}, {"a": {"b": 3}}, True]
)
def test_any_manifest_is_taken(about, value):
    for key in about:
        for section in SECTIONS:
            section(about | {key: value})


def test_names_are_no_markup():
    bad = facts.plain(hostile_run().manifest)
    for section in set(SECTIONS) - {facts.events_of}:
        made = section(bad)
        assert "<img" not in made and "<script" not in made and "\u202e" not in made


PAGED_DBC = """VERSION ""
NS_ :
BS_:
BU_: VCU EMD
BO_ 328 EMD_Status: 8 EMD
 SG_ EMD_Page M : 0|4@1+ (1,0) [0|15] "" VCU
 SG_ EMD_VehicleSpeed m1 : 8|8@1+ (1,0) [0|254] "km/h" VCU
 SG_ EMD_Throttle m2 : 8|8@1+ (1,0) [0|254] "%" VCU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
"""


def without_heads(page: str) -> str:
    return re.sub(' data-head="[^"]*"', "", page)


def test_signals_of_pages_have_the_times_of_their_pages(tmp_path):
    (tmp_path / "bench.dbc").write_text(PAGED_DBC)
    (tmp_path / "bench.toml").write_text(bench())
    with Simulation(tmp_path / "bench.toml", stop_time=0.1, delay=0.02) as sim:
        sim.run()
        about = facts.plain(sim.manifest())
    assert about["pages"] == {"can0.EMD_Status EMD_Page = 1": ["EMD_VehicleSpeed"]}
    times = about["effective_delays"]["can0.EMD_Status EMD_Page = 1"]["ecu"]
    cells = ("can0.EMD_Status.EMD_VehicleSpeed", "as the step begins", f"{1e3 * times['mean']:.3g}")
    assert "</td><td>".join(cells) in without_heads(facts.units_section(about))


def test_a_signal_of_several_pages_has_the_times_of_each_that_differs():
    delays = {"b.M P = 1": {"u": {"min": 0.0, "mean": 0.0, "max": 0.0}}, "b.M P = 2": {"u": None, "v": None}}
    delays["b.M P = 3"] = {"u": {"min": 0.01, "mean": 0.015, "max": 0.02}}
    pages = {"b.M P = 1": ["S", "T"], "b.M P = 2": ["S"], "b.M P = 3": ["S"], "b.N P = 3": ["S"]}
    connect = [{"from": "w.y", "via": "b.M.S", "to": ["u.x"]}, {"from": "w.z", "via": "b.M.T", "to": ["u.t"]}]
    made = facts.units_section({"effective_delays": delays, "pages": pages, "connect": connect})
    assert "0 where P = 1; 15 (10 to 20) where P = 3" in made
    assert made.count("where") == 2
    assert "b.M.T</td><td>as the step begins</td><td>0</td>" in without_heads(made)
