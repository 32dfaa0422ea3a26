"""Warnings of outputs beyond their declared range, or diverged; no recorded row is read twice."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.row_store import RowStore
from evcosim.master.engine import plausibility
from evcosim.master.engine.plausibility import Extremes, implausible
from support.mocks import MockUnit, plan_of, started


def warnings(values, **limits):
    """The warnings of an output that takes these values one after the other, from the start on."""

    def step(now, time, step_size):
        now["y"] = values[round(time / 0.01) + 1]

    output = VariableInfo("y", "Real", "output", "discrete", unit="m", **limits)
    unit = MockUnit("a", [output], step, y=values[0])
    plan = plan_of([unit], {})
    engine = started([unit], plan)
    engine.advance(len(values) - 1)
    return implausible(Extremes(len(plan.columns)).of(engine.recorded()), plan)


@pytest.mark.parametrize(
    ("values", "limits", "expected"),
    [
        ([0.0, 1.0, 0.5], {"min": 0.0, "max": 1.0}, []),
        ([0.0, 1.0 + 1e-10, 0.5], {"max": 1.0}, []),
        ([0.0, 1.5, 0.5], {"max": 1.0}, ["a.y reached 1.5 m, above its maximum of 1 m"]),
        ([0.0, -2.0, 3.0], {"min": -1.0, "max": 1.0}, ["a.y reached -2 m, below its minimum of -1 m"]),
        ([0.0, 1e29, 0.0], {}, []),
        (
            [0.0, -1e31, 1.0],
            {},
            ["a.y reached -1e+31 m: it diverged, or its unit of measure is not what it says"],
        ),
    ],
)
def test_sentences(values, limits, expected):
    assert warnings(values, **limits) == expected


def test_extremes_of_a_growing_table_read_no_final_row_twice(monkeypatch):
    monkeypatch.setattr(plausibility, "_ROWS", 3)
    rows = np.random.default_rng(1).normal(size=(11, 2))
    store, extremes = RowStore(2), Extremes(2)
    for begin, end in ((0, 4), (4, 5), (5, 11)):
        store.append(rows[begin:end])
        now = np.array([[9.0, -9.0]])  # the row of the present instant is not final: it may not stay
        low, high = extremes.of(store.table(now))
        expected = np.vstack([rows[:end], now])
        assert np.array_equal(low, expected.min(axis=0))
        assert np.array_equal(high, expected.max(axis=0))
    assert extremes._rows == 11


def test_a_table_of_one_row():
    store = RowStore(1)
    low, high = Extremes(1).of(store.table(np.array([[2.0]])))
    assert (low[0], high[0]) == (2.0, 2.0)
