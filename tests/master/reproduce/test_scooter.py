"""The page of the scooter: its runs, and its rows from numbers made up to be right and wrong."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import scooter
from evcosim.master.reproduce.papers import load

CYCLE = {"mean speed": 20.0, "share of the distance not followed": 1.0}


def test_tasks_can_be_sent_to_processes_and_have_names_of_their_own():
    runs = load("scooter").runs()
    assert len({run.name for run in runs}) == len(runs)
    assert pickle.loads(pickle.dumps(runs)) == runs


def test_gain_and_pole_are_calibrated_by_the_force_map():
    rows = scooter._vehicle_rows()
    assert [row.verdict for row in rows] == ["calibrated"] * 4
    assert {row.reason for row in rows} == {scooter._MAP}


def fig9(switches, over):
    """A run of 200 s that changes its state so often and is so far over its bound in velocity [km/h]."""
    time = np.arange(0.0, 200.0, 0.01)
    state = np.where((time // (200.0 / (switches + 1))) % 2 == 1, 2.0, 0.0)
    columns = {
        "ecu.state": state,
        "vehicle.speed": (30.0 + over) / 3.6 + 0 * time,
        "ecu.speed_bound": 30.0 + 0 * time,
    }
    return Results(time, np.column_stack(list(columns.values())), [ResultVariable(name) for name in columns])


@pytest.mark.parametrize(
    ("switches", "over", "verdicts"),
    [
        (9, 0.5, ["reached", "calibrated"]),
        (8, 0.5, ["missed", "calibrated"]),
        (9, 0.6, ["reached", "missed"]),
    ],
)
def test_switches_and_the_bound_in_fig_9(switches, over, verdicts):
    found = {f"fig9 {name}": fig9(switches, over) for name in ("bus", "ideal", "jacobi")}
    rows = scooter._fig9_rows(found)
    assert [row.verdict for row in rows] == verdicts * 3


@pytest.mark.parametrize(("saved", "verdict"), [(1.0, "reproduced"), (-1.0, "missed")])
def test_bounds_save_energy_in_a_cycle(saved, verdict):
    found = {"stop and go True": (43.0, 24.1), "stop and go False": (73.7, 39.7)}
    for cycle in ("ece15", "udds"):
        found[f"{cycle} True"] = CYCLE | {"energy per distance": 30.0 - saved}
        found[f"{cycle} False"] = CYCLE | {"energy per distance": 30.0}
    rows = scooter._energy_rows(found)
    assert [row.verdict for row in rows[:4]] == ["reached"] * 4
    assert all(row.verdict in (verdict, "reached") for row in rows[4:])
    assert len({row.verdict for row in rows[4:]}) == 1
