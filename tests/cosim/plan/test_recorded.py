"""What is recorded: patterns that fit, and patterns that leave out; one that does nothing is refused."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.recorded import Record, recorded_names
from evcosim.cosim.plan.slots import allot
from support.car import car, ecu, plan
from support.mocks import real

INTERFACES = {"ecu": ecu().interface, "car": car().interface}


def test_what_is_recorded():
    names = [c.name for c in plan([], record=["car.*"]).columns]
    assert names == ["car.throttle", "car.grade", "car.speed", "car.force", "car.gear"]
    assert [c.name for c in plan([], record=["*.speed"]).columns] == ["ecu.speed", "car.speed"]


def test_a_pattern_with_an_exclamation_mark_leaves_out_wherever_it_stands():
    for record in (["car.*", "!*.grade"], ["!car.grade", "car.*"], ["car.*", "!*.grade", "!ecu.speed"]):
        names = [c.name for c in plan([], record=record).columns]
        assert names == ["car.throttle", "car.speed", "car.force", "car.gear"]


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
    _, columns = allot({"u": BRACKETS}, Record("here", record), set())
    assert [v.name for _, v in columns] == names


def test_a_local_variable_is_recorded_where_it_is_named_in_full():
    unit = UnitInterface("u.fmu", {"inner": VariableInfo("inner"), "y": real("y", "output")})
    for patterns, names in ((["*"], ["y"]), (["u.*"], ["y"]), (["u.inner"], ["inner"])):
        _, columns = allot({"u": unit}, Record("here", patterns), set())
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
        allot({"car": unit}, Record("here", [pattern]), set())
    assert str(caught.value) == f"here: record: '{pattern}' {said}"


@pytest.mark.parametrize(
    ("patterns", "said"),
    [
        (["*", "!nothing"], "'!nothing' fits no variable"),
        (["*", "!car.spee"], "'!car.spee' fits no variable (did you mean 'car.speed'?)"),
        (["*", "!cra.*"], "'!cra.*' fits no variable (did you mean 'car.*'?)"),
        (["crr.*"], "'crr.*' fits no variable (did you mean 'car.*'?)"),
        (["*", "!car.mass"], "'!car.mass' is of causality parameter, not input, output or local"),
        (["*", "!"], "'!' fits no variable"),
        (["*", "!!car.speed"], "'!!car.speed' fits no variable (did you mean 'car.speed'?)"),
        (["*", "!*"], "'!*' leaves nothing to record"),
        (["car.*", "!*.grade", "!car.*"], "'!car.*' leaves nothing to record"),
        (["car.speed", "!car.speed"], "'!car.speed' leaves nothing to record"),
        (["!car.*"], "'!car.*': nothing is left out of nothing; put '*' before, for all inputs and outputs"),
    ],
)
def test_a_pattern_that_does_nothing_or_leaves_nothing_is_refused(patterns, said):
    with pytest.raises(ConfigError) as caught:
        recorded_names(INTERFACES, Record("here", patterns))
    assert str(caught.value) == f"here: record: {said}"
    if patterns[0] == "*":
        with pytest.raises(ConfigError) as caught:
            plan([], options={"record": patterns[1:]})
        assert str(caught.value) == f"record: {said}"


def test_a_file_may_leave_out_what_another_unit_has_not():
    record = Record("here", ["*", "!car.wheel", "!*.wheel"], changed=["car"])
    assert "car.speed" in recorded_names(INTERFACES, record)
    for refused in (
        Record("here", ["*", "!ecu.wheel"], changed=["car"]),
        Record("here", ["*"], ["!car.wheel"], changed=["car"]),
    ):
        with pytest.raises(ConfigError, match=r"wheel' fits no variable"):
            recorded_names(INTERFACES, refused)


def test_nothing_is_recorded_where_the_file_says_so():
    assert recorded_names(INTERFACES, Record("here", [])) == set()
    assert recorded_names({"u": UnitInterface("u.fmu", {})}, Record("here", ["*"])) == set()
    assert recorded_names(INTERFACES, Record("here", ["car.speed"], ["!ecu.speed"])) == {"car.speed"}
