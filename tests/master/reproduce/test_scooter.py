"""The page of the scooter: its runs, and its rows from numbers made up to be right and wrong."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.master.reproduce import printed, scooter
from evcosim.master.reproduce.papers import load

CYCLE = {"mean speed": 20.0, "share of the distance not followed": 1.0}


def test_tasks_can_be_sent_to_processes_and_have_names_of_their_own():
    runs = load("scooter").runs()
    assert len({run.name for run in runs}) == len(runs)
    assert pickle.loads(pickle.dumps(runs)) == runs


def test_the_force_map_gives_gain_and_pole_over_the_speed():
    assert all(found.holds for found in scooter._vehicle().values())
    assert printed.row("scooter", "gain").verdict == printed.row("scooter", "pole").verdict == "calibrated"


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


@pytest.mark.parametrize("switches", [9, 8])
def test_switches_in_fig_9(switches):
    assert scooter._nine_switches(fig9(switches, 0.5), "over the bus").holds == (switches == 9)


@pytest.mark.parametrize("over", [0.5, 0.6])
def test_the_bound_in_fig_9(over):
    assert scooter._late_excess(fig9(9, over)) == pytest.approx(over)


@pytest.mark.parametrize("saved", [1.0, -1.0])
def test_bounds_save_energy_in_a_cycle(saved):
    found = {"stop and go True": (43.0, 24.1), "stop and go False": (73.7, 39.7)}
    for cycle in ("ece15", "udds"):
        found[f"{cycle} True"] = CYCLE | {"energy per distance": 30.0 - saved}
        found[f"{cycle} False"] = CYCLE | {"energy per distance": 30.0}
    rows = list(scooter._energy(found).values())
    assert [row.holds for row in rows] == [True] * 4 + [saved > 0.0] * 2
