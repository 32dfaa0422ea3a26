"""The summary of a run: final values without metrics, and saturated signals."""

from __future__ import annotations

import json
import re
import shlex

import pytest

from evcosim.master.cli import summary
from support.needs import need_c_compiler


def test_final_values_where_there_are_no_metrics(evcosim, system):
    answer = evcosim("run", system({"cart": "Fragile"}, stop_time=1.0), "--no-plot")
    assert answer.code == 0
    assert "values at t = 1 s\ncart.way  100 m" in answer.out


def test_final_value_of_a_bare_number(evcosim, tmp_path):
    path = tmp_path / "pack.toml"
    path.write_text('name = "pack"\n[units.pack]\nfmu = "Battery"\n[experiment]\nstop_time = 0.1\n')
    answer = evcosim("run", path, "--no-plot")
    assert "pack.state_of_charge  1\n" in answer.out


def narrow_bus(tmp_path):
    """A bus over which 20 m are the most that can be sent, as text of a system file."""
    dbc = tmp_path / "narrow.dbc"
    dbc.write_text(
        'VERSION ""\nNS_ :\nBS_:\nBU_: A B\nBO_ 16 Way: 2 A\n'
        ' SG_ Meters : 0|16@1+ (0.1,0) [0|20] "m" B\n'
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\nBA_DEF_DEF_ "GenMsgCycleTime" 10;\n'
        'BA_ "GenMsgCycleTime" BO_ 16 10;\n'
    )
    bus = f"[buses.can0]\ndbc = '{dbc.name}'\n"
    return bus + '[[connect]]\nfrom = "cart.way"\nto = ["other.u"]\nvia = "can0.Way.Meters"\n'


def test_run_reports_saturation(evcosim, system, tmp_path):
    path = system({"cart": "Fragile", "other": "Through"}, narrow_bus(tmp_path), stop_time=1.0)
    answer = evcosim("run", path, "--no-plot")
    assert "can0.Way.Meters 79 times, first at 0.21 s" in answer.out
    about = evcosim("run", path, "--no-plot", "--json").json["saturations"]["can0.Way.Meters"]
    assert about == {"count": 79, "first_time": pytest.approx(0.21)}


def test_a_run_says_what_its_faults_hit(evcosim, tmp_path):
    fault = '[[fault]]\naction = "lose"\nmessage = "can0.EMD_Status"\ntime = '
    (tmp_path / "lost.toml").write_text(f"{fault}0.5\nduration = 0.2\n{fault}99.0\n")
    answer = evcosim("run", "scooter", "--scenario", tmp_path / "lost.toml", "--stop-time", "1", "--no-plot")
    assert "lose can0.EMD_Status at 0.5 s for 0.2 s: 20 frames\n" in answer.out
    assert "lose can0.EMD_Status at 99 s: no frame\n" in answer.out
    data = evcosim(
        "run", "scooter", "--scenario", tmp_path / "lost.toml", "--stop-time", "1", "--no-plot", "--json"
    )
    assert [fault["frames"] for fault in data.json["faults"]] == [20, 0]


def test_a_run_says_where_its_native_units_came_from(evcosim, tmp_path):
    need_c_compiler()
    path = tmp_path / "pack.toml"
    path.write_text('name = "pack"\n[units.pack]\nfmu = "Battery"\n[experiment]\nstop_time = 0.1\n')
    shown = evcosim("run", path, "--units", "native", "--no-plot", "--no-report").out
    said = re.search(r"^native +pack \((compiled by \w+|shipped with evcosim)\)$", shown, re.MULTILINE)
    assert said
    (folder,) = (tmp_path / "results").iterdir()
    assert json.loads((folder / "run.json").read_text())["units"]["pack"]["library"] == said[1]
    assert "\nnative" not in evcosim("run", path, "--no-plot", "--no-report").out


def test_native_units_are_listed_by_where_they_came_from():
    origins = {"a": "shipped with evcosim", "b": "", "c": "compiled by gcc", "d": "shipped with evcosim"}
    units = {name: {"library": origin} if origin else {} for name, origin in origins.items()}
    assert summary._native(units) == ["a, d (shipped with evcosim)", "c (compiled by gcc)"]
    assert summary._native({"b": {}}) == []


def test_a_run_says_what_is_isolated_where_results_are_and_what_to_type_next(evcosim, tmp_path):
    shown = evcosim("run", "scooter", "--stop-time", "1", "--no-plot").out
    assert "isolated  none\n" in shown
    assert "\nin results/scooter-fig8: results.csv, run.json" in shown
    commands = [line.strip() for line in shown.partition("\nnext")[2].splitlines()]
    assert commands == [
        "evcosim plot results/scooter-fig8 --signals 'vehicle.*'",
        "evcosim run scooter --scenario ece15",
        "evcosim info scooter",
    ]
    for command in commands:
        words = shlex.split(command)[1:]
        assert evcosim(*words, *(["--stop-time", "1", "--no-plot"] if words[0] == "run" else [])).code == 0
    isolated = evcosim("run", "scooter", "--stop-time", "1", "--no-plot", "--isolation", "process").out
    assert "isolated  planner, ecu, vehicle, battery (each in a process of its own)\n" in isolated
