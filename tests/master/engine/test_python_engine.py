"""The algorithms with units written in Python, against closed forms and the semantics of one step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from support.mocks import TICK, MockUnit, clock, column, plan_of, probe, real, started

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
        (
            {"action": "override", "variable": "display.state", "value": 1.5},
            "display.state is an Integer, not 1.5",
        ),
        (
            {"action": "override", "variable": "display.flag", "value": 2.0},
            "is a Boolean, true or false, not 2.0",
        ),
        (
            {"action": "bias", "variable": "display.flag", "value": 1.0},
            "action: .* a Boolean, to which nothing can be added",
        ),
        ({"action": "override", "variable": "display.stat", "value": 1.0}, r"did you mean 'display.state'\?"),
    ],
)
def test_an_effect_must_fit_its_input(event, said):
    units = [state_machine(), display()]
    with pytest.raises(ConfigError, match=said):
        plan_of(units, OVER_BUS, {"event": [{"time": 0.0} | event]})
