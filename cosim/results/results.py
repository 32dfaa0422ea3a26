"""Results of a run: one row for each communication point, one column for each recorded variable.

A folder of results holds results.csv with the rows, and run.json with what a CSV file has no place for: units
of measure, types, texts, the manifest. A file alone is written and read in the format that its suffix names
(`formats.suffixes`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ConfigError, nearest
from ..file_names import check_name
from ..row_store import Array, Grid, MemoryTable, Table, check_times
from ..writing import replacing
from . import frames
from .folder_lock import MANIFEST_NAME, manifest_is_cut, status
from .formats.format import Format
from .formats.suffixes import CSV, format_of, reader_of
from .manifest import check_whole, read_manifest, write_manifest
from .rows_file import ROWS_NAME, file_of_run
from .rows_file import read as read_rows
from .text_rows import TEXT_ROWS_NAME, read_text_rows
from .text_table import TextTable, read_texts, write_texts
from .variable import ResultVariable

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

    from ..errors import Recorded
    from ..interface import Value
    from ..system.figure_spec import FigureSpec
    from ..system.metric_spec import MetricSpec
    from .metrics import Metrics

__all__ = ["CSV_NAME", "MANIFEST_NAME", "PIECE", "ResultVariable", "Results"]

CSV_NAME = "results.csv"
ROWS = "rows"
"""The key of run.json for the number of rows of results.csv."""

_CHECKED = 4096  # rows that are looked at at a time before they are written
PIECE = 2**16  # rows that `pieces` gives at a time: half a megabyte for each variable


class Results:
    """The recording of a run: n rows of m variables.

    `time` [s], shape (n,), and `data`, shape (n, m), hold row k of communication point k; `variables`
    describes the m columns. `results["vehicle.speed"]` is one column, `len(results)` is n.
    `data` may be given as a Table that is not in memory, and `time` as a Grid: then `results.data` and
    `results.time` make all of it, while `pieces`, a column or `part` take no more than they return.
    `manifest` is what run.json says of the run; `figure` and `metric_specs` are those of its system and
    scenario (None and none for results that were read from a file).

    Variables of type String stand in a table of their own: `texts` has their names, `results["a.s"]` the
    texts of one of them.

    The times of a run are those of its clock: 0.07 s where 7 * 0.01 is 0.07000000000000001. Times that are
    given as an array are kept as they are.
    """

    def __init__(
        self,
        time: ArrayLike | Grid,
        data: ArrayLike | Table,
        variables: Sequence[ResultVariable],
        manifest: Mapping[str, Any] | None = None,
        figure: FigureSpec | None = None,
        metrics: Sequence[MetricSpec] = (),
        texts: TextTable | None = None,
    ) -> None:
        self._grid = time if isinstance(time, Grid) else None
        self._time: Array | None = None
        if not isinstance(time, Grid):
            self._time = np.array(time, dtype=np.float64, ndmin=1)
            check_times(self._time)
        self._table: Table = data if isinstance(data, Table) else _table(data)
        self.variables = tuple(variables)
        self.manifest: dict[str, Any] = dict(manifest or {})
        self.text_table = texts or TextTable()
        self.figure = figure
        self.metric_specs = tuple(metrics)
        count = len(time) if isinstance(time, Grid) else len(self.time)
        if self._table.shape != (count, len(self.variables)):
            raise ValueError(
                f"data is {self._table.shape}, {count} times and {len(self.variables)} variables "
                f"need {(count, len(self.variables))}"
            )
        self._columns = {v.name: j for j, v in enumerate(self.variables)}
        names = [*self._columns, *self.texts]
        if len(self._columns) != len(self.variables) or "time" in names or len(set(names)) < len(names):
            raise ValueError("the names of the variables must differ from each other and from 'time'")

    @property
    def time(self) -> Array:
        """All times [s], shape (n,), in memory."""
        if self._time is None:
            starts = range(0, max(1, len(self)), PIECE)
            self._time = np.concatenate([self.times(start, start + PIECE) for start in starts])
        return self._time

    def times(self, start: int, stop: int) -> Array:
        """Return the times [s] of the rows from `start` to before `stop`, or to the end, shape (n,)."""
        if self._time is not None:
            return self._time[start:stop]
        assert self._grid is not None  # one of the two was given
        return self._grid[start:stop]

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time [s]. Raises IndexError without a row."""
        last = max(0, len(self) - 1)
        return float(self.times(0, 1)[0]), float(self.times(last, last + 1)[0])

    @property
    def data(self) -> Array:
        """All values, shape (n, m), in memory."""
        return self._table.whole()

    def pieces(
        self, names: Sequence[str], first: int = 0, overlap: int = 0, rows: int | None = None
    ) -> Iterator[tuple[Array, Array]]:
        """Yield times [s], shape (n,), and values, shape (n, len(names)), from row `first` on.

        A piece has `rows` rows (default: PIECE); before them each but the first repeats the last `overlap`
        rows of the piece before. Raises ConfigError as `variable` does.
        """
        rows = rows or PIECE
        columns = [self._columns[self.variable(name).name] for name in names]
        for start in range(first, len(self), rows):
            begin = max(first, start - overlap)
            yield self.times(begin, start + rows), self._table.part(begin, start + rows, columns)

    def __len__(self) -> int:
        return self._table.shape[0]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._columns or name in self.texts

    @property
    def texts(self) -> tuple[str, ...]:
        """The names of the variables of type String."""
        return self.text_table.names

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the values of a variable, shape (n,): float64, int64 (Integer, Enumeration), bool, or str as
        objects; float64, too, for integers of which one is beyond an int64, as an UInt64 can be.

        `time` is accepted as a name. Raises ConfigError naming the nearest variable there is.
        """
        if name == "time":
            return self.time
        if name in self.texts:
            return self.text_table.column(name, len(self))
        column = self.column(name)
        kind = self.variable(name).type
        if kind == "Real":
            return column
        if kind == "Boolean":
            return column.astype(np.bool_)
        return column.astype(np.int64) if np.all(np.abs(column) < 2.0**63) else column.copy()

    def __repr__(self) -> str:
        span = "{:g} to {:g} s".format(*self.span) if len(self) else "no time"
        return f"<Results: {len(self.variables)} variables, {len(self)} communication points, {span}>"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the variables, in column order."""
        return tuple(v.name for v in self.variables)

    @property
    def units(self) -> dict[str, str]:
        """The unit of measure of each variable ("" where none is known)."""
        return {v.name: v.unit for v in self.variables}

    def variable(self, name: str) -> ResultVariable:
        """Return the description of a variable. Raises ConfigError naming the nearest one there is."""
        if name in self.texts:
            raise ConfigError(f"{name} is a String, which has no numbers")
        if name not in self._columns:
            raise ConfigError(f"the results have no variable '{name}'{nearest(name, self.names)}")
        return self.variables[self._columns[name]]

    def column(self, name: str) -> Array:
        """Return the values of a variable as float64, whatever its type, shape (n,): a view if in memory."""
        self.variable(name)
        return self._table.column(self._columns[name])

    def final(self) -> dict[str, Value]:
        """Return the last value of each variable, as the type that it has, then the texts.

        Nothing without a row.
        """
        if not len(self):
            return {}
        last = self._table.rows(len(self) - 1, len(self))[0].tolist()
        kinds = {"Real": float, "Boolean": bool}
        numbers = {v.name: kinds.get(v.type, int)(x) for v, x in zip(self.variables, last, strict=True)}
        return numbers | dict(zip(self.texts, self.text_table.final(), strict=False))

    def part(self, rows: NDArray[np.bool_] | slice, names: Sequence[str]) -> Results:
        """Return the results of some rows and variables, in memory.

        `rows` is a slice, or a choice of shape (n,); `names` may be those of texts too. Raises ConfigError as
        `variable` does.
        """
        texts = self.text_table.part(rows, [name for name in names if name in self.texts], len(self))
        names = [name for name in names if name not in self.texts]
        variables = [self.variable(name) for name in names]
        if isinstance(rows, slice) and rows.step is None:
            start, stop, _ = rows.indices(len(self))
            data = self._table.part(start, stop, [self._columns[name] for name in names])
            return Results(self.times(start, stop), data, variables, self.manifest, texts=texts)
        columns = [self.column(name)[rows] for name in names]
        time = self.time[rows]
        data = np.column_stack(columns) if columns else np.empty((len(time), 0))
        return Results(time, data, variables, self.manifest, texts=texts)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the rows into a file, in the format that its suffix names, as .csv does; texts beside it.

        Raises ConfigError for another suffix, for a value that is NaN or infinite, which no reader takes, and
        where the file cannot be written; then none is left.
        """
        path = Path(path)
        form = format_of(path)
        self._check_finite()
        return self._save(path, form)

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write the rows into a CSV file, whatever its suffix. Raises ConfigError as `save` does."""
        self._check_finite()
        return self._save(Path(path), CSV)

    def _check_finite(self) -> None:
        for times, values in self.pieces(self.names, rows=_CHECKED):
            good = np.isfinite(values)
            if not good.all():
                k, j = map(int, np.argwhere(~good)[0])
                raise ConfigError(
                    f"{self.names[j]} is {values[k, j]} at t = {times[k]:.6g} s: a file of results holds "
                    "finite numbers; leave such rows or variables out with `part`"
                )

    def _save(self, path: Path, form: Format) -> Path:
        check_name(path, "cannot be written: ")
        # the texts first: where the rows of a run stand, its texts do
        write_texts(path, self.text_table, self.time if self.texts else np.empty(0))
        with replacing(path) as file:
            form.write(self, file)
        return path

    def write(self, folder: str | os.PathLike[str]) -> Path:
        """Write results.csv and run.json into a folder, which is made if needed, and texts beside as
        results.texts.csv.

        Numbers of the manifest that are not finite become null: JSON has no name for them.
        Raises ConfigError when a file cannot be written; then none is left under its name half-done.
        """
        folder = Path(folder)
        self._save(folder / CSV_NAME, CSV)  # whatever was computed: a run's last rows must not be lost
        described = [*self.variables, *self.text_table.variables]
        write_manifest(folder / MANIFEST_NAME, {**self.manifest, ROWS: len(self)}, described)
        return folder

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Results:
        """Read a results folder, its results.csv, or a file in a format that its suffix names.

        The folder of a run that lives, or was killed, has results.rows in place of results.csv: the rows that
        were saved are read, half a row at the end is left out. A .txt, .tsv or .dat file, or one without a
        suffix, is read as CSV: the time [s] is the column of such a name, and without a run.json beside
        results.csv every variable is a Real without a unit of measure. Raises ConfigError for another suffix,
        and naming file, line, column and value of what is not a number, or the last line that was cut off:
        in a file with the header that evcosim writes any last line that does not end, in others one that is
        not complete. So is a results.csv with fewer rows than its run.json says.
        """
        check_name(path)
        path = Path(path)
        if path.is_dir():
            path = file_of_run(path, CSV_NAME)
        if path.name == ROWS_NAME:
            return _of_rows(path)
        held = reader_of(path).read(path)
        manifest, variables = dict(held.manifest), list(held.variables)
        if path.name == CSV_NAME:
            manifest, known = read_manifest(path.with_name(MANIFEST_NAME))
            check_whole(path, len(held.time), manifest.pop(ROWS, 0))
            if "status" in manifest:
                manifest["status"] = status(path.parent, manifest)
            variables = [known.get(v.name, v) for v in variables]
        table = read_texts(path, held.time, [v.name for v in variables])
        if path.name == CSV_NAME:
            table = TextTable([known.get(v.name, v) for v in table.variables], table.changes)
        return cls(held.time, held.data, variables, manifest, texts=table)

    @property
    def metrics(self) -> Metrics:
        """The numbers that the run's system and scenario name; by place or name, as `metrics["distance"]`.

        `metrics()` is the same. Raises ConfigError for one whose variable is not recorded or whose unit of
        measure does not fit.
        """
        from . import metrics  # knows units of measure; reading and writing results does without

        return metrics.Metrics(metrics.evaluate(self, self.metric_specs))

    def to_dataframe(self, names: Sequence[str] | None = None) -> pandas.DataFrame:
        """Return the variables, or some of them, as a pandas.DataFrame over the time in s.

        `attrs["units"]` has the units of measure by column; enumerations are categories, named by their
        states. Raises ConfigError without pandas (`pip install pandas`) and as `variable` does.
        """
        return frames.to_dataframe(self, names)

    def to_xarray(self, names: Sequence[str] | None = None) -> xarray.Dataset:
        """Return the variables, or some of them, as an xarray.Dataset over the time in s.

        Each has its unit of measure as the attribute `units`; enumerations are numbers with `flag_values` and
        `flag_meanings`. Raises ConfigError without xarray (`pip install pandas`) and as `variable`.
        """
        return frames.to_xarray(self, names)

    def _repr_html_(self) -> str:
        from ..report.inline import shown  # knows figures, as `plot` does

        return shown(self)

    def plot(
        self,
        path: str | os.PathLike[str] | Sequence[str] | None = None,
        title: str | None = None,
        spec: FigureSpec | None = None,
        *,
        signals: str | Sequence[str] | None = None,
    ) -> Figure:
        """Draw the figure of the run's system, another `spec`, `signals`, or else all, grouped by quantity.

        It is written where a path (.png, .svg, .pdf) is given; a notebook shows it. Signals, a name or a
        list, may stand first, as in `plot(["vehicle.speed"])`. Raises ConfigError for what does not fit.
        """
        from ..figures import asked  # matplotlib: 0.5 s that only figures need

        return asked.plot(self, path, title, spec, signals)

    def report(self, path: str | os.PathLike[str], spec: FigureSpec | None = None) -> Path:
        """Write a page (.html) of the run, its curves, metrics and settings, that needs no network.

        The figure is that of the run's system, another `spec`, or else signals grouped by unit of measure.
        Raises ConfigError for a spec that does not fit, and where the file cannot be written.
        """
        from ..report.page import write_report  # knows figures and units of measure, as `plot` does

        write_report(Path(path), self, spec)
        return Path(path)


def _of_rows(path: Path) -> Results:
    """Read the rows that a run, which may have been killed, has saved up to now."""
    saved = read_rows(path)
    cut = manifest_is_cut(path.parent)  # the rows say what they are
    said: dict[str, Any] = {"status": "running"} if cut else read_manifest(path.with_name(MANIFEST_NAME))[0]
    if isinstance(said.get(ROWS), int) and len(saved.time) >= said.pop(ROWS):  # of the end of the run
        manifest = said
    else:
        manifest = saved.manifest | {key: said[key] for key in ("status", "error") if key in said}
        manifest |= {"steps": len(saved.time), "status": status(path.parent, manifest)}
        for counted_at_the_end in ("saturations", "loop_seconds"):
            manifest.pop(counted_at_the_end, None)
    texts = read_text_rows(path.with_name(TEXT_ROWS_NAME), len(saved.time))
    return Results(saved.time, saved.data, saved.variables, manifest, texts=texts)


def _table(data: ArrayLike) -> Table:
    array = np.asarray(data, dtype=np.float64)
    if array.ndim != 2:
        raise ValueError(f"data has {array.ndim} dimensions: rows and columns are needed")
    return MemoryTable(array)


if TYPE_CHECKING:

    def _is_recorded(results: Results) -> Recorded:
        return results  # mypy: an error's `results` offers what Recorded says
