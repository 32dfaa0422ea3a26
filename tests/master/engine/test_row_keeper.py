"""Rows reach the disk while the engine steps, those of a step that takes long too."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np

from evcosim.cosim.row_store import RowStore
from evcosim.master.engine import row_keeper
from evcosim.master.engine.row_keeper import RowKeeper


class Engine:
    """A store of one column, and a chunk of rows under way."""

    def __init__(self, path: Path) -> None:
        self.store = RowStore(1)
        self.store.keep_in(path, b"head....")
        self.chunks, self.before, self.whole = 0, 0, True
        self.under_way = np.empty((0, 1))

    def rows_under_way(self) -> Any:
        return self.under_way.copy()


def kept(engine: Engine, monkeypatch: Any) -> RowKeeper:
    """A keeper whose looks the test does itself."""
    monkeypatch.setattr(row_keeper, "LOOK", 1e6)
    monkeypatch.setattr(row_keeper, "FIRST", 0.0)
    return RowKeeper(engine)  # type: ignore[arg-type] # the part of an engine that it looks at


def on_disk(path: Path) -> list[float]:
    return np.frombuffer(path.read_bytes()[8:]).tolist() if path.exists() else []


def rows(*values: float) -> Any:
    return np.array(values)[:, None]


def test_chunks_that_have_ended_are_saved(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "rows"
    engine = Engine(path)
    keeper = kept(engine, monkeypatch)
    keeper._look()
    assert not path.exists()
    engine.store.append(rows(0.0, 1.0))
    keeper._look()
    engine.store.append(rows(2.0))
    keeper._look()
    keeper._look()
    assert on_disk(path) == [0.0, 1.0, 2.0]
    keeper.stop()


def test_the_rows_before_a_step_that_takes_long_are_saved(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "rows"
    engine = Engine(path)
    keeper = kept(engine, monkeypatch)
    engine.store.append(rows(0.0))
    engine.chunks, engine.before, engine.whole, engine.under_way = 1, 1, False, rows(1.0, 2.0)
    keeper._look()
    assert on_disk(path) == [0.0]  # the chunk was not there at the look before
    engine.under_way = rows(1.0, 2.0, 3.0)
    keeper._look()
    assert on_disk(path) == [0.0, 1.0, 2.0]
    # it ends, and the next one is under way
    engine.store.append(rows(1.0, 2.0, 3.0, 4.0))
    engine.chunks, engine.before, engine.under_way = 2, 5, rows(5.0)
    keeper._look()
    assert on_disk(path) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert engine.store.table().whole()[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    keeper.stop()


def test_a_chunk_that_ends_meanwhile_is_saved_once(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "rows"
    engine = Engine(path)
    keeper = kept(engine, monkeypatch)
    engine.chunks, engine.whole, engine.under_way = 1, False, rows(0.0, 1.0)
    keeper._look()

    def ends() -> Any:
        found = engine.under_way.copy()
        engine.store.append(engine.under_way)
        return found

    engine.rows_under_way = ends  # type: ignore[method-assign] # the engine goes on between two lines
    keeper._look()
    assert on_disk(path) == [0.0, 1.0]
    keeper.stop()


def test_the_rows_of_a_chunk_that_has_failed_are_saved_once(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "rows"
    engine = Engine(path)
    keeper = kept(engine, monkeypatch)
    engine.chunks, engine.whole, engine.under_way = 1, False, rows(0.0, 1.0)
    keeper._look()
    engine.store.append(engine.under_way)  # the run has failed, and its units are being released
    keeper._look()
    assert keeper.save_all() == 2
    assert on_disk(path) == [0.0, 1.0]
    keeper.stop()


def test_a_short_run_writes_nothing(tmp_path: Path) -> None:
    engine = Engine(tmp_path / "rows")
    keeper = RowKeeper(engine)  # type: ignore[arg-type] # as above
    engine.store.append(rows(0.0))
    keeper._look()
    keeper.stop()
    assert list(tmp_path.iterdir()) == []


def test_the_thread_saves_by_itself_and_ends(tmp_path: Path, monkeypatch: Any) -> None:
    path = tmp_path / "rows"
    monkeypatch.setattr(row_keeper, "LOOK", 0.01)
    monkeypatch.setattr(row_keeper, "FIRST", 0.0)
    engine = Engine(path)
    engine.store.append(rows(0.0, 1.0))
    before = threading.active_count()
    keeper = RowKeeper(engine)  # type: ignore[arg-type] # as above
    while on_disk(path) != [0.0, 1.0]:
        time.sleep(0.01)
    keeper.stop()
    assert threading.active_count() == before


def test_a_disk_that_refuses_is_a_notice_while_it_does(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(row_keeper, "LOOK", 0.01)
    monkeypatch.setattr(row_keeper, "FIRST", 0.0)
    path = tmp_path / "none" / "rows"
    engine = Engine(path)
    engine.store.append(rows(0.0, 1.0))
    keeper = RowKeeper(engine)  # type: ignore[arg-type] # as above
    while not keeper.notice:
        time.sleep(0.01)
    assert "rows are not saved while it runs: what the run records cannot be kept in" in keeper.notice
    assert len(engine.store) == 2
    path.parent.mkdir()
    while keeper.notice:
        time.sleep(0.01)
    assert on_disk(path) == [0.0, 1.0]
    keeper.stop()


def test_without_a_thread_the_run_goes_on_with_a_notice(tmp_path: Path, monkeypatch: Any) -> None:
    def none(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    path = tmp_path / "rows"
    engine = Engine(path)
    with monkeypatch.context() as patched:
        patched.setattr(threading.Thread, "start", none)
        keeper = kept(engine, patched)
    assert keeper.notice.startswith("rows are not saved while it runs: no further thread can be started")
    engine.store.append(rows(1.0, 2.0))
    assert keeper.save_all() == 2  # as at a signal
    assert on_disk(path) == [1.0, 2.0]
    keeper.stop()
