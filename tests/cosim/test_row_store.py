"""Rows in memory and in a file are the same rows."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import RunError
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results.results import PIECE, Results, ResultVariable
from evcosim.cosim.row_store import MEMORY, Grid, RowStore
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.metric_spec import MetricSpec

WIDTH = 3
VARIABLES = [
    ResultVariable("a.x"),
    ResultVariable("a.n", type="Integer"),
    ResultVariable("a.b", type="Boolean"),
]
LINE = FigureSpec.model_validate({"panels": [{"label": "x", "signals": ["a.x"]}]})
SPECS = [
    MetricSpec(name=how, signal="a.n", unit="1", reduce=how) for how in ("final", "max", "range", "changes")
]


def chunks(counts: list[int]) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    return [np.round(rng.normal(size=(n, WIDTH))) for n in counts]


@given(
    st.lists(st.integers(0, 40), max_size=8),
    st.integers(0, 2000),
    st.integers(-3, 250),
    st.integers(-3, 250),
    st.booleans(),
)
def test_a_table_does_not_depend_on_where_the_rows_are(
    counts: list[int], memory: int, start: int, stop: int, with_last: bool
) -> None:
    pieces = chunks(counts)
    last = np.ones((1, WIDTH)) if with_last else None
    store = RowStore(WIDTH, memory)
    for piece in pieces:
        store.append(piece)
    expected = np.vstack([np.empty((0, WIDTH)), *pieces, *([] if last is None else [last])])
    table = store.table(last)
    assert len(store) == sum(counts)
    assert table.shape == expected.shape
    assert np.array_equal(table.whole(), expected)
    assert np.array_equal(table.rows(start, stop), expected[start:stop])
    for j in range(WIDTH):
        assert np.array_equal(table.column(j), expected[:, j])
    for columns in ([], [2], [1, 0]):
        assert np.array_equal(table.part(start, stop, columns), expected[start:stop, columns])


@pytest.mark.parametrize("memory", [0, 10**9])
def test_a_table_stays_as_it_was_when_rows_are_appended(memory: int) -> None:
    first, second = chunks([5, 7])
    store = RowStore(WIDTH, memory)
    store.append(first)
    before = store.table(second[:1])
    store.append(second)
    assert np.array_equal(before.whole(), np.vstack([first, second[:1]]))
    assert np.array_equal(store.table().whole(), np.vstack([first, second]))


def test_results_read_the_same_from_a_file(tmp_path: Path) -> None:
    (rows,) = chunks([5000])
    rows[:, 2] = rows[:, 0] > 0.0
    store = RowStore(WIDTH, memory=0)
    store.append(rows)
    time = 0.01 * np.arange(len(rows))
    kept, stored = Results(time, rows, VARIABLES), Results(time, store.table(), VARIABLES)
    assert stored.to_csv(tmp_path / "a.csv").read_bytes() == kept.to_csv(tmp_path / "b.csv").read_bytes()
    assert stored.final() == kept.final() == {name: kept[name][-1].item() for name in kept.names}
    assert [type(x) for x in stored.final().values()] == [float, int, bool]
    part, same = stored.part(time > 10.0, ["a.b", "a.x"]), kept.part(time > 10.0, ["a.b", "a.x"])
    assert part.names == ("a.b", "a.x")
    assert np.array_equal(part.data, same.data)
    assert np.array_equal(part.time, kept.time[time > 10.0])
    for rows in (slice(None), slice(-7, None), slice(4000, 9000), slice(7, 5), slice(None, None, 3)):
        part = stored.part(rows, ["a.b", "a.x"])
        assert np.array_equal(part.data, kept.data[rows][:, [2, 0]])
        assert np.array_equal(part.time, kept.time[rows])


def test_times_on_a_grid_are_those_of_an_array() -> None:
    grid = Grid(-1.0, 0.01, 70_001)
    rows = np.zeros((len(grid), WIDTH))
    kept, made = Results(-1.0 + 0.01 * np.arange(len(rows)), rows, VARIABLES), Results(grid, rows, VARIABLES)
    assert made.span == kept.span == (-1.0, 699.0)
    assert np.array_equal(made.times(69_990, 70_500), kept.time[69_990:])
    assert np.array_equal(made.time, kept.time)
    assert np.array_equal(made.times(3, 5), kept.times(3, 5))
    assert len(Results(Grid(0.0, 0.1, 0), np.zeros((0, WIDTH)), VARIABLES).time) == 0


def reached(count: int, use: Callable[[Results], object]) -> int:
    """The most bytes [B] that a use of so many rows in a file takes."""
    store = RowStore(WIDTH, memory=0)
    for start in range(0, count, 10_000):
        block = np.sin(np.arange(start, start + 10_000.0))[:, None] * [3.0, 0.0, 0.0]
        store.append(block)
    results = Results(Grid(0.0, 0.01, count), store.table(), VARIABLES, metrics=SPECS)
    tracemalloc.start()
    use(results)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize(
    "use", [Results.metrics, lambda r: draw(r, LINE), lambda r: r.part(slice(7), ["a.x"])]
)
def test_what_reads_a_long_run_holds_a_piece_of_it(use: Callable[[Results], object]) -> None:
    """Twice the rows take no more memory: not even a column of those that came to them."""
    count = 3 * PIECE // 10_000 * 10_000
    use(Results([0.0], np.zeros((1, WIDTH)), VARIABLES, metrics=SPECS))  # what is loaded once for all
    assert reached(2 * count, use) - reached(count, use) < 0.2 * 8 * count


def test_writing_a_long_run_holds_a_piece_of_it(tmp_path: Path) -> None:
    peaks = [reached(count, lambda r: r.to_csv(tmp_path / "a.csv")) for count in (20_000, 60_000)]
    assert peaks[1] - peaks[0] < 0.2 * 8 * 40_000


def test_few_rows_need_no_file(tmp_path: Path) -> None:
    """A folder that is none is never asked for."""
    store = RowStore(WIDTH, folder=tmp_path / "none")
    store.append(np.zeros((1000, WIDTH)))
    assert store.table().shape == (1000, WIDTH)
    assert MEMORY > 1000 * WIDTH * 8


def test_a_file_that_cannot_be_written_loses_nothing(tmp_path: Path) -> None:
    store = RowStore(WIDTH, memory=2000, folder=tmp_path / "none")
    first, second = chunks([50, 60])
    store.append(first)
    with pytest.raises(RunError, match=r"cannot be kept in .*none: No such file or directory; TMPDIR"):
        store.append(second)
    assert np.array_equal(store.table().whole(), np.vstack([first, second]))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full is a device of Linux")
def test_a_full_disk_loses_nothing() -> None:
    store = RowStore(WIDTH, memory=0)
    first, second = chunks([50, 60])
    store.append(first)
    assert store._file is not None
    with open("/dev/full", "r+b", buffering=0) as full:
        store._file._file = full
        with pytest.raises(RunError, match="No space left on device"):
            store.append(second)
    assert len(store) == 110
