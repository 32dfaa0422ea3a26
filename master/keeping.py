"""The folder of a run while it goes on, and at its end."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..cosim.errors import RunError
from ..cosim.plan.plan import Plan
from ..cosim.results import rows_file
from ..cosim.results.rescue import finish
from ..cosim.results.results import PIECE, Results
from ..cosim.results.rows_file import ROWS_NAME
from ..cosim.results.run_folder import RunFolder
from ..cosim.results.text_rows import TEXT_ROWS_NAME, TextRows
from .engine.engine import Engine
from .engine.row_keeper import RowKeeper


class KeptRun:
    """A run that has a folder: from now on its rows reach the disk within a second.

    `about` is the manifest at the begin. A folder that is given by its name is filled by `end`; one that the
    caller has locked, the caller fills. Raises ConfigError for a folder that another run has, that holds
    another one's results, or that cannot be written; RunError where the rows up to now cannot be copied.
    """

    def __init__(
        self, engine: Engine, plan: Plan, folder: str | os.PathLike[str], about: Mapping[str, Any]
    ) -> None:
        self.folder = folder if isinstance(folder, RunFolder) else RunFolder(Path(folder))
        self._fills = self.folder is not folder
        try:
            if self._fills:
                self.folder.check(about)
            self.folder.begin(about, (*plan.columns, *plan.text_columns))
            self.folder.head = rows_file.head(plan.clock, plan.columns, about)
            self._texts = TextRows(self.folder.text_rows, plan.text_columns, engine.text_notes.since)
            engine.store.keep_in(self.folder.rows, self.folder.head, self._save_texts, self._is_there)
            self._keeper = RowKeeper(engine)
            self.folder.saver, self.folder.spare = self._keeper.save_all, self._save_in
        except BaseException:
            if self._fills:
                self.folder.release()
            raise

    def _save_texts(self) -> None:
        if self._is_there():
            self._texts.save()

    def _save_in(self, place: Path) -> int:
        """Save all rows up to now in another folder, and return their number. Raises OSError."""
        self._texts.beside(place / TEXT_ROWS_NAME).save()
        table = self._keeper.rows()
        return rows_file.complete(
            place / ROWS_NAME,
            self.folder.head,
            table.shape[1],
            lambda first: (table.rows(k, k + PIECE) for k in range(first, table.shape[0], PIECE)),
        )

    def _is_there(self) -> bool:
        return self.folder.is_there

    @property
    def notice(self) -> str:
        """The reason why rows cannot be saved; "" while they can."""
        return self._keeper.notice

    def stop(self) -> None:
        """Save no more rows: the run has ended."""
        self._keeper.stop()

    def end(self, results: Results, error: BaseException | None) -> None:
        """Write results.csv and run.json, and give the folder free, if that is not the caller's.

        Raises RunError, which says what is kept where, where the disk refuses; the `error` of the run gets
        that as a note.
        """
        if not self._fills:
            return
        self._fills = False
        with self.folder:
            try:
                finish(self.folder, results)
            except RunError as unwritten:
                if error is None:
                    raise
                error.add_note(str(unwritten))


def ended(results: Results, finished: bool, error: BaseException | None) -> Results:
    """Return the results of a run at its end, whose manifest says how it ended: "done" at the stop time.

    A unit may have asked for the end before ("ended", with a sentence under this key), and a loop of one's
    own may leave it ("stopped").
    """
    manifest = results.manifest
    if isinstance(error, KeyboardInterrupt):
        manifest["status"] = "interrupted"
    elif error is not None:
        manifest["status"], manifest["error"] = "failed", str(error) or type(error).__name__
    elif "ended" in manifest:
        manifest["status"] = "ended"
    else:
        manifest["status"] = "done" if finished else "stopped"
    return results
