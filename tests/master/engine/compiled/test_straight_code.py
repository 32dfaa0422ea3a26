"""The loop over the steps: its chunks, its groups of operations, and what it leaves to the kernel."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.master.engine.compiled.engine import CompiledEngine
from evcosim.master.engine.compiled.straight_code import straight_code
from evcosim.master.engine.compiled.structure import Step, Structure
from evcosim.master.engine.initialization import initialize
from evcosim.master.machine import tables as L
from evcosim.master.machine.hands import POSSIBLE
from support.mocks import TICK, clock, column, plan_of, probe
from support.straight import by_code, is_straight

alone = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")


def compiled(system: dict[str, object]) -> CompiledEngine:
    """An engine of a clock and a probe, both written in Python."""
    units = {unit.name: unit for unit in (clock(), probe())}
    plan = plan_of([*units.values()], {"connect": TICK} | system)
    engine = CompiledEngine(plan, units)
    initialize(units, plan)
    engine.start()
    return engine


@alone
def test_a_chunk_ends_when_its_time_is_over() -> None:
    with by_code(True):
        engine = compiled({})
        engine._numbers[L.SECONDS] = 0.0
        seen: list[int] = []
        engine.advance(40, seen.append)
        assert is_straight(engine)
    assert seen[-1] == 40
    assert len(seen) > 1
    assert column(engine, "clock.t") == pytest.approx(np.arange(41) * 0.01)


@alone
@pytest.mark.parametrize("parts", [[200], [1, 3, 5, 7, 184], [1] * 200])
def test_periods_and_offsets_go_on_from_chunk_to_chunk(parts: list[int]) -> None:
    system = {"units": {"clock": {"period": 0.05, "offset": 0.02}}}
    rows = []
    for wanted in (False, True):
        with by_code(wanted):
            engine = compiled(system)
            for steps in parts:
                engine.advance(steps)
            assert is_straight(engine) == wanted
            rows.append(engine.recorded().whole().tobytes())
    assert rows[0] == rows[1]


def test_operations_of_a_group_are_looked_up_once() -> None:
    copies = [Step(L.COPY, group, 8 * i, 100 + 8 * i, 2) for i, group in enumerate((-1, 1, 1, 1, -1, 5))]
    alone = straight_code(Structure(tuple(copies[:1]), ()), True)
    text = straight_code(Structure(tuple(copies), ()), True)
    assert text.count("load <2 x double>") == 6
    assert text.count("icmp eq i64") == alone.count("icmp eq i64") + 2
    assert (
        straight_code(Structure((Step(L.COPY, -1, 0, 1, 2),), ()), True).count("load <2") == 0
    )  # they overlap
