"""Results as the tables of two libraries: pandas and xarray, which are installed with the extra `data`."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..row_store import Array
from .text_table import TextTable
from .variable import ResultVariable

if TYPE_CHECKING:
    import pandas
    import xarray

_TIME = "time"


class Columns(Protocol):
    """The part of `Results` that tables of other libraries are made of: m variables of n rows."""

    text_table: TextTable

    @property
    def time(self) -> Array:
        """All times [s], shape (n,)."""

    @property
    def manifest(self) -> dict[str, Any]:
        """Facts of the run as a whole."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the variables that are numbers."""

    @property
    def texts(self) -> tuple[str, ...]:
        """The names of those of type String."""

    def variable(self, name: str) -> ResultVariable:
        """Return the description of a variable that is a number. Raises ConfigError for another name."""

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the values of a variable, shape (n,)."""


def to_dataframe(results: Columns, names: Sequence[str] | None = None) -> pandas.DataFrame:
    """Return variables as columns of a pandas.DataFrame over the time in s; all, then the texts, by default.

    `attrs` has "units", the unit of measure of each column and of "time", and "descriptions". Raises
    ConfigError without pandas and for a name that there is not.
    """
    library = _library("pandas", "to_dataframe")
    chosen = list(_chosen(results, names))
    columns = {v.name: _column(library, results[v.name], v) for v in chosen}
    index = library.Index(results.time.copy(), name=_TIME)
    frame = library.DataFrame(columns, index=index, columns=list(columns), copy=True)
    frame.attrs["units"] = {_TIME: "s"} | {v.name: v.unit for v in chosen}
    frame.attrs["descriptions"] = {v.name: v.description for v in chosen if v.description}
    return frame


def to_xarray(results: Columns, names: Sequence[str] | None = None) -> xarray.Dataset:
    """Return variables of an xarray.Dataset over the coordinate `time`; all, then the texts, by default.

    Attributes are those of the CF conventions: `units` (none where no unit is known), `long_name`, and of an
    enumeration `flag_values` and `flag_meanings`. Raises ConfigError without xarray and for a name that there
    is not.
    """
    library = _library("xarray", "to_xarray")
    variables = {v.name: (_TIME, results[v.name].copy(), _attributes(v)) for v in _chosen(results, names)}
    time = (_TIME, results.time.copy(), {"units": "s", "long_name": "time"})
    known = {key: results.manifest.get(key) for key in ("system", "scenario")}
    about = {key: value for key, value in known.items() if isinstance(value, str) and value}
    return library.Dataset(variables, coords={_TIME: time}, attrs=about)


def _library(name: str, method: str) -> Any:
    """Return an optional library. Raises ConfigError naming the extra where it cannot be imported."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ConfigError(
            f"Results.{method} needs {name}, which cannot be imported here ({error}); "
            f"install it in this Python: pip install {name}"
        ) from None


def _chosen(results: Columns, names: Sequence[str] | None) -> Iterator[ResultVariable]:
    """Yield the variables of some names, each once; of all without names."""
    if isinstance(names, str):
        raise ConfigError(f"names = '{names}': a list of names is needed")
    texts = {v.name: v for v in results.text_table.variables}
    for name in dict.fromkeys((*results.names, *results.texts) if names is None else names):
        yield texts[name] if name in texts else results.variable(name)


def _column(library: Any, values: NDArray[Any], variable: ResultVariable) -> Any:
    """Return a column of a DataFrame: of an enumeration with states their names, else the values."""
    if not variable.items:
        return values
    names = _states(variable, values)
    numbers = np.array(list(names), dtype=values.dtype)
    order = np.argsort(numbers)
    codes = order[np.searchsorted(numbers[order], values)]
    return library.Categorical.from_codes(codes, categories=list(names.values()))


def _states(variable: ResultVariable, values: NDArray[Any]) -> dict[int, str]:
    """Return the name of each state by its number; that of a number without a state is the number.

    A name that two states have is followed by the number.
    """
    names = dict(variable.items)
    found = list(names.values())
    states = {n: name if found.count(name) == 1 else f"{name} ({n})" for n, name in names.items()}
    strange = [n for n in np.unique(values).tolist() if n not in states]
    return states | {n: f"{n:g}" for n in strange}


def _attributes(variable: ResultVariable) -> dict[str, Any]:
    """Return the attributes of a variable of a Dataset."""
    found: dict[str, Any] = {"units": variable.unit} if variable.unit else {}
    if variable.description:
        found["long_name"] = variable.description
    if variable.items:
        found["flag_values"] = np.array([number for number, _ in variable.items], dtype=np.int64)
        found["flag_meanings"] = " ".join("_".join(name.split()) for _, name in variable.items)
    return found
