"""Results of a run: one row for each communication point, one column for each recorded variable.

results.csv has the header `time,unit.variable,...` and '\\n' line ends. A Real is written as the shortest
decimal that reads back as the same bits; Integer, Boolean (0, 1) and Enumeration as integers. What a CSV
file cannot hold (units of measure, types, texts, the manifest) is in run.json beside it.
"""

from __future__ import annotations

import csv
import dataclasses
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TextIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ConfigError, nearest
from ..row_store import Array, Grid, MemoryTable, Table
from ..writing import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..system.figure_spec import FigureSpec
    from ..system.metric_spec import MetricSpec
    from .metrics import Metric

CSV_NAME = "results.csv"
MANIFEST_NAME = "run.json"
PIECE = 2**16  # rows that `pieces` gives at a time: half a megabyte for each variable
_CHUNK = 4096  # rows formatted at a time: 40 columns of text then take about 10 MB


@dataclasses.dataclass(frozen=True)
class ResultVariable:
    """A recorded variable: its name `unit.variable` and what its FMU declares of it.

    `type` is Real, Integer, Boolean or Enumeration; `unit` a name of a unit of measure ("" for none);
    `items` the (value, name) pairs of an enumeration.
    """

    name: str
    unit: str = ""
    type: str = "Real"
    causality: str = "output"
    variability: str = "continuous"
    description: str = ""
    items: tuple[tuple[int, str], ...] = ()

    @property
    def held(self) -> bool:
        """Whether it keeps its value from one communication point to the next.

        So do inputs (nobody writes them in between) and all that is sampled or not Real.
        """
        return self.type != "Real" or self.causality == "input" or self.variability != "continuous"


class Results:
    """What a run recorded.

    `time` [s], shape (n,), and `data`, shape (n, m), hold row k of communication point k; `variables`
    describes the m columns. `results["vehicle.speed"]` is one column, `len(results)` is n.
    `data` may be given as a Table that is not in memory, and `time` as a Grid: then `results.data` and
    `results.time` make all of it, while `pieces`, a column or `part` take no more than is asked for.
    `manifest` is what run.json says of the run; `figure` and `metric_specs` are those of its system and
    scenario (None and none for results that were read from a file).

    A time k * step_size that misses its decimal by rounding (7 * 0.01 = 0.07000000000000001) becomes the
    double nearest to that decimal: times within 1e-12 s (and 4 units in the last place) of a whole
    nanosecond are put there, others are kept as they are.
    """

    def __init__(
        self,
        time: ArrayLike | Grid,
        data: ArrayLike | Table,
        variables: Sequence[ResultVariable],
        manifest: Mapping[str, Any] | None = None,
        figure: FigureSpec | None = None,
        metrics: Sequence[MetricSpec] = (),
    ) -> None:
        self._grid = time if isinstance(time, Grid) else None
        self._time: Array | None = None
        if not isinstance(time, Grid):
            self._time = to_nanoseconds(np.array(time, dtype=np.float64, ndmin=1))
        self._table: Table = data if isinstance(data, Table) else _table(data)
        self.variables = tuple(variables)
        self.manifest: dict[str, Any] = dict(manifest or {})
        self.figure = figure
        self.metric_specs = tuple(metrics)
        count = len(time) if isinstance(time, Grid) else len(self.time)
        if self._table.shape != (count, len(self.variables)):
            raise ValueError(
                f"data is {self._table.shape}, {count} times and {len(self.variables)} variables "
                f"need {(count, len(self.variables))}"
            )
        self._columns = {v.name: j for j, v in enumerate(self.variables)}
        if len(self._columns) != len(self.variables) or "time" in self._columns:
            raise ValueError("the names of the variables must differ from each other and from 'time'")

    @property
    def time(self) -> Array:
        """All times [s], shape (n,), in memory."""
        if self._time is None:
            starts = range(0, max(1, len(self)), PIECE)
            self._time = np.concatenate([self.times(start, start + PIECE) for start in starts])
        return self._time

    def times(self, start: int, stop: int) -> Array:
        """The times [s] of the rows from `start` to before `stop`, or to the end."""
        if self._time is not None:
            return self._time[start:stop]
        assert self._grid is not None  # one of the two was given
        return to_nanoseconds(self._grid[start:stop])

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
        """Times, shape (n,), and values, shape (n, len(names)), from row `first` on, `rows` at a time
        (default: PIECE).

        Before them each piece but the first repeats `overlap` rows of the one before. Raises ConfigError as
        `variable` does.
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
        return name in self._columns

    def __getitem__(self, name: str) -> NDArray[Any]:
        """The values of a variable, shape (n,): float64, int64 (Integer, Enumeration) or bool.

        `time` is accepted as a name. Raises ConfigError naming the nearest variable there is.
        """
        if name == "time":
            return self.time
        column = self.column(name)
        kind = self.variable(name).type
        if kind == "Real":
            return column
        return column.astype(np.bool_ if kind == "Boolean" else np.int64)

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
        """What is known of a variable. Raises ConfigError naming the nearest one there is."""
        if name not in self._columns:
            raise ConfigError(f"the results have no variable '{name}'{nearest(name, self.names)}")
        return self.variables[self._columns[name]]

    def column(self, name: str) -> Array:
        """The values of a variable as float64, whatever its type, shape (n,): a view if it is in memory."""
        self.variable(name)
        return self._table.column(self._columns[name])

    def final(self) -> dict[str, float | int | bool]:
        """The last value of each variable, as the type that it has; empty without a row."""
        if not len(self):
            return {}
        last = self._table.rows(len(self) - 1, len(self))[0].tolist()
        kinds = {"Real": float, "Boolean": bool}
        return {v.name: kinds.get(v.type, int)(x) for v, x in zip(self.variables, last, strict=True)}

    def part(self, rows: NDArray[np.bool_] | slice, names: Sequence[str]) -> Results:
        """The results of some rows and variables, in memory. Raises ConfigError as `variable` does."""
        variables = [self.variable(name) for name in names]
        if isinstance(rows, slice) and rows.step is None:
            start, stop, _ = rows.indices(len(self))
            data = self._table.part(start, stop, [self._columns[name] for name in names])
            return Results(self.times(start, stop), data, variables, self.manifest)
        columns = [self.column(name)[rows] for name in names]
        time = self.time[rows]
        data = np.column_stack(columns) if columns else np.empty((len(time), 0))
        return Results(time, data, variables, self.manifest)

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write the CSV file. Raises ConfigError when it cannot be written; then no file is left."""
        path = Path(path)
        with replacing(path) as file:
            self._write_rows(file)
        return path

    def _write_rows(self, file: BinaryIO) -> None:
        file.write((",".join(["time", *map(_quoted, self.names)]) + "\n").encode())
        for start in range(0, len(self), _CHUNK):
            values = self._table.rows(start, start + _CHUNK)
            columns = [list(map(repr, self.times(start, start + _CHUNK).tolist()))]
            columns += [_texts(values[:, j], v.type) for j, v in enumerate(self.variables)]
            file.write(("\n".join(map(",".join, zip(*columns, strict=True))) + "\n").encode())

    def write(self, folder: str | os.PathLike[str]) -> Path:
        """Write results.csv and run.json into a folder, which is made if needed.

        Numbers of the manifest that are not finite become null: JSON has no name for them.
        Raises ConfigError when a file cannot be written; then none is left under its name half-done.
        """
        folder = Path(folder)
        self.to_csv(folder / CSV_NAME)
        about = {**self.manifest, "variables": [_described(v) for v in self.variables]}
        text = json.dumps(_jsonable(about), indent=2, allow_nan=False, ensure_ascii=False)
        with replacing(folder / MANIFEST_NAME) as file:
            # a path that is no UTF-8 has lone surrogates, which JSON knows as \udc80
            file.write((text + "\n").encode(errors="backslashreplace"))
        return folder

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Results:
        """Read a results folder, its results.csv, or any CSV file whose first column is the time.

        Without a run.json beside results.csv every variable is a Real without a unit of measure.
        Raises ConfigError naming file, line, column and value of what is not a number.
        """
        path = Path(path)
        if path.is_dir():
            path = path / CSV_NAME
        names, table = _read_csv(path)
        manifest = _read_manifest(path.with_name(MANIFEST_NAME)) if path.name == CSV_NAME else {}
        known = _read_variables(manifest.pop("variables", []), path.with_name(MANIFEST_NAME))
        variables = [known.get(name, ResultVariable(name)) for name in names]
        return cls(table[:, 0], table[:, 1:], variables, manifest)

    def metrics(self) -> list[Metric]:
        """The numbers that the run's system and scenario name."""
        from . import metrics  # knows units of measure; reading and writing results does without

        return metrics.evaluate(self, self.metric_specs)

    def plot(
        self,
        path: str | os.PathLike[str] | None = None,
        title: str | None = None,
        spec: FigureSpec | None = None,
    ) -> Figure:
        """Draw the figure of the run's system, another `spec`, or else signals grouped by unit of measure.

        Saved where a path (.png, .svg, .pdf) is given. Raises ConfigError for a spec that does not fit.
        """
        from ..figures import draw as figures  # matplotlib: 0.5 s that only figures need

        figure = figures.draw(self, spec or self.figure, title=title)
        if path is not None:
            figures.write(figure, Path(path))
        return figure


def _table(data: ArrayLike) -> Table:
    array = np.asarray(data, dtype=np.float64)
    if array.ndim != 2:
        raise ValueError(f"data has {array.ndim} dimensions: rows and columns are needed")
    return MemoryTable(array)


def to_nanoseconds(time: Array) -> Array:
    """The times [s] with those that miss a whole nanosecond by rounding alone put there (see Results)."""
    with np.errstate(invalid="ignore", over="ignore"):  # inf and nan fail the comparison and stay
        decimal = np.rint(time * 1e9) / 1e9
        return np.where(np.abs(decimal - time) <= 1e-12 + 4 * np.spacing(np.abs(time)), decimal, time)


def _texts(values: Array, kind: str) -> list[str]:
    """The text of each value of a column, formatted once for each stretch of equal values."""
    bits = values.view(np.int64)  # as bits, -0.0 differs from 0.0 and NaN equals itself
    starts = np.concatenate(([0], np.flatnonzero(bits[1:] != bits[:-1]) + 1))
    distinct = values[starts]
    if kind != "Real" and np.array_equal(distinct, np.rint(distinct)):
        texts = list(map(str, distinct.astype(np.int64).tolist()))
    else:
        texts = list(map(repr, distinct.tolist()))
    if len(starts) == len(values):
        return texts
    lengths = np.diff(starts, append=len(values)).tolist()
    return [text for text, length in zip(texts, lengths, strict=True) for _ in range(length)]


def _quoted(name: str) -> str:
    """A name as CSV writes it: FMI's structured names may hold a comma, as in `x[1,2]`."""
    if any(c in name for c in ',"\n\r'):
        return '"' + name.replace('"', '""') + '"'
    return name


def _described(variable: ResultVariable) -> dict[str, Any]:
    about = dataclasses.asdict(variable)
    if not variable.items:
        del about["items"]
    return about


def _jsonable(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _jsonable(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_jsonable(inner) for inner in value]
    if isinstance(value, np.generic):
        return _jsonable(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, os.PathLike) else value


def _read_manifest(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise ConfigError(f"{path}: is not a JSON file: {error}") from error
    if not isinstance(manifest, dict):
        raise ConfigError(f"{path}: a JSON object is needed, not {type(manifest).__name__}")
    return manifest


def _read_variables(described: Any, place: Path) -> dict[str, ResultVariable]:
    try:
        found = [
            ResultVariable(**{**about, "items": tuple((int(v), str(n)) for v, n in about.get("items", ()))})
            for about in described
        ]
    except (TypeError, ValueError, AttributeError) as error:
        raise ConfigError(f"{place}: 'variables' does not describe the variables: {error}") from error
    return {v.name: v for v in found}


def _read_csv(path: Path) -> tuple[list[str], Array]:
    """The names of the columns after the first, and all columns, shape (n, 1 + m)."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            names = _header(path, file.readline())
            table = _numbers(file, len(names))
            if table is None or not np.isfinite(table).all() or _lines(path) != len(table) + 1:
                _explain(path, names)
                raise ConfigError(f"{path}: is not a table of numbers")
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: {error.reason} at byte {error.start}") from error
    backward = np.flatnonzero(np.diff(table[:, 0]) < 0.0)
    if len(backward):
        k = int(backward[0])
        raise ConfigError(
            f"{path}: line {k + 3}, column '{names[0]}': {float(table[k + 1, 0])!r} comes after "
            f"{float(table[k, 0])!r}; "
            "time must not decrease"
        )
    return names[1:], table


def _header(path: Path, line: str) -> list[str]:
    names = [name.strip() for name in next(csv.reader([line], skipinitialspace=True), [])]
    if not any(names):
        raise ConfigError(f"{path}: line 1: a header with the names of the columns is needed")
    if len(names) == 1 and ";" in line:
        raise ConfigError(f"{path}: line 1: columns are separated by ',', not by ';': {line.strip()!r}")
    if all(_number(name) is not None for name in names):
        raise ConfigError(f"{path}: line 1: a header with names is needed, not numbers: {line.strip()!r}")
    for j, name in enumerate(names):
        if not name:
            raise ConfigError(f"{path}: line 1, column {j + 1}: a name is needed")
        if name in names[:j] or (name == "time" and j > 0):
            raise ConfigError(f"{path}: line 1, column {j + 1}: '{name}' is the name of two columns")
    return names


def _numbers(file: TextIO, columns: int) -> Array | None:
    """The rest of the file as numbers, None where it is something else."""
    first = file.readline()
    if not first.strip():
        return np.empty((0, columns)) if not file.read().strip() else None

    def rest() -> Iterator[str]:
        yield first
        yield from file

    try:
        table = np.loadtxt(rest(), delimiter=",", comments=None, quotechar='"', ndmin=2)
    except ValueError:
        return None  # the caller goes through the lines to say which one
    return table if table.shape[1] == columns else None


def _lines(path: Path) -> int:
    """The number of lines, without empty ones at the end: numpy skips empty lines in between silently."""
    count = 0
    tail = b""
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            count += block.count(b"\n")
            tail = (tail + block)[-4096:]
    blank = len(tail) - len(tail.rstrip(b"\r\n"))
    return count - tail[len(tail) - blank :].count(b"\n") + 1


def _explain(path: Path, names: list[str]) -> None:
    """Raise ConfigError for the first value of the file that is no finite number."""
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.reader(file)
        next(reader)
        for row in reader:
            place = f"{path}: line {reader.line_num}"
            if len(row) != len(names):
                raise ConfigError(f"{place}: {len(row)} values, the header has {len(names)} columns")
            for name, text in zip(names, row, strict=True):
                if not text.strip():
                    raise ConfigError(f"{place}, column '{name}': a value is missing")
                if _number(text) is None:
                    raise ConfigError(f"{place}, column '{name}': {text!r} is not a finite number")


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None
