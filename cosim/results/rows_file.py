"""The rows of a run while it lives, of which any prefix reads: results.rows in the folder of the run.

A line of JSON says what the run is and what the columns are; the rows follow from a multiple of 8 bytes on,
each number a double in the byte order of the machine. Row k is that of communication point k. The file is
removed when results.csv is written, so that one that stands there without a living run is of a run that was
killed, or that found no room for results.csv.
"""

from __future__ import annotations

import contextlib
import dataclasses
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..clock import WHOLE, Clock
from ..errors import ConfigError, short
from ..reading import require_file
from ..row_store import Array, Grid, Table, rows_in, write_all
from ..shortage import reason
from .manifest import described, from_json, manifest_text, variables_in
from .variable import ResultVariable

ROWS_NAME = "results.rows"
_FORMAT = "evcosim rows 1"
_BEGIN = f'{{"format": "{_FORMAT}", '.encode()
_LONGEST = 1 << 28  # bytes of the line


def file_of_run(folder: Path, whole: str) -> Path:
    """Return the file with the rows of a run's folder: that of the `whole` run, or results.rows.

    Raises ConfigError for a folder without either, naming those below it that have results.
    """
    path, rows = folder / whole, folder / ROWS_NAME
    for there in (path, rows):
        if os.path.lexists(there):  # a link to nothing is named where it is read
            return there
    below = sorted(f.parent for pattern in ("*", "*/*") for f in folder.glob(f"{pattern}/{whole}"))
    known = f"; it has {', '.join(map(str, below[:5]))}" if below else ""
    raise ConfigError(f"{folder}: is a folder without results of a run ({whole}){known}")


def head(clock: Clock, variables: Sequence[ResultVariable], manifest: Mapping[str, Any]) -> bytes:
    """Return the begin of the file of a run whose rows are at the times of a clock."""
    about = {
        "format": _FORMAT,
        "byteorder": sys.byteorder,
        "clock": dataclasses.asdict(clock),
        "variables": [described(v) for v in variables],
        "manifest": manifest,
    }
    line = manifest_text(about, indent=None)
    return line + b" " * (-(len(line) + 1) % 8) + b"\n"


def has_no_row(path: Path) -> bool:
    """Return True for a file of rows whose first line is not whole: the process ended while it wrote that.

    A power cut may leave zeros in place of what was written.
    """
    try:
        if path.is_symlink() or not path.is_file():
            return False
        with path.open("rb") as file:
            return _is_cut_head(file.readline(_LONGEST))
    except OSError:
        return False


def _is_cut_head(line: bytes) -> bool:
    text = line.rstrip(b"\0")
    return not line.endswith(b"\n") and (text.startswith(_BEGIN) or _BEGIN.startswith(text))


def complete(path: Path, begin: bytes, width: int, rows: Callable[[int], Iterable[Array]]) -> int:
    """Append the rows of a run that its file does not have, as many as the disk takes.

    The file is made with `begin` (`head`) where there is none. `rows` gives arrays of the rows from a number
    on, each of shape (n, width). Return the number of whole rows that the file has then; 0 where none can be
    kept, or where another file is in its place.
    """
    width = width or 1  # a row without numbers stands there as one
    try:
        if not os.path.lexists(path):
            _make(path, begin)
        with path.open("r+b", buffering=0) as file:
            if path.is_symlink() or (line := file.readline(_LONGEST)) != begin:
                return 0
            first = _rows(file, len(line), width)
            file.seek(len(line) + 8 * width * first)
            with contextlib.suppress(OSError):  # it is full: the rows that it took are counted
                for piece in rows(first):
                    numbers = np.ascontiguousarray(piece) if piece.size else np.zeros((len(piece), 1))
                    write_all(file, numbers.data.cast("B"))
            return _rows(file, len(line), width)
    except OSError:
        return 0


def _make(path: Path, begin: bytes) -> None:
    """Make a file without rows. Raises OSError; then there is none."""
    with path.open("xb", buffering=0) as file:  # exclusively: it follows no link
        try:
            write_all(file, memoryview(begin))
        except OSError:
            path.unlink()
            raise


def _rows(file: BinaryIO, offset: int, width: int) -> int:
    return max(0, os.fstat(file.fileno()).st_size - offset) // (8 * width)


@dataclasses.dataclass(frozen=True)
class SavedRows:
    """The contents of such a file: n rows, `data` of shape (n, m), which stay in the file."""

    time: Grid
    data: Table
    variables: list[ResultVariable]
    manifest: dict[str, Any]


def read(path: Path) -> SavedRows:
    """Read what there is of a file of rows; half a row at its end counts for nothing.

    Raises ConfigError naming a file that cannot be read, does not begin as one, or was left without a row.
    """
    require_file(path)
    try:
        with path.open("rb") as file:
            line = file.readline(_LONGEST)
        if _is_cut_head(line):
            raise ConfigError(f"{path}: no row was saved in it: the run ended before that; run it again")
        about = from_json(line) if line.endswith(b"\n") else None
        if not isinstance(about, dict) or about.get("format") != _FORMAT:
            raise ConfigError(f"{path}: does not begin as a file of rows ({_FORMAT})")
        if about["byteorder"] != sys.byteorder:
            raise ConfigError(f"{path}: was written on a machine of the other byte order")
        variables = list(variables_in(about["variables"], path).values())
        clock, manifest = _clock(about["clock"]), dict(about["manifest"])
        data = rows_in(path, len(line), len(variables))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {reason(error)}") from error
    except (ValueError, TypeError, KeyError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"{path}: its first line does not describe rows: {error}") from error
    return SavedRows(Grid(clock, data.shape[0]), data, variables, manifest)


def _clock(about: Mapping[str, Any]) -> Clock:
    """Return a clock of its numbers. Raises TypeError or ValueError for values that make none."""
    clock = Clock(**about)
    for name, value in dataclasses.asdict(clock).items():
        if name in ("decimal", "told"):
            good = isinstance(value, bool)
        else:
            good = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= WHOLE
        least = {"step": 0, "advance": 0, "divisor": 1}.get(name)
        if not good or (least is not None and not value >= least):
            raise ValueError(f"clock.{name} = {short(value)}")
    if not isinstance(clock.steps, int) or clock.steps < 0:
        raise ValueError(f"clock.steps = {short(clock.steps)}")
    return clock
