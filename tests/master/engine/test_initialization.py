"""Initialization: values travel along dependencies; algebraic loops are refused or iterated."""

from __future__ import annotations

import math

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.engine.initialization import _change
from evcosim.master.unit import UnitError
from support.mocks import MockUnit, column, plan_of, real, started

RING = [{"from": "a.y", "to": ["b.u"]}, {"from": "b.y", "to": ["a.u"]}]


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


def test_a_text_that_changes_is_never_within_a_tolerance():
    assert _change("on", "off") == _change("on", 1.0) == math.inf
    assert _change("on", "on") == 0.0
    assert _change(1.0, -0.5) == 1.5
