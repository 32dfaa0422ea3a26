"""Slots: every value has one of its own, and a row of the results is one piece of memory."""

from __future__ import annotations

from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.recorded import Record
from evcosim.cosim.plan.slots import Slots, allot
from support.car import car, ecu
from support.mocks import real

INTERFACES = {"ecu": ecu().interface, "car": car().interface}


def test_each_group_counts_its_own_variables_that_feed_through() -> None:
    kinds = ("Boolean", "Real", "Integer", "Real", "String", "Enumeration")
    outputs = [
        VariableInfo(f"y{i}", kind, causality="output", depends=("u",) if i % 2 else ())
        for i, kind in enumerate(kinds)
    ]
    variables = {v.name: v for v in [VariableInfo("u", causality="input"), *outputs]}
    slots, _ = allot({"a": UnitInterface("a.fmu", variables)}, Record("here", ["*"]), set())
    assert [(g.type, [v.name for v in g.variables], g.feedthrough) for g in slots.groups["a"]] == [
        ("Real", ["u"], 0),
        ("Real", ["y1", "y3"], 2),
        ("Integer", ["y5", "y2"], 1),
        ("Boolean", ["y0"], 0),
        ("String", ["y4"], 0),
    ]


def test_no_two_values_share_a_slot():
    slots, _ = allot(INTERFACES, Record("here", ["*"]), set())
    taken = [*slots.valid.values(), *slots.latest.values()]
    assert sorted(taken) == list(range(slots.size))


def test_recorded_values_stand_before_those_after_a_step():
    slots, columns = allot(INTERFACES, Record("here", ["*"]), set())
    recorded = [slots.valid[unit, v.name] for unit, v in columns]
    assert sorted(recorded) == list(range(len(recorded)))
    assert min(slots.latest.values()) >= len(recorded)


def test_a_continuous_output_has_two_slots_and_the_others_one():
    slots, _ = allot(INTERFACES, Record("here", ["*"]), set())
    assert set(slots.latest) == {("car", "speed"), ("car", "force")}
    assert set(slots.valid) > set(slots.latest)


def test_a_group_is_one_kind_and_type_in_consecutive_slots():
    slots, _ = allot(INTERFACES, Record("here", ["*"]), set())
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
    slots, _ = allot({"u": unit}, Record("here", ["*"]), set())
    (group,) = [g for g in slots.groups["u"] if g.kind == "continuous"]
    assert group.names == ("fast", "slow", "other")
    assert group.feedthrough == 1


def test_a_receiver_reads_ahead_only_within_a_step():
    slots, _ = allot(INTERFACES, Record("here", ["*"]), set())
    assert slots.source("car", "speed", 1) == slots.latest["car", "speed"]
    assert slots.source("car", "speed", 2) == slots.valid["car", "speed"]
    assert slots.source("car", "gear", 1) == slots.source("car", "gear", 2) == slots.valid["car", "gear"]


def test_only_what_is_recorded_or_connected_has_a_slot():
    slots, columns = allot(INTERFACES, Record("here", ["car.force"]), {"car.gear"})
    outputs = {name for name in slots.valid if INTERFACES[name[0]].variables[name[1]].causality == "output"}
    assert outputs == {("car", "force"), ("car", "gear")}
    assert [(unit, v.name) for unit, v in columns] == [("car", "force")]


def test_slots_are_taken_in_order():
    slots = Slots()
    assert [slots.take(3), slots.take(1), slots.take(0), slots.take(2)] == [0, 3, 4, 4]
    assert slots.size == 6
