"""Connections: routes and drivers, and every wrong one refused with place, rule and values."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.units.measure import Affine
from support.car import BUS, SENT, car, ecu, plan, unit
from support.mocks import MockUnit, plan_of, real


def test_a_direct_connection_converts_units():
    (route,) = [
        r for r in plan([{"from": "car.speed", "to": ["ecu.speed"]}]).units[0].routes if not r.map.identity
    ]
    assert route.map == Affine(3.6)


def test_ideal_leaves_the_bus_out():
    assert plan([SENT], **BUS, options={"ideal": True}).messages == ()


@pytest.mark.parametrize(
    ("connect", "said"),
    [
        (
            [{"from": "car.spede", "to": ["ecu.speed"]}],
            r"'car' has no variable 'spede' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "caar.speed", "to": ["ecu.speed"]}], r"no unit 'caar' \(did you mean 'car'\?\)"),
        (
            [{"from": "car.speed", "to": ["ecu.sped"]}],
            r"'ecu' has no variable 'sped' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "ecu.speed", "to": ["car.throttle"]}], "causality input, not output or local"),
        ([{"from": "car.speed", "to": ["ecu.throttle"]}], "causality output, not input"),
        (
            [{"from": "car.speed", "to": ["car.throttle"]}],
            r"car.speed \[m/s\] cannot feed car.throttle \[%\]: .*different quantities",
        ),
        ([{"from": "car.speed", "to": ["ecu.flag"]}], "car.speed is of type Real, ecu.flag of type Boolean"),
        ([{"from": "car.speed"}], "needs a receiver in 'to' or a signal in 'via'"),
        (
            [{"from": "car.speed", "to": ["ecu.speed"]}, {"from": "car.speed", "to": ["ecu.speed"]}],
            "ecu.speed is driven already, by car.speed",
        ),
        ([SENT | {"via": "can1.EMD_Status.EMD_VehicleSpeed"}], r"no bus 'can1' \(did you mean 'can0'\?\)"),
        (
            [SENT | {"via": "can0.EMD_Stats.EMD_VehicleSpeed"}],
            r"no message 'EMD_Stats' \(did you mean 'EMD_Status'",
        ),
        ([SENT | {"via": "can0.EMD_Status.EMD_Speed"}], "no signal 'EMD_Speed'"),
        ([SENT | {"from": "car.force"}], r"car.force \[N\] cannot feed .* \[km/h\]"),
        ([SENT, SENT | {"from": "ecu.throttle", "to": []}], "is sent already, by car.speed$"),
        ([SENT, SENT | {"to": []}], "is sent already, by car.speed; name all its receivers in the `to`"),
        (
            [SENT, {"from": "ecu.throttle", "via": "can0.EMD_Status.EMD_Power", "factor": 1.0}],
            r"EMD_Status.EMD_Power is sent by unit 'ecu', and EMD_Status.EMD_VehicleSpeed by 'car': one node",
        ),
    ],
)
def test_a_wrong_connection_is_named(connect, said):
    for ideal in (False, True):
        if ideal and ("sent already" in said or "one node" in said):
            continue  # without the bus there is no message that two send
        with pytest.raises(ConfigError, match=said) as caught:
            plan(connect, **BUS, options={"ideal": ideal})
        assert "mocks.toml: connect" in str(caught.value)


def test_a_unit_left_out_frees_its_receivers():
    connect = [{"from": "ecu.throttle", "to": ["car.throttle"]}, {"from": "car.speed", "to": ["ecu.speed"]}]
    both = plan_of([ecu(), car()], {"connect": connect})
    assert both.inputs["car.throttle"].driver == "ecu.throttle"
    alone = plan_of([ecu(), car()], {"connect": connect}, {"leave_out": ["ecu"]})
    assert [u.name for u in alone.units] == ["car"]
    assert alone.inputs["car.throttle"].driver == ""


def test_a_missing_unit_of_measure_is_said():
    bare = unit("car", real("speed", "output"))
    plan_ = plan_of([ecu(), bare], {"connect": [{"from": "car.speed", "to": ["ecu.speed"]}]})
    assert plan_.warnings == ("car.speed declares no unit of measure; it is taken as [km/h]",)


def test_a_unit_of_differences_meets_no_absolute_one_directly():
    for units in (("delta_degC", "K"), ("degC", "delta_degC")):
        ends = [
            real(*end, unit=unit) for end, unit in zip((("y", "output"), ("u", "input")), units, strict=True)
        ]
        with pytest.raises(ConfigError, match=r"a.y \[.*\] cannot feed b.u .* means nothing to the other"):
            plan_of(
                [MockUnit(n, [v]) for n, v in zip("ab", ends, strict=True)],
                {"connect": [{"from": "a.y", "to": ["b.u"]}]},
            )


def test_a_factor_is_for_numbers():
    number = {"from": "car.gear", "to": ["ecu.flag"], "factor": 2.0, "convert": False}
    with pytest.raises(ConfigError, match=r"factor = 2, convert = false: ecu.flag is of type Boolean"):
        plan([number])
    units = [
        MockUnit("a", [VariableInfo("y", "Boolean", "output", "discrete")]),
        MockUnit("b", [real("u", "input")]),
    ]
    made = plan_of(units, {"connect": [{"from": "a.y", "to": ["b.u"], "factor": 100.0, "convert": False}]})
    assert made.links[0].map == Affine(100.0)
