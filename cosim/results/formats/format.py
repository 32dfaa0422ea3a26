"""A file format of results: a writer of a recording, and a reader that returns the contents of a file."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from ...row_store import Array
from ..variable import ResultVariable


class Recording(Protocol):
    """The part of `Results` that a writer knows: the rows, a piece at a time, and what the columns mean."""

    @property
    def variables(self) -> Sequence[ResultVariable]:
        """The m variables, in column order."""

    @property
    def names(self) -> Sequence[str]:
        """Their names."""

    @property
    def manifest(self) -> Mapping[str, Any]:
        """Facts of the run as a whole; a format without a place for them leaves them out."""

    def __len__(self) -> int: ...

    def pieces(
        self, names: Sequence[str], first: int = 0, overlap: int = 0, rows: int | None = None
    ) -> Iterator[tuple[Array, Array]]:
        """Yield times [s], shape (n,), and values, shape (n, len(names)), of up to `rows` rows at a time."""


@dataclasses.dataclass(frozen=True)
class Contents:
    """The contents of a file: `time` [s], shape (n,), `data`, shape (n, m), and the m `variables`.

    The time does not decrease. `manifest` holds the facts of the run as a whole, where the format has a place
    for them.
    """

    time: Array
    data: Array
    variables: Sequence[ResultVariable]
    manifest: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Format:
    """A format by its two functions; what they need beyond numpy, they import when they are called.

    `write(recording, path)` makes the file `path`; it lets OSError through, and the file it leaves then is
    removed by the caller. `read(path)` raises ConfigError naming the file, and the place in it where it can.
    """

    write: Callable[[Recording, Path], None]
    read: Callable[[Path], Contents]
