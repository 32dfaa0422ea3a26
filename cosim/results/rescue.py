"""The end of a run whose folder takes no results.csv, as on a full disk: what was computed is kept, and said.

The rows are completed in results.rows, which takes less room. Where that does not take them all, they are
written where temporary files are. run.json says in either case how the run ended, and why there is no
results.csv.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import ConfigError, RunError
from ..leftovers import keep_folder, temporary
from ..row_store import Array
from ..shortage import of_temporary_files
from .folder_lock import KEPT_IN, MANIFEST_NAME
from .manifest import write_manifest
from .results import CSV_NAME, ROWS, Results
from .rows_file import ROWS_NAME, complete
from .run_folder import UNWRITTEN, RunFolder
from .text_rows import TEXT_ROWS_NAME, complete_texts

_PIECE = 4096  # rows that are written at a time
_GOOD = ("done", "ended", "stopped")  # the status of runs that did what was asked for


def finish(folder: RunFolder, results: Results) -> None:
    """Write results.csv, its texts and run.json of a run at its end, and remove its rows.

    Raises RunError where the disk refuses: it says what is kept where, and how to go on. The manifest of the
    results has the status "failed" and the error then, unless all rows are in the folder.
    """
    try:
        if not folder.is_there:
            _come_back(folder, results)
    except ConfigError as error:
        raise RunError(f"{error}\n{_elsewhere(folder, results, 0)[1]}") from error
    try:
        folder.finish(results)
    except ConfigError as error:
        said = str(error)
        if (folder.path / CSV_NAME).exists():  # all but run.json: without the rows there is room for it
            folder.discard_rows()
            if not (refused := _note_end(folder, results, {ROWS: len(results)})):
                return
            raise RunError(f"{said}\n{refused}") from error
        raise RunError("\n".join([said, *_rescued(folder, results, said)])) from error


def _come_back(folder: RunFolder, results: Results) -> None:
    """Make a folder anew that was removed or renamed. Raises ConfigError where there is another one."""
    folder.take_again()
    if folder.has_rows or folder.foreign_files():
        raise ConfigError(f"output folder {folder.path}: while the run went on, another one took its place")
    folder.remark = f"{folder.path} was removed or renamed while the run went on, and was made anew"
    if isinstance(warnings := results.manifest.get("warnings"), list):
        warnings.append(folder.remark)


def _rescued(folder: RunFolder, results: Results, said: str) -> list[str]:
    """Keep the results of a folder that takes no results.csv, and return sentences about them."""
    count = _complete_rows(folder.path, folder.head, results)
    recover = f"`evcosim results recover {folder.path}` makes results.csv of them once it can be written"
    if count == len(results):
        refused = _note_end(folder, results, {ROWS: count, UNWRITTEN: said})
        rows = f"all {count} rows are in {folder.rows}, which `evcosim plot` and `compare` read; {recover}"
        return [rows, *([refused] if refused else [])]
    if results.manifest.get("status") in _GOOD:
        results.manifest |= {"status": "failed", "error": said}
    place, sentence = _elsewhere(folder, results, count)
    sentences = [sentence]
    if count:
        until = f"up to t = {results.times(count - 1, count)[0]:.6g} s"
        sentences += [f"{count} of {len(results)} rows, {until}, are in {folder.rows}; {recover}"]
    facts = _ending(results) | {UNWRITTEN: said}
    refused = folder.note(facts if place is None else facts | {KEPT_IN: str(place)})
    return [*sentences, *([refused] if refused else [])]


def _complete_rows(folder: Path, head: bytes, results: Results) -> int:
    """Write the rows of a run that its folder does not have, and return the number that it has then."""
    path, columns = folder / ROWS_NAME, results.names

    def rows(first: int) -> Iterator[Array]:
        for _, values in results.pieces(columns, first, rows=_PIECE):
            yield values

    try:
        whole = complete_texts(folder / TEXT_ROWS_NAME, results.text_table)
    except ConfigError:  # somebody else's
        whole = False
    if not head or not (whole or path.exists()):
        return 0
    return complete(path, head, len(columns), rows if whole else lambda first: ())  # no row without its texts


def _note_end(folder: RunFolder, results: Results, more: dict[str, Any]) -> str:
    """Write run.json of the whole run, or what fits of it. Return why that is impossible; "": it is not."""
    try:
        variables = [*results.variables, *results.text_table.variables]
        write_manifest(folder.path / MANIFEST_NAME, {**results.manifest, **more}, variables)
    except ConfigError:
        return folder.note(_ending(results) | more)
    return ""


def _ending(results: Results) -> dict[str, Any]:
    """Return of a manifest how the run ended."""
    keys = ("status", "error", "steps", "ended")
    return {key: results.manifest[key] for key in keys if key in results.manifest}


def _elsewhere(folder: RunFolder, results: Results, count: int) -> tuple[Path | None, str]:
    """Keep results where temporary files are, as rows if there are more than `count` that fit.

    Their run.json names the process as that of the run's `folder` does, which may not take another word.
    Return the folder of the results (None: there is none) and a sentence about it.
    """
    results.manifest["process"] = folder.process
    try:
        with temporary() as place:
            try:
                results.write(place)
            except ConfigError as error:
                said = f"nor can they be kept elsewhere: {error}"
                rows = _complete_rows(place, folder.head, results)
                if rows <= count:
                    return None, said
                with contextlib.suppress(ConfigError):  # the rows read without it
                    write_manifest(place / MANIFEST_NAME, results.manifest, results.variables)
                kept = keep_folder(place, "results")
                return kept, f"{said}\n{rows} of {len(results)} rows are in {kept / ROWS_NAME}"
            until = f" up to t = {results.span[1]:.6g} s" if len(results) else ""
            kept = keep_folder(place, "results")
            return kept, f"the results{until} are kept in {kept}"
    except OSError as error:
        return None, f"nor can they be kept elsewhere: {of_temporary_files(error)}"
