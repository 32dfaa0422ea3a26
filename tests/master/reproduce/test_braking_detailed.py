"""The runs of the detailed plant, and its numbers in Table I."""

from __future__ import annotations

import pickle

from evcosim.master.reproduce import braking_detailed as detailed

PRINTED = {"(a)": 33.34, "(c)": 51.32, "(d)": 46.4, "(c) longer": 54.0, "(d) longer": 39.2}


def test_tasks_can_be_sent_to_processes():
    tasks = detailed.tasks()
    assert len({task.name for task in tasks}) == len(tasks) == 7
    assert pickle.loads(pickle.dumps(tasks)) == tasks


def test_table_i_comes_out_and_another_number_would_not(braking_runs):
    rows = detailed.table(braking_runs, PRINTED)
    assert rows.keys() == {*PRINTED, "(b)"}
    assert all(row.holds and row.of == "detailed plant" for row in rows.values())
    wrong = detailed.table(braking_runs, {by: 1.05 * value for by, value in PRINTED.items()})
    assert [by for by, row in wrong.items() if row.holds] == ["(b)"]


def test_relaxation_moves_every_stop_a_little(braking_runs):
    for name in detailed.CONTROLLED:
        distances = [stop.distance for stop in braking_runs[f"relaxation {name}"]]
        assert len(set(distances)) == len(detailed.LENGTHS)
        assert max(distances) - min(distances) < 0.15
