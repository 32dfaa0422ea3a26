"""The thread that brings the rows of a run to the disk while it steps.

At a look every 0.3 s it saves the rows of the chunks that have ended, and those of a chunk that it saw under
way at the look before: a step that takes long, or never ends, holds no row back that was done before it. So a
row is on the disk within a second, and a run of less than a second writes none.
"""

from __future__ import annotations

import threading
import time

from ...cosim.errors import RunError
from ...cosim.row_store import Table
from ...cosim.shortage import no_thread
from .engine import Engine

LOOK = 0.3  # s
FIRST = 0.8  # s: the first rows are saved that long after the begin of the run


class RowKeeper:
    """A thread that saves an engine's rows until `stop`. It begins with the object.

    `notice` says why rows cannot be saved while the run goes on; "" while they can.
    """

    notice = ""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._begin = time.monotonic()
        self._chunk, self._done = -1, 0  # the chunk that was under way at the last look, and its rows then
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        thread = threading.Thread(target=self._watch, name="evcosim rows", daemon=True)
        try:
            thread.start()
            self._thread = thread
        except RuntimeError:  # the run needs no thread, and writes its rows at the end
            self.notice = f"rows are not saved while it runs: {no_thread()}"

    def stop(self) -> None:
        """End the thread."""
        self._over.set()
        if self._thread is not None:
            self._thread.join()

    def save_all(self) -> int:
        """Save the rows up to now, those of a chunk under way too, and return their number. Raises RunError.

        The process ends then, whatever its other threads are doing.
        """
        engine = self._engine
        before = engine.before
        rows = None if engine.whole else engine.rows_under_way()
        engine.store.save(rows, before)
        return max(before + (0 if rows is None else len(rows)), len(engine.store))

    def rows(self) -> Table:
        """Return the rows that `save_all` saves."""
        engine = self._engine
        before = engine.before
        rows = None if engine.whole else engine.rows_under_way()
        return engine.store.table(rows if len(engine.store) == before else None)

    def _watch(self) -> None:
        while not self._over.wait(LOOK):
            try:
                self._look()
                self.notice = ""
            except RunError as error:  # the run goes on, and keeps its rows in memory while they are few
                self.notice = f"rows are not saved while it runs: {error}"

    def _look(self) -> None:
        engine = self._engine
        # in this order: when the chunk has ended meanwhile, there are more rows in the store than `before`
        chunk, before = engine.chunks, engine.before
        rows = None if engine.whole else engine.rows_under_way()
        if time.monotonic() - self._begin >= FIRST:
            engine.store.save(None if rows is None or chunk != self._chunk else rows[: self._done], before)
        self._chunk, self._done = chunk, 0 if rows is None else len(rows)
