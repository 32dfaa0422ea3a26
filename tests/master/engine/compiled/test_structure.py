"""One structure for runs that differ in numbers alone, and another for each difference of the schedule."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from evcosim.master.engine.compiled.structure import Structure, _is_plain, key, structure_of
from evcosim.master.machine import tables as L
from evcosim.master.simulation import Simulation

pytestmark = pytest.mark.usefixtures("warm_units")


def structure(system: str = "scooter", scenario: str | None = "fig8", **options: object) -> Structure:
    """The structure of a built-in system."""
    with Simulation(system, scenario, engine="compiled", isolation="none", **options) as simulation:
        return structure_of(simulation._engine._program)


def test_numbers_do_not_change_it() -> None:
    plain = key(structure())
    assert key(structure(parameters={"vehicle.mass": 150.0})) == plain
    assert key(structure(stop_time=3.0)) == plain
    assert key(structure(delay=0.01)) != plain


def test_what_is_recorded_and_the_order_of_a_step_change_it() -> None:
    keys = {key(structure()), key(structure(record=["vehicle.*"])), key(structure(algorithm="jacobi"))}
    assert len(keys) == 3


def test_operations_that_are_due_together_have_one_group() -> None:
    steps = structure().steps
    groups = [step.group for step in steps]
    assert set(groups) > {-1}  # messages with a cycle of 0.1 s
    for i, group in enumerate(groups):
        assert group <= i and (group == -1 or groups[group] == group)


def test_every_part_is_in_its_key() -> None:
    found = structure()
    for i, step in enumerate(found.steps):
        for field in ("kind", "group", "a", "b", "c"):
            changed = dataclasses.replace(step, **{field: getattr(step, field) + 1})
            steps = (*found.steps[:i], changed, *found.steps[i + 1 :])
            assert key(Structure(steps, found.columns)) != key(found)
    assert {step.kind for step in found.steps} >= {L.TAKE, L.STEP, L.CALL, L.SEND, L.RECORD}


@pytest.mark.parametrize(
    ("scale", "add", "plain"),
    [(1.0, -0.0, True), (1.0, 0.0, False), (1.0, 1.0, False), (2.0, -0.0, False), (1.0, np.nan, False)],
)
def test_a_map_that_changes_nothing(scale: float, add: float, plain: bool) -> None:
    assert _is_plain(scale, add) == plain
    for x in (0.0, -0.0, 1.5, -1e300):
        assert not plain or np.float64(scale * x + add).tobytes() == np.float64(x).tobytes()
