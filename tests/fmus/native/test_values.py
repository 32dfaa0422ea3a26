"""Values of native FMUs by lists of value references: any order, any length, runs of neighbors or not."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from evcosim.fmus.interface import exposed
from evcosim.fmus.native.build import native_built
from evcosim.models.scooter import Scooter
from support.needs import need_c_compiler

REALS = [e for e in exposed(Scooter) if e.variable.type == "Real"]
INPUTS = [e.reference for e in REALS if e.causality == "input"]
PARAMETERS = [e.reference for e in REALS if e.causality == "parameter"]


@pytest.fixture
def unit(load: Callable[[Path], Any]) -> Any:
    """A native unit of the scooter, before its initialization."""
    need_c_compiler()
    return load(native_built("Scooter")).fmu


def test_what_is_set_by_any_list_is_read_by_any_list(unit: Any) -> None:
    """In lists that ask for neighbors (runs of doubles in the memory), in reverse, in pieces, twice."""
    draw = random.Random(7)
    start = {e.reference: e.variable.start for e in REALS if e.causality != "output"}
    known = dict(start)
    settable = sorted(known)
    for _ in range(200):
        begin, end = sorted(draw.sample(range(len(settable) + 1), 2))
        chosen = draw.choice((settable[begin:end], settable[begin:end][::-1], draw.choices(settable, k=9)))
        values = [start[reference] * draw.uniform(0.999, 1.0) for reference in chosen]
        unit.setReal(chosen, values)
        known.update(zip(chosen, values, strict=True))
    assert known != start
    unit.setupExperiment()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    known |= {e.reference: unit.getReal([e.reference])[0] for e in REALS if e.causality == "output"}
    everything = sorted(known)
    for asked in (everything, everything[::-1], everything[1:-1], everything[::2], everything * 2, []):
        assert unit.getReal(asked) == [known[reference] for reference in asked]


def test_a_list_with_one_that_cannot_be_set_sets_none(unit: Any) -> None:
    unit.setupExperiment()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    before = unit.getReal(INPUTS)
    for more in ([INPUTS[-1] + 1], PARAMETERS[-1:], [4_000_000_000]):  # an output, a parameter, none
        for references in ([*INPUTS, *more], [*more, *INPUTS]):
            with pytest.raises(Exception, match="status 3"):
                unit.setReal(references, [1.0] * len(references))
            assert unit.getReal(INPUTS) == before
    with pytest.raises(Exception, match="status 3"):
        unit.getReal([*INPUTS, 4_000_000_000])
