"""Chunks, events, stimuli and failures, which both engines have from their base."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.master.unit import UnitError
from support.mocks import TICK, MockUnit, clock, column, plan_of, probe, real, started


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
def test_override_bias_reset(algorithm):
    events = [
        {"time": 0.02, "action": "override", "variable": "probe.t", "value": 7.0},
        {"time": 0.04, "action": "bias", "variable": "probe.t", "value": 1.0},
        {"time": 0.06, "action": "reset", "variable": "probe.t"},
    ]
    units = [probe(), clock()]
    engine = started(units, plan_of(units, {"connect": TICK}, {"event": events}, algorithm=algorithm))
    engine.advance(8)
    expected = [0.0, 0.01, 7.0, 7.0, 1.04, 1.05, 0.06, 0.07]
    assert column(engine, "probe.t")[:8] == pytest.approx(expected)
    assert column(engine, "probe.seen")[:8] == pytest.approx(expected)
    assert column(engine, "clock.t")[:8] == pytest.approx(np.arange(8) * 0.01)  # the sender is not touched


@pytest.mark.parametrize("before", ["override", "bias"])
def test_a_bias_takes_the_place_of_what_acted_before(before):
    """It counts from what drives the input, and lasts until the next one."""
    table = [(0.01, before, 7.0), (0.03, "bias", 1.0), (0.05, "bias", 2.0), (0.06, "override", 5.0)]
    events = [{"time": t, "action": kind, "variable": "probe.t", "value": v} for t, kind, v in table]
    units = [probe()]
    engine = started(units, plan_of(units, {}, {"event": events}))
    engine.advance(8)
    assert list(column(engine, "probe.seen")[:8]) == [0.0, 7.0, 7.0, 1.0, 1.0, 2.0, 5.0, 5.0]


def test_a_bias_on_an_input_that_nothing_drives_does_not_add_up():
    units = [probe()]
    events = [{"time": 0.0, "action": "bias", "variable": "probe.t", "value": 1.5}]
    engine = started(units, plan_of(units, {}, {"event": events}))
    engine.advance(4)
    assert column(engine, "probe.seen")[:4] == pytest.approx([1.5] * 4)


def test_an_event_between_two_points_waits_for_the_next():
    units = [probe()]
    events = [{"time": 0.011, "action": "override", "variable": "probe.t", "value": 1.0}]
    engine = started(units, plan_of(units, {}, {"event": events}))
    engine.advance(4)
    assert column(engine, "probe.seen")[:4] == pytest.approx([0.0, 0.0, 1.0, 1.0])


def test_a_stimulus_is_exact_at_every_point_over_several_chunks():
    units = [probe()]
    sine = {"amplitude": 2.0, "period": 3.0, "mean": 1.0, "delay": 0.5}
    engine = started(units, plan_of(units, {}, {"stimulus": [{"to": "probe.t", "sine": sine}]}))
    for steps in (1, 300, 257, 42):
        engine.advance(steps)
    t = np.arange(600) * 0.01
    expected = 1.0 + 2.0 * np.sin(2 * np.pi * (t - 0.5) / 3.0) * (t >= 0.5)
    assert column(engine, "probe.seen")[:600] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_output_that_is_no_number_stops_the_run_and_keeps_the_rows(value):
    def step(values, time, step_size):
        values["t"] = value if time >= 4.995 else time

    bad = MockUnit("bad", [real("t", "output", unit="m/s")], step)
    engine = started([bad], plan_of([bad], {}))
    with pytest.raises(RunError, match=rf"t = 5 s \(step 500\): bad.t = {value} m/s"):
        engine.advance(600)
    assert engine.k == 500
    assert engine.recorded().shape[0] == 500


def test_a_unit_that_fails_is_named_with_the_time():
    def step(values, time, step_size):
        if time > 0.025:
            raise UnitError("unit 'bad': fmi2DoStep returned Error (3)")

    bad = MockUnit("bad", [real("t", "output")], step)
    engine = started([bad], plan_of([bad], {}))
    with pytest.raises(UnitError, match=r"t = 0.03 s \(step 3\): unit 'bad': fmi2DoStep returned Error"):
        engine.advance(10)
    assert engine.recorded().shape[0] == 3


def test_an_interrupt_keeps_the_rows():
    def step(values, time, step_size):
        if time > 3.0:
            raise KeyboardInterrupt

    bad = MockUnit("bad", [real("t", "output")], step)
    engine = started([bad], plan_of([bad], {}))
    with pytest.raises(KeyboardInterrupt):
        engine.advance(1000)
    assert engine.recorded().shape[0] == engine.k == 301
