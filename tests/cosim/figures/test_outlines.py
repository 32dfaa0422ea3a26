"""Outlines of variables: those of all rows, however many are read at a time, and repeated lines."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.figures import outlines as module
from evcosim.cosim.figures.outlines import Outlines, kind
from evcosim.cosim.results.results import Results, ResultVariable

T = np.arange(5000) * 0.01
RNG = np.random.default_rng(0)
SPIKE = np.where(np.arange(5000) == 4321, 9.0, 0.0)
COLUMNS = {
    "a.x": np.sin(T),
    "a.km": 3.6 * np.sin(T),
    "a.near": np.sin(T) + 0.004 * RNG.standard_normal(5000),
    "a.far": np.sin(T) + 0.03 * RNG.standard_normal(5000),
    "a.spike": SPIKE,
    "a.still": np.full(5000, -2.0),
    "a.gap": np.where(T > 40.0, np.nan, T),
    "a.huge": 1e300 * np.sin(T),
}
VARIABLES = {name: ResultVariable(name, "km/h" if name == "a.km" else "m/s") for name in COLUMNS}


@pytest.fixture(params=[1, 100_000])
def outlines(request, monkeypatch):
    monkeypatch.setattr(module, "_TOGETHER", request.param * len(COLUMNS))
    return Outlines(Results(T, np.column_stack(list(COLUMNS.values())), list(VARIABLES.values())))


def test_size_and_change_count_every_row(outlines):
    assert outlines.size(VARIABLES["a.spike"]) == 9.0
    assert outlines.size(VARIABLES["a.still"]) == 2.0
    assert np.isnan(outlines.size(VARIABLES["a.gap"]))
    changing = {name for name, v in VARIABLES.items() if outlines.changes(v)}
    assert changing == set(COLUMNS) - {"a.still"}


@pytest.mark.parametrize(
    ("name", "other", "same"),
    [
        ("a.km", "a.x", True),  # in another unit
        ("a.x", "a.km", True),
        ("a.near", "a.x", True),  # by less than is seen
        ("a.far", "a.x", False),
        ("a.spike", "a.still", False),
        ("a.still", "a.still", True),  # equal, though it has no range
        ("a.huge", "a.x", False),
        ("a.huge", "a.huge", True),
        ("a.gap", "a.x", False),
    ],
)
def test_a_line_repeats_another(outlines, name, other, same):
    assert outlines.repeats(VARIABLES[name], [VARIABLES[other]]) is same


def test_one_of_several_is_enough_and_quantities_count(outlines):
    assert outlines.repeats(VARIABLES["a.near"], [VARIABLES["a.spike"], VARIABLES["a.x"]])
    assert not outlines.repeats(ResultVariable("a.x", "N"), [VARIABLES["a.x"]])


def test_a_difference_outside_the_sample_is_found():
    """The sample has one row of eighty; the line differs in all others."""
    taken = np.unique(np.linspace(0, 4999, 74).astype(int))
    other = np.sin(T) + 1.0
    other[taken] = np.sin(T)[taken]
    variables = [ResultVariable("a.x"), ResultVariable("a.y")]
    found = Outlines(Results(T, np.column_stack([np.sin(T), other]), variables))
    assert not found.repeats(variables[0], [variables[1]])


def test_no_row_and_no_variable():
    v = ResultVariable("a.x")
    empty = Outlines(Results([], np.empty((0, 1)), [v]))
    assert (empty.size(v), empty.changes(v)) == (0.0, False)
    Outlines(Results([0.0], np.empty((1, 0)), []))


def test_kinds():
    state = ResultVariable("a.s", type="Enumeration", items=((0, "off"),))
    assert kind(state) != kind(ResultVariable("a.x")) != kind(ResultVariable("a.x", "m"))
