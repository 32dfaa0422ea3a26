"""Rows in memory and in a file are the same rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import RunError
from evcosim.cosim.row_store import MEMORY, Grid, MemoryTable, RowStore, Table
from support.small_disk import small_disk

WIDTH = 3


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


def doubles_in(path: Path, head: bytes) -> np.ndarray:
    content = path.read_bytes()
    assert content.startswith(head)
    return np.frombuffer(content[len(head) :]).reshape(-1, WIDTH)


@pytest.mark.parametrize("memory", [0, 2000, 10**9])
def test_rows_that_left_the_memory_come_into_a_file_that_is_named_later(tmp_path: Path, memory: int) -> None:
    first, second, third = chunks([50_000, 60, 7])
    store = RowStore(WIDTH, memory)
    store.append(first)
    store.append(second)
    before, path = store.table(), tmp_path / "rows"
    store.keep_in(path, b"head....")
    store.append(third)
    store.save()
    assert np.array_equal(doubles_in(path, b"head...."), np.vstack([first, second, third]))
    assert np.array_equal(store.table().whole(), np.vstack([first, second, third]))
    assert np.array_equal(before.whole(), np.vstack([first, second]))


def test_a_file_that_cannot_be_named_leaves_the_rows_where_they_are(tmp_path: Path) -> None:
    first, second = chunks([50, 60])
    store = RowStore(WIDTH, memory=0)
    store.append(first)
    with pytest.raises(RunError, match=r"cannot be kept in .*none: No such file or directory"):
        store.keep_in(tmp_path / "none" / "rows", b"head....")
    store.append(second)
    assert np.array_equal(store.table().whole(), np.vstack([first, second]))


@pytest.mark.parametrize("memory", [0, 10**9])
def test_a_file_that_somebody_removes_is_made_anew(memory: int, tmp_path: Path) -> None:
    first, second = chunks([50, 60])
    path = tmp_path / "rows"
    store = RowStore(WIDTH, memory)
    store.keep_in(path, b"head....")
    store.append(first)
    store.save()
    before = store.table()
    path.unlink()
    store.append(second)
    store.save()
    assert np.array_equal(np.frombuffer(path.read_bytes()[8:]).reshape(-1, WIDTH), np.vstack([first, second]))
    assert np.array_equal(store.table().whole(), np.vstack([first, second]))
    assert np.array_equal(before.whole(), first)


@pytest.mark.parametrize("there", [True, False])
def test_where_a_file_cannot_be_made_anew_no_row_is_lost(there: bool, tmp_path: Path) -> None:
    """Its folder is gone, or another one is in its place."""
    first, second = chunks([50, 60])
    (tmp_path / "folder").mkdir()
    store = RowStore(WIDTH, memory=0)
    store.keep_in(tmp_path / "folder" / "rows", b"head....", there=lambda: there)
    store.append(first)
    (tmp_path / "folder").rename(tmp_path / "moved")
    if not there:
        (tmp_path / "folder").mkdir()
    store.append(second)
    assert np.array_equal(store.table().whole(), np.vstack([first, second]))
    assert there or list((tmp_path / "folder").iterdir()) == []


def test_a_head_without_room_leaves_no_file(tmp_path: Path) -> None:
    with small_disk(tmp_path / "disk", 1) as disk:
        store = RowStore(WIDTH)
        store.keep_in(disk / "rows", b"h" * 100_000)
        store.append(chunks([5])[0])
        with pytest.raises(RunError, match="No space left on device: make room on the disk"):
            store.save()
        assert list(disk.iterdir()) == []


@given(
    st.floats(-10.0, 10.0),
    st.floats(1e-3, 1.0),
    st.integers(0, 50),
    st.integers(-60, 60),
    st.integers(-60, 60),
)
def test_the_times_of_a_grid_are_counted(
    start: float, step: float, count: int, first: int, stop: int
) -> None:
    clock = Clock.counted(start, step, 50)
    grid = Grid(clock, count)
    expected = np.array([clock.at(k) for k in range(count)])
    assert len(grid) == count
    assert np.array_equal(grid[:], expected)
    assert np.array_equal(grid[first:stop], expected[first:stop])
    assert np.array_equal(grid[first:stop:3], expected[first:stop:3])


@pytest.mark.parametrize("memory", [0, 10**9])
def test_a_table_of_either_kind_is_a_table(memory: int) -> None:
    store = RowStore(WIDTH, memory)
    assert store.table().shape == (0, WIDTH)
    store.append(np.empty((0, WIDTH)))
    assert len(store) == 0
    (rows,) = chunks([3])
    store.append(rows)
    assert isinstance(store.table(), Table)
    assert isinstance(store.table(), MemoryTable) is (memory > 0)


def test_rows_of_an_array_are_views_of_it() -> None:
    (rows,) = chunks([9])
    table = MemoryTable(rows)
    for view in (table.rows(2, 5), table.column(1), table.whole()):
        assert np.shares_memory(view, rows)
    assert not np.shares_memory(table.part(0, 9, [0]), rows)
