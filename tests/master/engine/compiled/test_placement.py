"""Processes look for their turns only where turns are short and looking makes them faster."""

from __future__ import annotations

import itertools
import os

import pytest

from evcosim.master.engine.compiled.placement import Placement
from evcosim.master.machine.hands import LOOK_TIME

CORES = {0, 1, 2}
TURNS = 1000


class Settled:
    """A unit that notes where it is put."""

    hand = None

    def __init__(self) -> None:
        self.cores, self.look = CORES, 0.0

    def quicken(self, code: bytes) -> None:
        """Do nothing: no process is there."""

    def settle(self, cores: set[int], look: float) -> None:
        self.cores, self.look = cores, look


@pytest.fixture
def units(monkeypatch: pytest.MonkeyPatch) -> list[Settled]:
    """Two units on a machine of three cores; the master is on one of them."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(CORES), raising=False)
    monkeypatch.setattr("ctypes.CDLL", lambda _: type("Library", (), {"sched_getcpu": lambda self: 1})())
    return [Settled(), Settled()]


def test_processes_that_are_faster_so_look_on_the_cores_that_the_master_is_not_on(
    units: list[Settled],
) -> None:
    placement = Placement(units)
    placement.judge(20e-6 * TURNS, TURNS)
    assert placement.looking
    for unit in units:
        assert unit.cores == CORES - {1}
        assert unit.look >= 2 * 20e-6  # until its turn comes round again
    for _ in range(100):
        placement.judge(5e-6 * TURNS, TURNS)
    assert placement.looking


def test_processes_that_are_slower_so_sleep_again_and_are_tried_less_and_less(units: list[Settled]) -> None:
    placement, trials = Placement(units), []
    for chunk in range(2000):
        placement.judge((40e-6 if placement.looking else 20e-6) * TURNS, TURNS)
        if placement.looking:
            trials.append(chunk)
        else:
            assert all((unit.cores, unit.look) == (CORES, 0.0) for unit in units)
    pauses = [later - sooner for sooner, later in itertools.pairwise(trials)]
    assert pauses == sorted(pauses)
    assert pauses[0] < 5 and len(trials) < 20


@pytest.mark.parametrize(
    ("seconds", "turns"), [(LOOK_TIME * TURNS, TURNS), (1e-6, 1)], ids=["long turns", "too few of them"]
)
def test_nothing_changes_where_looking_would_not_help_or_nothing_is_known(
    units: list[Settled], seconds: float, turns: int
) -> None:
    placement = Placement(units)
    for _ in range(100):
        placement.judge(seconds, turns)
    assert not placement.looking


def test_no_process_looks_on_a_machine_of_one_core(
    units: list[Settled], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    placement = Placement(units)
    placement.judge(5e-6 * TURNS, TURNS)
    assert not placement.looking


def test_a_unit_whose_process_has_ended_does_not_stop_the_run(units: list[Settled]) -> None:
    def ended(cores: set[int], look: float) -> None:
        raise ProcessLookupError

    units[0].settle = ended  # type: ignore[method-assign] # as of a process that was killed
    Placement(units).judge(5e-6 * TURNS, TURNS)
