"""The task phase of a unit: both engines, every version of FMI, in this process and another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.cosim.system.system import load_system
from evcosim.master.simulation import Simulation, simulate
from support.needs import need_c_compiler
from support.watch import watch_fmu

WATCHED = """
name = "watched"
[experiment]
start_time = 0.7
stop_time = {stop}
step_size = 0.001
[units.a]
fmu = "{fmu}"
isolation = "{isolation}"
period = 0.004
substeps = 2
offset = 0.003
"""


def watched(folder: Path, fmi: int = 2, stop: float = 0.721, isolation: str = "none") -> Path:
    need_c_compiler()
    path = folder / "watched.toml"
    fmu = watch_fmu(folder / f"watch{fmi}.fmu", fmi)
    path.write_text(WATCHED.format(fmu=fmu, stop=stop, isolation=isolation))
    return path


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_a_unit_starts_at_its_offset_and_steps_each_period_to_the_stop_time(
    tmp_path: Path, fmi: int, engine: str
) -> None:
    """It refuses steps that leave a gap: its own start time is that of its first step."""
    results = simulate(watched(tmp_path, fmi), engine=engine, trust=True)
    begin = [round(1000 * value) for value in results["a.before"].tolist()]
    assert round(1000 * results["a.begin"][0]) == 703
    # turns at 703, 707, 711, 715 ms; that at 719 ms ends at the stop time, 721 ms, in steps of 1 ms
    assert begin[7:] == [703] * 4 + [707] * 4 + [711] * 4 + [715] * 2 + [719]
    assert set(begin[1:7]) <= {0, begin[0]}
    assert results["a.size"][-1] == pytest.approx(0.001)
    assert results["a.size"][7] == pytest.approx(0.002)


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_stepped_simulation_and_a_process_of_its_own_see_the_same_times(
    tmp_path: Path, engine: str, isolation: str
) -> None:
    whole = simulate(watched(tmp_path), engine="python", trust=True)
    with Simulation(watched(tmp_path, isolation=isolation), engine=engine, trust=True) as simulation:
        for steps in (1, 1, 2, 5, 7):
            simulation.step(steps)
        found = simulation.results
    columns = [j for j, v in enumerate(found.variables) if v.name != "a.stop"]
    assert np.array_equal(found.data[:, columns], whole.data[:17, columns])


SCOOTER = {"step_size": 0.01, "stop_time": 2.0, "record": ["*"]}
DRIVEN = """
leave_out = ["rider", "planner", "battery"]
[[stimulus]]
to = "ecu.throttle_request"
constant = 70.0
[[stimulus]]
to = "vehicle.road_grade"
constant = 0.01
"""


def scooter(folder: Path, offset: float, start_delay: float = 0.0, **bus: Any) -> Path:
    """The scooter's system of turns each 40 ms, all later by an offset, and its messages by a start delay."""
    text = load_system("scooter").path.read_text()
    for unit in ("ecu", "vehicle"):
        text = text.replace(f"[units.{unit}]\n", f"[units.{unit}]\nperiod = 0.04\noffset = {offset}\n")
    lines = "".join(f"{key} = {value}\n" for key, value in bus.items())
    text = text.replace("[buses.can0]\n", f"[buses.can0]\n{lines}")
    names = {line.split(".")[1] for line in text.splitlines() if line.startswith("via")}
    for name in sorted(names):
        table, times = f"[buses.can0.messages.{name}]\n", f"cycle_time = 0.04\nstart_delay = {start_delay}\n"
        text = text.replace(table, table + times) if table in text else f"{text}\n{table}{times}"
    (folder / f"late{offset}.toml").write_text(text)
    (folder / "driven.toml").write_text(DRIVEN)
    return folder / f"late{offset}.toml"


def ran(path: Path, **options: Any) -> Results:
    return simulate(path, path.parent / "driven.toml", **SCOOTER | options)


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("timing", ["instant", "frame"])
def test_a_system_that_starts_later_does_the_same_later(tmp_path: Path, timing: str, algorithm: str) -> None:
    at_once = ran(scooter(tmp_path, 0.0, timing=f'"{timing}"'), algorithm=algorithm)
    late = ran(scooter(tmp_path, 0.03, 0.03, timing=f'"{timing}"'), algorithm=algorithm, stop_time=2.03)
    assert np.array_equal(late.data[3:], at_once.data)
    assert np.ptp(at_once["vehicle.speed"]) > 0.1
    # until then the initial outputs stand
    for name in ("vehicle.speed", "vehicle.power", "vehicle.distance"):
        assert set(late[name][:3]) == {at_once[name][0]}


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("timing", ["instant", "frame"])
def test_engines_and_processes_agree(tmp_path: Path, timing: str, isolation: str) -> None:
    path = scooter(tmp_path, 0.02, timing=f'"{timing}"')
    a = ran(path, engine="python")
    b = ran(path, engine="compiled", isolation=isolation)
    assert np.array_equal(a.data, b.data)


def test_an_event_acts_at_the_next_turn(tmp_path: Path) -> None:
    path = scooter(tmp_path, 0.02)
    events = '[[event]]\naction = "override"\ntime = {}\nvariable = "vehicle.throttle"\nvalue = 90.0\n'
    found = []
    for time in (0.03, 0.06, 0.07):
        (tmp_path / "event.toml").write_text(DRIVEN + events.format(time))
        found.append(simulate(path, tmp_path / "event.toml", **SCOOTER)["vehicle.speed"])
    assert np.array_equal(found[0], found[1])  # turns at 20, 60 and 100 ms
    assert not np.array_equal(found[1], found[2])


def test_a_sampled_output_goes_out_with_the_messages_own_cycle(tmp_path: Path) -> None:
    """The turns of the ECU are at 20, 60 ... ms; its message, each 40 ms from 0, has what it set before."""
    path = scooter(tmp_path, 0.02)
    rising = DRIVEN.replace("constant = 70.0", "ramp = { slope = 50.0, end = 100.0 }")
    (tmp_path / "rising.toml").write_text(rising)
    results = simulate(path, tmp_path / "rising.toml", **SCOOTER | {"stop_time": 0.7})
    sent, seen = results["ecu.throttle"], results["vehicle.throttle"]
    changes = np.flatnonzero(np.diff(seen)) + 1
    assert set(changes % 4) == {2}  # the vehicle's turns
    assert np.ptp(sent) > 20.0
    assert np.allclose(seen[changes], sent[changes - 1], atol=0.21)
    assert np.all(sent[changes] > seen[changes] + 1.0)


@pytest.mark.parametrize(
    ("keys", "rule"),
    [
        ("period = 0.04\noffset = 0.04", "period of the unit, 0.04 s; the greatest offset is 0.03 s"),
        ("offset = 0.01", "the greatest offset is 0.0 s, or the unit needs a longer `period`"),
        ("period = 0.04\noffset = 0.015", "step 0.01 s; the nearest are 0.01 s and 0.02 s"),
        ("period = 0.04\noffset = 0.038", "communication step 0.01 s; the nearest multiple is 0.03 s"),
        ("period = 4.0\noffset = 3.0", "starts at 3.0 s, not before the stop time 2.0 s; stop later"),
        ("offset = -0.01", "greater than or equal to 0, not -0.01"),
        ("offset = nan", "not nan"),
        ("offset = true", "not true"),
        ("offset = 1e300", "not 1e+300"),
    ],
)  # fmt: skip # a rule on one line
def test_an_offset_that_does_not_fit_is_refused(tmp_path: Path, keys: str, rule: str) -> None:
    text = load_system("scooter").path.read_text()
    (tmp_path / "s.toml").write_text(text.replace("[units.vehicle]\n", f"[units.vehicle]\n{keys}\n"))
    with pytest.raises(ConfigError, match=r"units\.vehicle\.offset") as refused:
        simulate(tmp_path / "s.toml", step_size=0.01, stop_time=2.0)
    assert rule in str(refused.value)


def test_rounding_is_forgiven(tmp_path: Path) -> None:
    assert np.array_equal(ran(scooter(tmp_path, 0.1 * 3 / 10)).data, ran(scooter(tmp_path, 0.03)).data)


def test_it_is_told_with_the_period(tmp_path: Path, evcosim: Any) -> None:
    path = scooter(tmp_path, 0.02)
    about = evcosim("info", path, "--json").json["units"]
    assert [unit["name"] for unit in about if unit["offset"] == 0.02] == ["ecu", "vehicle"]
    assert [unit["name"] for unit in about if unit["offset"] == 0.0] == ["rider", "planner", "battery"]
    assert "0.04 from 0.02 on" in evcosim("info", path).out
    manifest = ran(path).manifest
    assert manifest["units"]["ecu"]["offset"] == 0.02
