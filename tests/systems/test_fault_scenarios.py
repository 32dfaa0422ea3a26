"""The scenarios with a fault on the bus: it is counted, seen and in the results, as the pages say."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim import simulate
from evcosim.cosim.results.results import Results
from evcosim.cosim.system.toml import DATA

DOCS = Path(__file__).parents[2] / "docs" / "systems"


@dataclasses.dataclass(frozen=True)
class Case:
    """A scenario with what its fault hit, the signal that it holds between two times [s], and a metric."""

    system: str
    scenario: str
    action: str
    frames: int
    held: str
    between: tuple[float, float]
    metric: str
    value: float
    without: str


CASES = [
    Case("scooter", "speed_lost", "lose", 50, "ecu.speed_measured", (9.2, 9.69),
         "highest speed over the bound", 1.677, "fig8"),
    Case("lane_keeping", "camera_frozen", "freeze", 50, "controller.displacement", (1.9, 2.39),
         "largest displacement beyond the reference", 0.2966, "step"),
    Case("braking", "wheel_speeds_silent", "silence", 50, "controller.front_wheel_speed", (0.05, 0.54),
         "distance travelled", 37.87, "known_speed"),
    Case("multi_drive", "motor_off", "bus_off", 102, "left_drive.torque_request", (2.9, 3.39),
         "dip of the speed", 1.124, "slope"),
]  # fmt: skip # a table


def metric(results: Results, name: str) -> float:
    return next(m.value for m in results.metrics() if m.name == name)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.scenario)
def test_a_fault_is_counted_seen_by_its_receiver_and_in_the_metric(case):
    results = simulate(case.system, case.scenario)
    (fault,) = results.manifest["faults"]
    assert (fault["action"], fault["frames"]) == (case.action, case.frames)
    first, last = (int(np.argmin(abs(results.time - t))) for t in case.between)
    held = results[case.held]
    assert (held[first : last + 1] == held[first]).all()
    assert held[last + 1] != held[last] or held[last + 2] != held[last]
    assert metric(results, case.metric) == pytest.approx(case.value, rel=1e-3)
    before: Any = simulate(case.system, case.without)
    assert not np.array_equal(before[case.held][first : last + 1], held[first : last + 1])
    if case.metric in {m.name for m in before.metrics()}:
        assert metric(before, case.metric) < metric(results, case.metric)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.scenario)
def test_the_page_of_the_system_has_command_and_figure(case):
    page = (DOCS / f"{case.system}.md").read_text(encoding="utf-8")
    assert f"evcosim run {case.system} -s {case.scenario}" in page
    picture = f"../img/{case.system}-{case.scenario}.png"
    assert picture in page
    assert (DOCS / picture).is_file()


def test_a_camera_with_a_frozen_counter_is_seen(tmp_path):
    """Each frozen frame is a repeated one, none is taken, and the controller predicts its place."""
    text = (DATA / "scenarios" / "lane_keeping" / "camera_frozen.toml").read_text(encoding="utf-8")
    (tmp_path / "frozen.toml").write_text(text.replace('counter = "runs"', 'counter = "frozen"'))
    results = simulate("lane_keeping", tmp_path / "frozen.toml")
    statuses = results.manifest["frames"]["can0"]["messages"]["CAM_LaneStatus"]["statuses"]
    assert statuses["repeated"] == 50
    assert metric(results, "largest displacement beyond the reference") == pytest.approx(0.0113, rel=1e-2)
