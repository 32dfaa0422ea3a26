"""The compiled engine calls back for what the kernel cannot do, and hands on what went wrong there."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.master.engine.compiled.engine import CompiledEngine
from evcosim.master.engine.initialization import initialize
from evcosim.master.machine import tables as L
from support.mocks import TICK, MockUnit, clock, column, plan_of, probe, real, started


def compiled(units, plan):
    by_name = {unit.name: unit for unit in units}
    engine = CompiledEngine(plan, by_name)
    initialize(by_name, plan)
    engine.start()
    return engine


def run(make, steps, system=None, scenario=None):
    """The rows of both engines, with units that `make` gives."""
    rows = []
    for start in (started, compiled):
        units = make()
        engine = start(units, plan_of(units, system or {}, scenario))
        engine.advance(steps)
        rows.append(engine.recorded().whole())
    return rows


def test_units_in_python_stimuli_and_events():
    sine = {"amplitude": 2.0, "period": 3.0}
    events = [
        {"time": 0.2, "action": "override", "variable": "probe.t", "value": 7.0},
        {"time": 0.4, "action": "bias", "variable": "other.t", "value": 1.0},
        {"time": 0.6, "action": "reset", "variable": "probe.t"},
    ]
    scenario = {"stimulus": [{"to": "other.t", "sine": sine}], "event": events}
    a, b = run(lambda: [clock(), probe(), probe("other")], 700, {"connect": TICK}, scenario)
    assert np.array_equal(a, b)


def test_ctrl_c_in_a_callback_keeps_the_rows():
    def step(values, time, step_size):
        if time > 0.5:
            raise KeyboardInterrupt

    unit = MockUnit("bad", [real("t", "output")], step)
    engine = compiled([unit], plan_of([unit], {}))
    with pytest.raises(KeyboardInterrupt):
        engine.advance(100)
    assert engine.k == engine.recorded().shape[0] == 51
    assert not engine.whole


def test_a_chunk_ends_when_its_time_is_over(monkeypatch):
    units = [clock(), probe()]
    engine = compiled(units, plan_of(units, {"connect": TICK}))
    engine._numbers[L.SECONDS] = 0.0
    seen = []
    engine.advance(40, seen.append)
    assert seen[-1] == 40
    assert len(seen) > 1
    assert column(engine, "clock.t") == pytest.approx(np.arange(41) * 0.01)
