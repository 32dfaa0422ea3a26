"""The two ways evcosim refuses: bad input found before a step, and a run that failed."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol

from .visible import on_one_line, visible


class Recorded(Protocol):
    """The recording of a failed run: n rows of m variables.

    It is an `evcosim.Results`, which stands above this module, as do the types of arrays and figures.
    """

    @property
    def time(self) -> Any:
        """The times [s] of the rows, shape (n,)."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names `unit.variable`, in column order."""

    def __getitem__(self, name: str) -> Any:
        """Return the values of a variable, or of "time", shape (n,). Raises ConfigError for another name."""

    def __len__(self) -> int:
        """Return n."""

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""

    def __contains__(self, name: object) -> bool:
        """Return whether a variable has this name."""

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write the rows into a CSV file. Raises ConfigError where it cannot be written."""

    def write(self, folder: str | os.PathLike[str]) -> Path:
        """Write results.csv and run.json into a folder. Raises ConfigError where they cannot be written."""

    def plot(self, path: str | os.PathLike[str] | None = None) -> Any:
        """Return the figure of the run's system, written to `path` (.png, .svg, .pdf) if one is given."""


class ConfigError(ValueError):
    """Bad input, found before any step. The message names the place, the rule and the values.

    Each argument is a line of it: a line end within one, of a name in a stranger's file, is shown as `\\n`.
    """

    def __str__(self) -> str:
        return "\n".join(on_one_line(str(line)) for line in self.args)

    @property
    def lines(self) -> list[str]:
        """The lines of the message, for an error that says more."""
        return str(self).split("\n")


class RunError(RuntimeError):
    """A run that failed: the message names the unit, the time and the reason.

    `results` has the rows up to then; None where the run failed before it recorded any.
    """

    results: Recorded | None = None

    def __str__(self) -> str:
        return visible(super().__str__())


class ShortageError(RunError):
    """This machine has no room, file, process or memory left; neither the input nor a unit is to blame."""


def nearest(word: str, words: Iterable[str]) -> str:
    """Return ` (did you mean 'x'?)` for the most similar of `words`, or nothing where none is similar.

    One that differs by case alone is the most similar.
    """
    known = list(words)
    same = [other for other in known if other.casefold() == word.casefold()]
    close = same or difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return f" (did you mean '{close[0]}'?)" if close else ""


def short(value: object) -> str:
    """Return a value as Python writes it, cut where it is long; an integer of thousands of digits in hex.

    A list with such an integer, which Python refuses to write, is named by its type.
    """
    huge = isinstance(value, int) and value.bit_length() > 2000  # Python writes some thousand digits at most
    try:
        text = f"{value:#x}" if huge else repr(value)
    except ValueError:
        text = f"a {type(value).__name__} with an integer of thousands of digits"
    return text if len(text) <= 80 else f"{text[:77]}..."


def counted(count: int, thing: str) -> str:
    """Return `1 value`, `2 values`."""
    return f"{count} {thing}" + ("" if count == 1 else "s")
