"""The folder of a run: one living run has it, and the files that stand in it are of one run.

From its begin on run.json says "running"; the last thing that a run does is to say how it ended. Where
run.json says "running" and nobody has the lock, the run was killed: what it had saved is in results.rows, and
`recover` makes results.csv of it.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import math
import os
import socket
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..csv_numbers import CsvFile
from ..csv_text import cut_row
from ..errors import ConfigError, RunError, counted
from ..file_names import check_name
from ..leftovers import keep_folder, temporary
from ..writing import reason, remove_drafts
from .folder_lock import KEPT_IN, MANIFEST_NAME, FolderLock, manifest_is_cut, manifest_of
from .manifest import manifest_text, overwrite_manifest, read_manifest, write_manifest
from .results import CSV_NAME, ROWS, Results
from .rows_file import ROWS_NAME, has_no_row
from .rows_file import read as read_rows
from .text_rows import TEXT_ROWS_NAME
from .text_table import texts_path
from .variable import ResultVariable

FIGURES = ("figure.png", "figure.svg")
REPORT = "report.html"
CAN_LOGS = ("can.log", "can.asc", "can.blf", "can.mf4", "can.pcapng")
_LOOKED_AT = 65536  # rows at the end
_SPARE = 4096  # bytes of run.json for how the run ended, which a full disk has no room for
_SETTINGS = ("system", "scenario", "settings", "experiment", "ideal", "order", "units", "buses")
FILES = (CSV_NAME, texts_path(Path(CSV_NAME)).name, MANIFEST_NAME, *FIGURES, REPORT, *CAN_LOGS)
"""The files of a run that has ended."""
UNWRITTEN = "unwritten"
"""The key of run.json for the reason why there is no results.csv."""


class RunFolder(FolderLock):
    """The locked folder of a run, with its files from the begin to the end."""

    saver: Callable[[], int] | None = None
    """Saves the rows of the run up to now at once, in any thread, and returns their number."""

    spare: Callable[[Path], int] | None = None
    """Saves all these rows in another folder. Raises OSError or ConfigError."""
    head: bytes = b""
    """The begin of the file of the rows, once the run has begun."""
    process: Mapping[str, Any] = {}
    """The process that has the folder, as run.json names it, once the run has begun."""
    remark: str = ""
    """A sentence about what befell the folder while the run went on; "": nothing."""

    def rescue(self, error: str = "") -> str:
        """Save the rows of a process that ends at once, and return what to say of them.

        run.json says that the run failed with an error, or was interrupted ("").
        """
        if (self.path / CSV_NAME).exists():
            return f"; results.csv is in {self.path}"
        count, lost = self._save_now()
        facts: dict[str, Any] = {"status": "failed", "error": error} if error else {"status": "interrupted"}
        facts |= {"steps": count}
        if lost and (spared := self._spare(count, facts)):
            return f"; {spared}{lost}"
        self.note(facts)
        if count and error and not lost and (found := self.recover()) is not None:  # no one waits for the end
            return f"; {len(found)} rows are in {self.path / CSV_NAME}"
        if not count:
            return f"; no row was saved in {self.path}{lost}"
        recover = f"evcosim results recover {self.path}"
        return f"; {count} rows are in {self.rows}, and {recover} makes results.csv of them{lost}"

    def _save_now(self) -> tuple[int, str]:
        """Save the rows up to now; return the number of those that are saved, and why the others are not."""
        if not self.is_there:
            return 0, f": {self.path} was removed or renamed"
        try:
            count = self.saver() if self.saver is not None else 0
        except RunError as refused:
            return self.count_rows(), f": {refused}"
        return (count, "") if self.rows.exists() or not count else (0, f": {self.rows} was removed")

    def _spare(self, count: int, facts: dict[str, Any]) -> str:
        """Save the rows where temporary files are, if more than `count` fit there; return a clause on it."""
        if self.spare is None:
            return ""
        try:
            with temporary() as place:
                more = self.spare(place)
                if more <= count:
                    return ""
                kept = keep_folder(place, "results")
        except (OSError, ConfigError):
            return ""
        about, variables = read_manifest(self.path / MANIFEST_NAME)
        with contextlib.suppress(ConfigError):
            write_manifest(kept / MANIFEST_NAME, about | facts | {"steps": more}, variables.values())
        self.note({**facts, KEPT_IN: str(kept)})
        return f"{more} rows are in {kept}, and evcosim results recover {kept} makes results.csv of them"

    def note(self, facts: Mapping[str, Any]) -> str:
        """Let run.json say more of a run whose results are not there. Return why it cannot; "": it does."""
        path = self.path / MANIFEST_NAME
        try:
            manifest, variables = read_manifest(path)
            about = {**manifest, **facts}
            try:
                write_manifest(path, about, variables.values())
            except ConfigError:
                overwrite_manifest(path, about, variables.values())
        except ConfigError as error:
            return str(error)
        except OSError as error:
            return f"{path}: cannot be written: {reason(path, error)}"
        return ""

    def count_rows(self) -> int:
        """Return the number of whole rows that were saved."""
        try:
            return len(read_rows(self.rows).time)
        except ConfigError:
            return 0

    def __fspath__(self) -> str:
        return os.fspath(self.path)

    @property
    def rows(self) -> Path:
        """The file of the rows while the run lives."""
        return self.path / ROWS_NAME

    @property
    def text_rows(self) -> Path:
        """The file of their texts."""
        return self.path / TEXT_ROWS_NAME

    def begin(self, manifest: Mapping[str, Any], variables: Iterable[ResultVariable]) -> None:
        """Remove the files of an earlier run, and let run.json say that this one is running.

        Raises ConfigError with the reason where that is impossible.
        """
        try:
            for name in (*FILES, ROWS_NAME, TEXT_ROWS_NAME):
                (self.path / name).unlink(missing_ok=True)
        except OSError as error:
            said = f"{error.strerror}: {error.filename}"
            raise ConfigError(f"output folder {self.path}: cannot be written: {said}") from error
        remove_drafts(self.path)
        now = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
        self.process = {"id": os.getpid(), "host": socket.gethostname(), "since": now}
        about = {**manifest, "status": "running", "process": self.process}
        write_manifest(self.path / MANIFEST_NAME, about, variables, spare=_SPARE)

    def finish(self, results: Results) -> None:
        """Write results.csv, its texts and run.json, then remove the rows.

        Raises ConfigError where a disk refuses.
        """
        results.write(self.path)
        self.discard_rows()

    def discard_rows(self) -> None:
        """Remove the files of the rows and their texts, which other files hold now."""
        for path in (self.rows, self.text_rows):
            with contextlib.suppress(OSError):  # Windows removes no file that is open: the next run does
                path.unlink(missing_ok=True)

    @property
    def was_killed(self) -> bool:
        """True where run.json says that a run is going on: this process has the lock, so that it is gone.

        So it is where only a part of run.json is left.
        """
        return manifest_of(self.path).get("status") == "running" or manifest_is_cut(self.path)

    @property
    def has_rows(self) -> bool:
        """True where rows are there, as results or as they were saved."""
        return (self.rows.exists() and not has_no_row(self.rows)) or (self.path / CSV_NAME).exists()

    def recover(self) -> Results | None:
        """Make results.csv of the rows of a killed run, and return the results; None: there are no such rows.

        A results.csv that was cut off within its last row goes without that, and of one that lacks rows those
        are kept that are left. Raises ConfigError where a file cannot be read or written.
        """
        killed = self.was_killed
        if has_no_row(self.rows):
            self.discard_rows()
        cut = self.has_rows and manifest_is_cut(self.path)
        if cut:
            self._put_manifest_aside()
        if not self.rows.exists() and self._drop_missing_rows():
            results = Results.read(self.path)
            results.manifest["status"] = "cut off"
            self.finish(results)
            return results
        if not self.rows.exists() and not (killed and self.has_rows):
            return None
        if not killed and (self.path / CSV_NAME).exists():  # it was killed after its last word
            self.discard_rows()
            return None
        results = Results.read(self.path)
        results.manifest.pop(UNWRITTEN, None)
        if cut:
            results.manifest.setdefault("evcosim", "")  # of an unknown version
        if killed:
            results.manifest["status"] = "killed"
            _note_zeros(results)
        self.finish(results)
        remove_drafts(self.path)
        return results

    def _put_manifest_aside(self) -> None:
        """Give what is left of run.json another name: the rows say what they are."""
        path = self.path / MANIFEST_NAME
        try:
            path.replace(path.with_name(f"{MANIFEST_NAME}.cut"))
        except OSError as error:
            raise ConfigError(f"{path}: cannot be renamed: {reason(path, error)}") from error

    def _drop_missing_rows(self) -> bool:
        """Let run.json know of no more rows than results.csv has; return True if it did."""
        wanted = manifest_of(self.path).get(ROWS)
        if not (self._drop_cut_row() or (isinstance(wanted, int) and self._count_rows() < wanted)):
            return False
        if wanted is not None:
            about, variables = read_manifest(self.path / MANIFEST_NAME)
            del about[ROWS]
            write_manifest(self.path / MANIFEST_NAME, about, variables.values())
        return True

    def _count_rows(self) -> float:
        """Return the number of rows of results.csv; infinity where it is not there, or is none of ours."""
        try:
            file = CsvFile.of(self.path / CSV_NAME)
            file.time_column()
            return file.count_lines()
        except (ConfigError, OSError):
            return math.inf

    def _drop_cut_row(self) -> bool:
        """Leave out the last row of results.csv where it does not end; return True if it does not."""
        path = self.path / CSV_NAME
        if not path.is_file() or path.is_symlink():
            return False
        try:
            row = cut_row(path)
            if row is not None:
                os.truncate(path, row.begin)
        except OSError as error:
            raise ConfigError(f"{path}: cannot be mended: {reason(path, error)}") from error
        return row is not None

    def foreign_files(self) -> list[str]:
        """Return the names of the files in it that no run wrote: they are somebody's own."""
        return foreign_files(self.path)

    def is_of_another(self, manifest: Mapping[str, Any]) -> bool:
        """Return True where the rows of a run of other files, FMUs or settings are there."""
        other = manifest_of(self.path)
        told = any(key in other for key in _SETTINGS)  # nobody knows of results alone what they are of
        return self.has_rows and not (told and same_settings(manifest, other))

    def check(self, manifest: Mapping[str, Any]) -> None:
        """Raise ConfigError where a run would replace files of somebody's own, or results of another run."""
        if foreign := self.foreign_files():
            raise ConfigError(self.refusal(foreign))
        if self.is_of_another(manifest):
            raise ConfigError(
                f"output folder {self.path}: it has the results of a run of other files, FMUs or settings"
            )

    def refusal(self, foreign: Sequence[str]) -> str:
        """Return the message for files of somebody's own."""
        return (
            f"output folder {self.path}: {', '.join(foreign)} would be replaced, but no {MANIFEST_NAME} says "
            "that a run wrote it"
        )


def _note_zeros(results: Results) -> None:
    """Warn of rows of zeros alone at the end of a killed run's, behind others: the disk may lack them."""
    for _, values in results.pieces(results.names, max(0, len(results) - _LOOKED_AT), rows=_LOOKED_AT):
        zeros = len(values) - int(np.flatnonzero(values.any(axis=1)).max(initial=-1)) - 1
        if not 0 < zeros < len(values):
            continue
        if isinstance(warnings := results.manifest.setdefault("warnings", []), list):
            warnings.append(
                f"the last {counted(zeros, 'row')} hold zeros alone: after a power cut that may be what the "
                "disk had not written yet"
            )


def recover(folder: Path) -> Results | None:
    """Make results.csv of what a killed run had saved in a folder, and let run.json say that it was killed.

    A results.csv that was cut off is mended. Return the results; None where there is nothing to do. Raises
    ConfigError for a run that lives, for one that had saved nothing, and for a folder that is none or cannot
    be written.
    """
    check_name(folder)
    if not folder.is_dir():
        raise ConfigError(f"{folder}: there is no such folder")
    with RunFolder(folder) as locked:
        if locked.was_killed and not locked.has_rows:
            raise ConfigError(f"{folder}: the run was killed before it had saved any rows; run it again")
        return locked.recover()


def foreign_files(folder: Path) -> list[str]:
    """Return the names of files that a run would replace in a folder, and that no run wrote."""
    taken = [name for name in FILES if os.path.lexists(folder / name)]
    return [] if "evcosim" in manifest_of(folder) or manifest_is_cut(folder) else taken


def same_settings(manifest: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Return True if two manifests are of runs with the same files, FMUs and settings.

    What the run.json of an earlier evcosim does not have is not compared.
    """
    keys = [key for key in _SETTINGS if key in manifest and key in other]
    one, two = (manifest_text({key: each[key] for key in keys}, indent=None) for each in (manifest, other))
    return bool(json.loads(one) == json.loads(two))
