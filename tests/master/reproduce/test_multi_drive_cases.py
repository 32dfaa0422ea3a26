"""The two cases alone, slips, battery and inverter of the two-motor car."""

from __future__ import annotations

import pickle

import numpy as np

from evcosim.cosim.results.results import Results
from evcosim.master.reproduce import multi_drive_cases as cases


def test_tasks_can_be_sent_to_processes():
    tasks = cases.tasks()
    assert [task.name for task in tasks] == [
        "pid, slope", "mimo, slope", "pid, right_curve", "mimo, right_curve", "battery",
    ]  # fmt: skip # a line
    assert pickle.loads(pickle.dumps(tasks)) == tasks


def changed(results, name, value):
    """The results with a variable of one value."""
    columns = [np.full(len(results), value) if n == name else results.column(n) for n in results.names]
    return Results(results.time, np.column_stack(columns), results.variables)


def test_findings_hold_and_would_not(multi_drive_runs):
    found = cases.findings(multi_drive_runs)
    assert all(value.holds for value in found["slip range"])
    assert found["slope alone"].holds
    assert found["battery"].holds
    other = {
        "pid": changed(multi_drive_runs["pid"], "vehicle.right_slip", -0.3),
        "mimo, slope": changed(multi_drive_runs["mimo, slope"], "vehicle.left_wheel_speed", 46.0),
        "battery": changed(multi_drive_runs["battery"], "inverter.loss_energy", 9.0),
    }
    wrong = cases.findings(multi_drive_runs | other)
    assert [value.holds for value in wrong["slip range"]] == [False, True]
    assert not wrong["slope alone"].holds
    assert not wrong["battery"].holds


def test_panels_side_by_side_have_one_range(multi_drive_runs):
    for picture in cases.pictures(multi_drive_runs)[1:]:
        axes = picture.figure.axes
        assert len(axes) % 2 == 0
        for left, right in zip(axes[::2], axes[1::2], strict=True):
            assert left.get_ylim() == right.get_ylim()
