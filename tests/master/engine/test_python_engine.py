"""The algorithms with units written in Python, against closed forms and the semantics of one step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.interface import VariableInfo
from evcosim.master.unit import UnitError
from support.mocks import MockUnit, column, plan_of, real, started

A, B, K, X0, H = math.exp(-0.02), 0.5 * (1.0 - math.exp(-0.02)), 3.0, 2.0, 0.01
LOOP = [{"from": "plant.x", "to": ["controller.x"]}, {"from": "controller.u", "to": ["plant.u"]}]


def plant(**start: float) -> MockUnit:
    """x' = -2 x + u, stepped exactly for a held u."""

    def step(values, time, step_size):
        values["x"] = A * values["x"] + B * values["u"]

    return MockUnit("plant", [real("u", "input"), real("x", "output")], step, **start)


def controller() -> MockUnit:
    """u = -K x, sampled."""

    def step(values, time, step_size):
        values["u"] = -K * values["x"]

    return MockUnit("controller", [real("x", "input"), real("u", "output", variability="discrete")], step)


def test_gauss_seidel_is_the_closed_form_without_delay():
    units = [controller(), plant(x=X0)]
    engine = started(units, plan_of(units, {"connect": LOOP}))
    engine.advance(300)
    expected = X0 * (A - B * K) ** np.arange(301)
    assert column(engine, "plant.x") == pytest.approx(expected, rel=1e-12, abs=1e-15)
    # row k: what the receiver saw at t_k
    assert np.array_equal(column(engine, "controller.x")[:300], column(engine, "plant.x")[:300])
    assert np.array_equal(column(engine, "plant.u")[:300], -K * column(engine, "plant.x")[:300])


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
def test_one_step_of_delay_round_the_loop(algorithm):
    """Jacobi, and Gauss-Seidel with the plant written first, delay the loop by one step.

    x_{k+1} = A x_k - B K x_{k-1} with a zero command in the first step; Gauss-Seidel with the plant first
    hands x_{k+1} to the controller within step k, so that its command reaches the plant in step k + 1:
    no delay is added after the first step.
    """
    units = [plant(x=X0), controller()]
    engine = started(units, plan_of(units, {"connect": LOOP}, algorithm=algorithm))
    engine.advance(50)
    x = [X0]
    for k in range(50):
        delayed = x[k - 1] if algorithm == "jacobi" else x[k]
        x.append(A * x[k] + B * (-K * delayed if k > 0 else 0.0))
    assert column(engine, "plant.x") == pytest.approx(x, rel=1e-12, abs=1e-15)


def test_jacobi_does_not_depend_on_the_order():
    runs = []
    for units in ([plant(x=X0), controller()], [controller(), plant(x=X0)]):
        engine = started(units, plan_of(units, {"connect": LOOP}, algorithm="jacobi"))
        engine.advance(40)
        runs.append(column(engine, "plant.x"))
    assert np.array_equal(runs[0], runs[1])


def clock(name: str = "clock") -> MockUnit:
    """Shows the end of its last step: t after stepping to t."""

    def step(values, time, step_size):
        values["t"] = round(time + step_size, 9)

    return MockUnit(name, [real("t", "output")], step)


def probe(name: str = "probe", **more: float) -> MockUnit:
    """Notes what it receives."""

    def step(values, time, step_size):
        values["seen"] = values["t"]

    variables = [real("t", "input"), real("seen", "output", variability="discrete")]
    return MockUnit(name, variables, step, **more)


TICK = [{"from": "clock.t", "to": ["probe.t"]}]


def test_a_later_unit_receives_what_was_just_computed():
    units = [clock(), probe()]
    engine = started(units, plan_of(units, {"connect": TICK}))
    engine.advance(3)
    assert column(engine, "probe.seen")[:3] == pytest.approx([0.01, 0.02, 0.03])
    assert column(engine, "clock.t") == pytest.approx([0.0, 0.01, 0.02, 0.03])  # valid at t_k


def test_an_earlier_unit_receives_what_is_valid_now():
    units = [probe(), clock()]
    engine = started(units, plan_of(units, {"connect": TICK}))
    engine.advance(3)
    assert column(engine, "probe.seen")[:3] == pytest.approx([0.0, 0.01, 0.02])


def test_a_longer_period_steps_ahead_but_shows_nothing_early():
    units = [clock(), probe()]
    engine = started(
        units, plan_of(units, {"units": {"clock": {"period": 0.03, "substeps": 2}}, "connect": TICK})
    )
    engine.advance(7)
    assert [s for s, _ in units[0].steps] == pytest.approx([0.0, 0.015, 0.03, 0.045, 0.06, 0.075])
    assert [h for _, h in units[0].steps] == pytest.approx([0.015] * 6)
    assert column(engine, "probe.seen")[:7] == pytest.approx([0, 0, 0, 0.03, 0.03, 0.03, 0.06])


def test_a_sampled_unit_with_a_period_holds_its_inputs_and_outputs():
    units = [probe(), clock()]
    engine = started(units, plan_of(units, {"units": {"probe": {"period": 0.05}}, "connect": TICK}))
    engine.advance(11)
    assert len(units[0].steps) == 3
    assert column(engine, "probe.seen")[:11] == pytest.approx([0.0] * 5 + [0.05] * 5 + [0.10])


def test_feedthrough_outputs_belong_to_the_inputs_of_their_row():
    def double(values):
        values["y"] = 2.0 * values["t"]

    gain = MockUnit("gain", [real("t", "input"), real("y", "output", depends=("t",))], through=double)
    units = [gain, clock()]
    engine = started(units, plan_of(units, {"connect": [{"from": "clock.t", "to": ["gain.t"]}]}))
    engine.advance(5)
    assert np.array_equal(column(engine, "gain.y")[:5], 2.0 * column(engine, "gain.t")[:5])
    assert column(engine, "gain.t")[:5] == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])


# ---- events and stimuli


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
    t = np.arange(600) * H
    expected = 1.0 + 2.0 * np.sin(2 * np.pi * (t - 0.5) / 3.0) * (t >= 0.5)
    assert column(engine, "probe.seen")[:600] == pytest.approx(expected, abs=1e-12)


# ---- failures


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


# ---- initialization


def chain(name: str, factor: float, constant: float = 0.0) -> MockUnit:
    """y = factor * u + constant at the same instant."""

    def through(values):
        values["y"] = factor * values["u"] + constant

    output = real("y", "output", depends=("u",), depends_initially=("u",))
    return MockUnit(name, [real("u", "input"), output], through=through)


def test_initial_values_travel_down_a_chain_whatever_the_order():
    units = [chain("c", 3.0), chain("b", 2.0), chain("a", 1.0, 5.0)]
    connect = [{"from": "b.y", "to": ["c.u"]}, {"from": "a.y", "to": ["b.u"]}]
    engine = started(units, plan_of(units, {"connect": connect}))
    assert column(engine, "c.y")[-1] == pytest.approx(30.0)


RING = [{"from": "a.y", "to": ["b.u"]}, {"from": "b.y", "to": ["a.u"]}]


def test_an_algebraic_loop_is_refused_by_name():
    units = [chain("a", 0.5, 1.0), chain("b", 0.5)]
    plan = plan_of(units, {"connect": RING})
    with pytest.raises(ConfigError, match="algebraic loop") as caught:
        started(units, plan)
    for name in ("a.u", "a.y", "b.u", "b.y"):
        assert name in str(caught.value)


def test_an_algebraic_loop_is_iterated_where_asked():
    units = [chain("a", 0.5, 1.0), chain("b", 0.5)]
    plan = plan_of(units, {"connect": RING, "experiment": {"algebraic_loops": "iterate"}})
    engine = started(units, plan)
    assert column(engine, "a.y")[-1] == pytest.approx(1.0 / (1.0 - 0.25), abs=1e-8)


def test_a_loop_that_does_not_converge_says_so():
    units = [chain("a", 2.0, 1.0), chain("b", 1.0)]
    plan = plan_of(units, {"connect": RING, "experiment": {"algebraic_loops": "iterate"}})
    with pytest.raises(UnitError, match="does not converge"):
        started(units, plan)


# ---- Integer and Boolean inputs over a bus


def state_machine() -> MockUnit:
    """Shows a state 0, 1, 2, 0, ... and a flag that is set in state 2."""

    def step(values, time, step_size):
        values["state"] = round(time / step_size) // 10 % 3
        values["flag"] = values["state"] == 2

    state = VariableInfo("state", "Enumeration", "output", "discrete", items=((0, "a"), (1, "b"), (2, "c")))
    return MockUnit("machine", [state, VariableInfo("flag", "Boolean", "output", "discrete")], step)


def display() -> MockUnit:
    integer = VariableInfo("state", "Integer", "input", "discrete", start=0)
    return MockUnit("display", [integer, VariableInfo("flag", "Boolean", "input", "discrete", start=False)])


OVER_BUS = {
    "buses": {"can0": {"dbc": "can/ev.dbc"}},
    "connect": [
        {"from": "machine.state", "to": ["display.state"], "via": "can0.VCU_State.VCU_ControllerState"},
        {"from": "machine.flag", "to": ["display.flag"], "via": "can0.VCU_State.VCU_DriverTakeover"},
    ],
}


def test_states_and_flags_cross_a_bus_every_100_ms():
    units = [machine := state_machine(), display()]
    engine = started(units, plan_of(units, OVER_BUS))
    engine.advance(60)
    sent, seen = column(engine, "machine.state"), column(engine, "display.state")
    assert set(seen) == {0.0, 1.0, 2.0}
    for k in range(60):
        assert seen[k] == sent[k - k % 10]  # sampled at 0, 0.1, ... s, and held
        assert column(engine, "display.flag")[k] == (seen[k] == 2.0)
    assert len(machine.steps) == 60


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ({"action": "override", "variable": "display.state", "value": 1.5}, "needs a whole number, not 1.5"),
        ({"action": "override", "variable": "display.flag", "value": 2.0}, "overridden by 0 or 1"),
        ({"action": "bias", "variable": "display.flag", "value": 1.0}, "overridden by 0 or 1, not bias"),
        ({"action": "override", "variable": "display.stat", "value": 1.0}, r"did you mean 'display.state'\?"),
    ],
)
def test_an_effect_must_fit_its_input(event, said):
    units = [state_machine(), display()]
    with pytest.raises(ConfigError, match=said):
        plan_of(units, OVER_BUS, {"event": [{"time": 0.0} | event]})
