"""Columns of a page: what is unpacked draws the same curve, and times are exactly those of the run."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.report.columns import Columns, packed
from support.pages import times_of, unpacked

T = np.arange(1000) * 0.01


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        (np.sin(T), "f4"),
        (np.floor(T), "f4"),
        (1e5 + np.sin(T), "f8"),  # float32 would show steps
        (np.full(5, 0.1), "f8"),
        (1e300 * T, "f8"),
        (np.where(T > 3.0, np.nan, T), "f4"),
        (np.array([np.inf, -np.inf, np.nan]), "f4"),
        (np.empty(0), "f4"),
        (np.array([0.0, -0.0, 1e-320]), "f8"),
    ],
)
def test_numbers_come_back_as_well_as_the_eye_sees(values, kind):
    about = packed(values)
    back = unpacked(about)
    assert about["type"] == kind
    finite = values[np.isfinite(values)]
    span = np.ptp(finite) if len(finite) else 0.0
    np.testing.assert_allclose(back, values, rtol=0.0, atol=1e-5 * span)
    if kind == "f8":
        np.testing.assert_array_equal(back, values)


@pytest.mark.parametrize(
    "times",
    [
        Clock.counted(0.0, 0.01, 4000).times(0, 4001),
        Clock.counted(-3.0, 0.1, 50).times(0, 51),
        Clock.counted(0.0, 1 / 60, 600, 10.0).times(0, 601),
        np.array([0.0, 0.1, 0.1, 0.7]),
        np.array([5.0]),
    ],
)
def test_times_come_back_bit_for_bit(times):
    columns = Columns()
    columns.grid(times)
    np.testing.assert_array_equal(times_of(columns.as_data()["grids"][0]), times)


def test_equal_steps_are_counted_and_other_times_are_not():
    columns = Columns()
    columns.grid(Clock.counted(0.0, 0.01, 4000).times(0, 4001))
    columns.grid(np.array([0.0, 0.1, 0.7]))
    counted, listed = columns.as_data()["grids"]
    assert "data" not in counted and "data" in listed


def test_what_is_equal_stands_there_once():
    columns = Columns()
    grid = columns.grid(T)
    assert columns.grid(T.copy()) == grid
    first = columns.column(grid, np.sin(T))
    assert columns.column(grid, np.sin(T)) == first
    assert columns.column(grid, np.cos(T)) != first
    assert columns.column(columns.grid(T[:3]), np.sin(T[:3])) != first
    assert len(columns.as_data()["columns"]) == 3


def test_gaps_are_counted():
    columns = Columns()
    columns.column(columns.grid(T[:4]), np.array([1.0, np.nan, np.inf, 2.0]))
    assert columns.as_data()["columns"][0]["gaps"] == 2
