"""The memory of a unit: the master reads it within its bounds, and messages outlive the child."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.unit_plan import Route, SlotGroup, SlotGroupKind, UnitPlan
from evcosim.master.isolation import shared
from evcosim.master.isolation.shared import Shared
from evcosim.master.machine import slots as S
from evcosim.master.simulation import simulate
from support.pairs import pair


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_the_last_messages_of_a_unit_that_crashes_reach_the_error(tmp_path: Path, fmi: int) -> None:
    with pytest.raises(RunError, match=r"SIGSEGV .*\n.*its last messages:\n\[Error\] out of coffee"):
        simulate(pair(tmp_path, 64, fmi))


def test_warnings_are_counted_as_in_the_master(tmp_path: Path) -> None:
    path = pair(tmp_path, 11)
    apart, here = (simulate(path, isolation=isolation) for isolation in ("process", "none"))
    assert apart.manifest["warnings"] == here.manifest["warnings"] != []


@pytest.fixture
def memory() -> Iterator[tuple[Shared, Shared]]:
    """The memory as the master has it, and as the child does."""
    descriptor = shared.create(10)
    yield Shared(descriptor), Shared(descriptor)
    os.close(descriptor)


def test_one_side_reads_what_the_other_writes(memory: tuple[Shared, Shared]) -> None:
    master, child = memory
    assert master.values.shape == (10,)
    child.values[:] = range(10)
    child.slots[S.ANSWER] = 7.0
    assert master.values.tolist() == list(range(10))
    assert master.slots[S.ANSWER] == 7.0
    master.slots[S.REQUEST] = 8.0
    assert child.slots[S.REQUEST] == 8.0


def test_the_child_cannot_make_it_smaller(memory: tuple[Shared, Shared]) -> None:
    descriptor = shared.create(10)
    try:
        with pytest.raises(PermissionError):
            os.ftruncate(descriptor, 8)
    finally:
        os.close(descriptor)


def test_the_last_twenty_messages_are_kept_and_warnings_counted(memory: tuple[Shared, Shared]) -> None:
    master, child = memory
    for i in range(33):
        child.hear(i % 3, f"message {i}")
    assert master.heard() == [(i % 3, f"message {i}") for i in range(13, 33)]
    assert master.warnings() == 11
    child.hear(1, "Grüße " + "x" * 5000)
    status, text = master.heard()[-1]
    assert (status, text[:7], len(text.encode())) == (1, "Grüße x", 2048)


def test_the_first_kinds_of_warnings_are_kept(memory: tuple[Shared, Shared]) -> None:
    master, child = memory
    for i in range(200):
        child.hear(1, f"{'abcd'[i // 50]} at {i} s")
        child.hear(0, "chatter")
    assert master.warned() == [("a at 0 s", 50), ("b at 50 s", 50), ("c at 100 s", 50)]
    assert master.warnings() == 200
    child.slots[S.WARNED] = 2.0**60
    assert master.warned() == []


@pytest.mark.parametrize("claim", [math.nan, math.inf, -1.0, 2.0**60])
def test_a_count_that_is_none_is_taken_as_0(memory: tuple[Shared, Shared], claim: float) -> None:
    master, child = memory
    child.hear(1, "message")
    child.slots[S.WARNINGS] = claim
    assert master.warnings() == 0
    child.slots[shared._RING + 1] = claim  # the length of the message
    assert [len(text) for _, text in master.heard()] == [0]
    child.slots[S.MESSAGES] = claim
    assert master.heard() == []


def plan_of(*groups: tuple[SlotGroupKind, int]) -> UnitPlan:
    """A unit's plan with groups (kind, number of variables) far behind each other in the run's memory."""
    found = []
    for place, (kind, count) in enumerate(groups, 1):
        variables = tuple(VariableInfo(f"{kind}{place}_{i}") for i in range(count))
        latest = 100 * place + 50 if kind == "continuous" else -1
        found.append(SlotGroup(kind, "Real", variables, 100 * place, latest))
    interface = UnitInterface("mock", {v.name: v for group in found for v in group.variables})
    return UnitPlan("a", "mock.fmu", interface, {}, {}, 1, 1, tuple(found), (Route(1, 100),))


def test_a_unit_of_its_own_has_its_groups_side_by_side() -> None:
    plan = plan_of(("input", 3), ("sampled", 2), ("continuous", 4), ("input", 1))
    private, size = shared.private(plan)
    assert private.routes == ()
    assert [group.variables for group in private.groups] == [group.variables for group in plan.groups]
    taken = []
    for group in private.groups:
        for first in (group.slot, group.latest) if group.kind == "continuous" else (group.slot,):
            taken += range(first, first + len(group.variables))
    assert sorted(taken) == list(range(size)) and size == 3 + 2 + 2 * 4 + 1


def test_copies_lead_from_each_variable_to_itself_after_its_step() -> None:
    plan = plan_of(("input", 3), ("sampled", 2), ("continuous", 4), ("input", 1))
    one, two, three, four = plan.groups
    three = dataclasses.replace(three, feedthrough=2)
    plan = dataclasses.replace(plan, groups=(one, two, three, dataclasses.replace(four, type="String")))
    theirs = shared.private(plan)[0].groups
    found = shared.copies(plan.groups, theirs, texts=False)
    assert found.inputs == [(one.slot, theirs[0].slot, 3)]
    # before the step a continuous output stands where it is valid, after it where it is the latest
    assert found.through == [(three.slot, theirs[2].slot, 2)]
    assert found.outputs == [(two.slot, theirs[1].slot, 2), (three.latest, theirs[2].latest, 4)]
    assert shared.copies(plan.groups, theirs, texts=True) == ([(four.slot, theirs[3].slot, 1)], [], [])
