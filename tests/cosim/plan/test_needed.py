"""An optional connection is needed where the parameters of a run say so."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import pytest

from evcosim import ConfigError, simulate
from evcosim.cosim.plan.needed import check_needed
from evcosim.cosim.system.scenario import Scenario, ScenarioFile
from evcosim.cosim.system.system import System, SystemFile
from support.car import plan

SPEED = {"from": "car.speed", "to": ["ecu.speed"], "optional": True}


def check(
    where: Mapping[str, Any],
    kept: bool = False,
    events: Collection[str] = (),
    others: Collection[str] = (),
    **options: Any,
) -> None:
    """Check a car whose connection to the ECU is `kept` or left out."""
    connect = [SPEED | {"needed_where": where}]
    file = {"name": "c", "units": {"car": {"fmu": "c"}, "ecu": {"fmu": "e"}}, "connect": connect}
    system = System(Path("c.toml"), SystemFile.model_validate(file))
    override = {"time": 0.0, "action": "override", "value": 1.0}
    scenario = ScenarioFile.model_validate({"event": [override | {"variable": name} for name in events]})
    made = plan(connect if kept else [], options=options)
    check_needed(system, made, Scenario("s", Path("s.toml"), scenario), others)


@pytest.mark.parametrize(
    "where", [{"car.mode": "eco"}, {"car.mode": 0}, {"car.mass": 200}, {"car.sport": False}]
)
def test_what_the_ecu_will_see_is_told_where_a_value_needs_the_connection(where: Mapping[str, Any]) -> None:
    name, value = next(iter(where.items()))
    with pytest.raises(ConfigError) as refused:
        check(where)
    said = str(refused.value)
    assert (
        "nothing drives ecu.speed, since car.speed is left out: it would be 0.0 km/h for the whole run"
        in said
    )
    assert f"with {name} = {value} it is needed" in said and f"set another {name}" in said
    check(where, kept=True)
    check(where, events={"ecu.speed"})
    check(where, start={"ecu.speed": 30.0})  # whoever gives it a value knows what it is


def test_another_value_of_the_run_needs_nothing() -> None:
    check({"car.mode": "fast"})
    check({"car.mode": "eco"}, parameters={"car.mode": "fast"})
    with pytest.raises(ConfigError, match=r"car\.mode = fast"):
        check({"car.mode": "fast"}, parameters={"car.mode": "fast"})
    check({})


@pytest.mark.parametrize(
    ("where", "said"),
    [
        ({"caar.mode": "eco"}, r"connect 1\.needed_where: there is no unit 'caar' \(did you mean 'car'\?\)"),
        ({"car.mood": "eco"}, r"needed_where: unit 'car' has no variable 'mood' \(did you mean 'mode'\?\)"),
        ({"car.mode": "slow"}, "needed_where: mode has no item 'slow'"),
        ({"ecu.speed": 1.0}, "causality input, not parameter"),
    ],
)
def test_a_condition_that_is_none(where: Mapping[str, Any], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        check(where)


def test_an_fmu_in_the_place_of_the_unit_may_lack_the_parameter() -> None:
    check({"car.mood": "eco"}, others={"car"})


def test_a_rider_who_is_left_out_gives_no_throttle_over_the_bus() -> None:
    """In fig8 the rider's throttle is wired; the ECU, told to take it from the bus, would see none."""
    with pytest.raises(ConfigError, match=r"nothing drives ecu\.throttle_position, since rider\.throttle"):
        simulate("scooter", parameters={"ecu.throttle_source": "bus"}, stop_time=0.1)
