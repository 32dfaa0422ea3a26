"""Thinned lines keep what is seen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.figures import thinning
from evcosim.cosim.figures.thinning import points_per_line, thinned, thinned_variable
from evcosim.cosim.results.results import Results, ResultVariable

samples = arrays.arrays(np.float64, st.integers(0, 400), elements=st.floats(-1e3, 1e3))


@given(samples, st.integers(10, 60))
def test_thinning_keeps_the_ends_the_extremes_and_the_order(values: np.ndarray, limit: int) -> None:
    keep = thinned(values, limit)
    assert len(keep) <= max(limit + 4, 0)
    assert np.all(np.diff(keep) > 0)
    if len(values):
        assert keep[0] == 0 and keep[-1] == len(values) - 1
        assert values[keep].min() == values.min() and values[keep].max() == values.max()


@given(samples, st.integers(10, 60))
def test_few_values_are_all_kept(values: np.ndarray, limit: int) -> None:
    assert np.array_equal(thinned(values, len(values) + limit), np.arange(len(values)))


@pytest.mark.parametrize("rows", [1, 7, 100, 4000])
@pytest.mark.parametrize("limit", [10, 64, 5000])
def test_a_variable_is_thinned_as_its_values_are_however_they_are_read(
    rows: int, limit: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Read in pieces, the ends of pieces may stay beside what is kept of the whole."""
    values = np.random.default_rng(1).normal(size=3001)
    results = Results(np.arange(3001) * 0.01, values[:, None], [ResultVariable("a.x")])
    monkeypatch.setattr(thinning, "PIECE", rows)
    time, kept = thinned_variable(results, "a.x", limit)
    indices = np.round(time / 0.01).astype(int)
    assert np.array_equal(kept, values[indices])
    assert set(thinned(values, limit)) <= set(indices)
    assert len(kept) <= 2 * limit + 4 or len(kept) <= 2 * len(values) / rows


@given(st.integers(0, 10_000))
def test_many_lines_share_the_points_of_a_figure(lines: int) -> None:
    assert 300 <= points_per_line(lines + 1) <= points_per_line(lines) <= 4000
