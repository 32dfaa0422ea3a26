"""Receivers of one message that judge its frames by themselves, where a node is off the bus."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.master.simulation import Simulation

DATABASE = """VERSION ""
BS_:
BU_: ECU ONE TWO
BO_ 256 Request: 8 ECU
 SG_ Throttle : 0|8@1+ (0.4,0) [0|100] "%" ONE,TWO
 SG_ Counter : 8|4@1+ (1,0) [0|14] "" ONE,TWO
 SG_ Crc : 16|8@1+ (1,0) [0|255] "" ONE,TWO
BO_ 512 SpeedOne: 8 ONE
 SG_ SpeedOne : 0|8@1+ (1,0) [0|255] "km/h" ECU
BO_ 513 SpeedTwo: 8 TWO
 SG_ SpeedTwo : 0|8@1+ (1,0) [0|255] "km/h" ECU
"""
PAGED = DATABASE.replace(
    "BO_ 512",
    ' SG_ Page M : 24|4@1+ (1,0) [0|15] "" ONE,TWO\n SG_ Grade m1 : 32|8@1+ (1e-3,0) [0|0.2] "rad" TWO\n'
    "BO_ 512",
).replace("SG_ Throttle :", "SG_ Throttle m0 :")
SYSTEM = """name = "three"
record = ["*"]
[experiment]
step_size = 0.01
stop_time = 1.0
[units.ecu]
fmu = "BoundController"
[units.one]
fmu = "Scooter"
[units.two]
fmu = "Scooter"
[buses.can0]
dbc = "three.dbc"
cycle_time = 0.01
BUS
[buses.can0.messages.Request]
timeout = 3
on_timeout = "initial"
initial = { Throttle = 0.0 }
status = STATUS
OWN
[[connect]]
from = "ecu.throttle"
to = TO
via = "can0.Request.Throttle"
[[connect]]
from = "one.speed"
via = "can0.SpeedOne.SpeedOne"
[[connect]]
from = "two.speed"
via = "can0.SpeedTwo.SpeedTwo"
"""
GRADE = """[[connect]]
from = "ecu.speed_estimate"
to = ["two.road_grade"]
via = "can0.Request.Grade"
factor = 0.002
convert = false
"""
RIDE = """
[[stimulus]]
to = "ecu.throttle_request"
table = [[0.0, 40.0], [1.0, 100.0]]
[[stimulus]]
to = "ecu.speed_bound"
constant = 200.0
unit = "km/h"
[[stimulus]]
to = "ecu.speed_measured"
constant = 0.0
"""
OFF = '[[fault]]\naction = "bus_off"\ntime = 0.3\nduration = 0.2\nnode = "can0.{}"\n'
PROTECTED = "e2e = { profile = '1A', data_id = 7, crc = 'Crc', counter = 'Counter' }"


def ran(
    folder: Path,
    engine: Any,
    receivers: str = "one two",
    faults: str = "",
    bus: str = "",
    own: str = PROTECTED,
    database: str = DATABASE,
) -> tuple[dict[str, np.ndarray], dict[str, Any], list[int]]:
    """Columns of a run by name, what was counted of the request, and the frames that each fault hit."""
    names = receivers.split()
    filled = SYSTEM.replace("BUS", bus).replace("OWN", own)
    filled = filled.replace("STATUS", str([f"{name}.brake_force" for name in names]))
    (folder / "three.toml").write_text(filled.replace("TO", str([f"{name}.throttle" for name in names])))
    (folder / "three.dbc").write_text(database)
    (folder / "ride.toml").write_text(RIDE + faults)
    if database == PAGED:
        (folder / "three.toml").write_text((folder / "three.toml").read_text() + GRADE)
    with Simulation(
        folder / "three.toml", folder / "ride.toml", engine=engine, isolation="none"
    ) as simulation:
        simulation.step(100)
        results, manifest = simulation.results, simulation.manifest()
    messages = manifest["frames"]["can0"]["messages"]
    columns = {v.name: results[v.name] for v in results.variables}
    hits = [fault["frames"] for fault in manifest.get("faults", [])]
    return columns, messages.get("Request", messages), hits


def of(unit: str, columns: dict[str, np.ndarray]) -> dict[str, bytes]:
    return {name: column.tobytes() for name, column in columns.items() if name.startswith(f"{unit}.")}


@pytest.mark.parametrize("own", [PROTECTED, ""])
@pytest.mark.parametrize("bus", ["", 'timing = "frame"', "delay = 0.02"])
def test_a_receiver_does_not_notice_who_else_is_off_the_bus(tmp_path, bus, own):
    more = {"bus": bus, "own": own}
    found = [ran(tmp_path, engine, faults=OFF.format("TWO"), **more) for engine in ("python", "compiled")]
    assert [of("", each) for each, *_ in found[:1]] == [of("", each) for each, *_ in found[1:]]
    assert found[0][1:] == found[1][1:]
    columns, counted, _ = found[1]
    whole, counted_whole, _ = ran(tmp_path, "compiled", **more)
    alone, counted_alone, _ = ran(tmp_path, "compiled", "two", OFF.format("TWO"), **more)
    assert of("one", columns) == of("one", whole)
    assert of("two", columns) == of("two", alone)
    assert of("two", columns) != of("two", whole)
    judged = {"timeouts", "rejected", "statuses"} & counted_whole.keys()
    assert counted["receivers"] == {
        "ONE": {name: counted_whole[name] for name in judged},
        "TWO": {name: counted_alone[name] for name in judged},
    }
    assert counted["unheard"] == counted_alone["unheard"] == 21
    assert "receivers" not in counted_whole | counted_alone


def test_each_of_two_that_are_off_has_no_new_data_then_its_timeout_and_finds_back(tmp_path):
    later = OFF.format("ONE").replace("0.3", "0.4")
    columns, counted, hits = ran(tmp_path, "compiled", faults=OFF.format("TWO") + later)
    status, throttle = columns["two.brake_force"], columns["two.throttle"]
    assert status[[0, 1, 29, 30, 50, 51, 52]].tolist() == [4.0, 0.0, 0.0, 1.0, 1.0, 32.0, 0.0]
    assert throttle[31] == throttle[29] > 0.0 == throttle[32] == throttle[50]
    assert np.array_equal(columns["one.brake_force"][40:63], status[30:53])
    assert counted["statuses"] == {"initial": 1, "ok": 77, "ok_some_lost": 1, "no_new_data": 21}
    assert counted["timeouts"] == 1  # at each of them
    assert hits == [42, 42]  # of its own message, and of the request


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_nodes_that_were_never_off_are_counted_together(tmp_path, engine):
    _, counted, _ = ran(tmp_path, engine, bus='timing = "frame"\nbit_error_rate = 1e-5')
    assert counted["statuses"]["ok"] >= 95
    assert "receivers" not in counted


def test_the_pages_of_a_message_are_judged_together_at_each_receiver(tmp_path):
    """TWO receives both pages, ONE the first alone: their states count the frames of all pages."""
    found = [ran(tmp_path, e, faults=OFF.format("TWO"), database=PAGED) for e in ("python", "compiled")]
    assert of("", found[0][0]) == of("", found[1][0]) and found[0][1:] == found[1][1:]
    columns, counted, _ = found[1]
    alone, counted_alone, _ = ran(tmp_path, "compiled", "two", OFF.format("TWO"), database=PAGED)
    whole, counted_whole, _ = ran(tmp_path, "compiled", database=PAGED)
    assert of("one", columns) == of("one", whole)
    assert of("two", columns) == of("two", alone)
    for page in ("Request Page = 0", "Request Page = 1"):
        for name, one in (("ONE", counted_whole[page]), ("TWO", counted_alone[page])):
            judged = counted[page]["receivers"][name]
            assert judged == {key: one[key] for key in judged}


def test_nodes_that_their_own_errors_take_off_judge_by_themselves_too(tmp_path):
    noise = 'timing = "frame"\nbit_error_rate = 0.02\nseed = 5'
    found = [ran(tmp_path, engine, bus=noise) for engine in ("python", "compiled")]
    assert of("", found[0][0]) == of("", found[1][0]) and found[0][1:] == found[1][1:]
    _, counted, _ = found[1]
    one, two = (counted["receivers"][name]["statuses"] for name in ("ONE", "TWO"))
    assert one != two and counted["unheard"] > 0
    judged = [sum(each.values()) - each["no_new_data"] for each in (one, two)]
    heard = counted["arrived"] - counted["unheard"]
    assert all(heard <= number <= counted["arrived"] for number in judged)
