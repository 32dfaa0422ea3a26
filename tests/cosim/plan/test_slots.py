"""Slots: every value has one of its own, and a row of the results is one piece of memory."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.slots import Slots, allot
from support.car import car, ecu, plan
from support.mocks import real

INTERFACES = {"ecu": ecu().interface, "car": car().interface}


def test_what_is_recorded():
    names = [c.name for c in plan([], record=["car.*"]).columns]
    assert names == ["car.throttle", "car.grade", "car.speed", "car.force", "car.gear"]
    assert [c.name for c in plan([], record=["*.speed"]).columns] == ["ecu.speed", "car.speed"]


def test_a_pattern_with_an_exclamation_mark_leaves_out_wherever_it_stands():
    for record in (["car.*", "!*.grade"], ["!car.grade", "car.*"], ["car.*", "!*.grade", "!car.nothing"]):
        names = [c.name for c in plan([], record=record).columns]
        assert names == ["car.throttle", "car.speed", "car.force", "car.gear"]
    assert not plan([], record=["car.*", "!*"]).columns


BRACKETS = UnitInterface(
    "u.fmu",
    {
        name: VariableInfo(name, causality=causality)
        for name, causality in [("x[1]", "output"), ("x[2]", "output"), ("l[1]", "local"), ("x1", "output")]
    },
)


@pytest.mark.parametrize(
    ("record", "names"),
    [
        (["u.x[1]", "u.l[1]"], ["x[1]", "l[1]"]),
        (["u.x[12]"], ["x1"]),
        (["u.x[*]"], ["x[1]", "x[2]"]),
        (["*", "!u.x[1]"], ["x[2]", "x1"]),
        (["*", "!u.x[*]"], ["x1"]),
    ],
)
def test_a_name_with_brackets_is_that_name_first(record: list[str], names: list[str]) -> None:
    _, columns = allot({"u": BRACKETS}, record, set(), "here")
    assert [v.name for _, v in columns] == names


def test_each_group_counts_its_own_variables_that_feed_through() -> None:
    kinds = ("Boolean", "Real", "Integer", "Real", "String", "Enumeration")
    outputs = [
        VariableInfo(f"y{i}", kind, causality="output", depends=("u",) if i % 2 else ())
        for i, kind in enumerate(kinds)
    ]
    variables = {v.name: v for v in [VariableInfo("u", causality="input"), *outputs]}
    slots, _ = allot({"a": UnitInterface("a.fmu", variables)}, ["*"], set(), "here")
    assert [(g.type, [v.name for v in g.variables], g.feedthrough) for g in slots.groups["a"]] == [
        ("Real", ["u"], 0),
        ("Real", ["y1", "y3"], 2),
        ("Integer", ["y5", "y2"], 1),
        ("Boolean", ["y0"], 0),
        ("String", ["y4"], 0),
    ]


def test_no_two_values_share_a_slot():
    slots, _ = allot(INTERFACES, ["*"], set(), "here")
    taken = [*slots.valid.values(), *slots.latest.values()]
    assert sorted(taken) == list(range(slots.size))


def test_recorded_values_stand_before_those_after_a_step():
    slots, columns = allot(INTERFACES, ["*"], set(), "here")
    recorded = [slots.valid[unit, v.name] for unit, v in columns]
    assert sorted(recorded) == list(range(len(recorded)))
    assert min(slots.latest.values()) >= len(recorded)


def test_a_continuous_output_has_two_slots_and_the_others_one():
    slots, _ = allot(INTERFACES, ["*"], set(), "here")
    assert set(slots.latest) == {("car", "speed"), ("car", "force")}
    assert set(slots.valid) > set(slots.latest)


def test_a_group_is_one_kind_and_type_in_consecutive_slots():
    slots, _ = allot(INTERFACES, ["*"], set(), "here")
    for unit, groups in slots.groups.items():
        for group in groups:
            first = range(group.slot, group.slot + len(group.variables))
            assert [slots.valid[unit, name] for name in group.names] == list(first)
            if group.kind == "continuous":
                latest = range(group.latest, group.latest + len(group.variables))
                assert [slots.latest[unit, name] for name in group.names] == list(latest)


def test_what_feeds_through_comes_first():
    unit = UnitInterface(
        "u.fmu",
        {
            v.name: v
            for v in (
                real("x", "input"),
                real("slow", "output"),
                real("fast", "output", depends=("x",)),
                real("other", "output", depends=("mass",)),
            )
        },
    )
    slots, _ = allot({"u": unit}, ["*"], set(), "here")
    (group,) = [g for g in slots.groups["u"] if g.kind == "continuous"]
    assert group.names == ("fast", "slow", "other")
    assert group.feedthrough == 1


def test_a_receiver_reads_ahead_only_within_a_step():
    slots, _ = allot(INTERFACES, ["*"], set(), "here")
    assert slots.source("car", "speed", 1) == slots.latest["car", "speed"]
    assert slots.source("car", "speed", 2) == slots.valid["car", "speed"]
    assert slots.source("car", "gear", 1) == slots.source("car", "gear", 2) == slots.valid["car", "gear"]


def test_only_what_is_recorded_or_connected_has_a_slot():
    slots, columns = allot(INTERFACES, ["car.force"], {"car.gear"}, "here")
    outputs = {name for name in slots.valid if INTERFACES[name[0]].variables[name[1]].causality == "output"}
    assert outputs == {("car", "force"), ("car", "gear")}
    assert [(unit, v.name) for unit, v in columns] == [("car", "force")]


def test_a_local_variable_is_recorded_where_it_is_named_in_full():
    unit = UnitInterface("u.fmu", {"inner": VariableInfo("inner"), "y": real("y", "output")})
    for patterns, names in ((["*"], ["y"]), (["u.*"], ["y"]), (["u.inner"], ["inner"])):
        _, columns = allot({"u": unit}, patterns, set(), "here")
        assert [v.name for _, v in columns] == names


@pytest.mark.parametrize(
    ("pattern", "said"),
    [
        ("car.mass", "is of causality parameter, not input, output or local"),
        ("car.spee", "fits no variable (did you mean 'car.speed'?)"),
        ("car.wide", "has two dimensions"),
    ],
)
def test_what_cannot_be_recorded_is_said(pattern, said):
    unit = UnitInterface("car.fmu", INTERFACES["car"].variables, unusable={"wide": "has two dimensions"})
    with pytest.raises(ConfigError) as caught:
        allot({"car": unit}, [pattern], set(), "here")
    assert str(caught.value) == f"here: record: '{pattern}' {said}"


def test_slots_are_taken_in_order():
    slots = Slots()
    assert [slots.take(3), slots.take(1), slots.take(0), slots.take(2)] == [0, 3, 4, 4]
    assert slots.size == 6
