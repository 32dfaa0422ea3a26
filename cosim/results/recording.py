"""The rows of a run as metrics and writers of files see them: a piece at a time, never all in memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

from ..row_store import Array
from .variable import ResultVariable


class Recording(Protocol):
    """The part of `Results` that reads rows, and what the columns mean. Its n rows have m columns."""

    @property
    def variables(self) -> Sequence[ResultVariable]:
        """The m variables, in column order."""

    @property
    def names(self) -> Sequence[str]:
        """Their names."""

    @property
    def manifest(self) -> Mapping[str, Any]:
        """Facts of the run as a whole; a format without a place for them leaves them out."""

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time [s]. Raises IndexError without a row."""

    def __len__(self) -> int: ...

    def variable(self, name: str) -> ResultVariable:
        """Return the description of a variable. Raises ConfigError for a name that there is not."""

    def times(self, start: int, stop: int) -> Array:
        """Return the times [s] of the rows from `start` to before `stop`, or to the end, shape (n,)."""

    def pieces(
        self, names: Sequence[str], first: int = 0, overlap: int = 0, rows: int | None = None
    ) -> Iterator[tuple[Array, Array]]:
        """Yield times [s], shape (n,), and values, shape (n, len(names)), of up to `rows` rows at a time."""
