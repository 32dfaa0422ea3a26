"""The two ways evcosim refuses: bad input found before a step, and a run that failed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from typing import Any, Protocol


class Recorded(Protocol):
    """The recorded rows and variables that a failed run keeps: `evcosim.Results`, which stands above this."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[str]: ...

    def __getitem__(self, name: str) -> Any: ...

    def to_csv(self, path: str) -> Any:
        """Write the rows to a CSV file."""


class ConfigError(ValueError):
    """Bad input, found before any step. The message names the place, the rule and the values."""


class RunError(RuntimeError):
    """A run that failed: the message names the unit, the time and the reason.

    `results` is what was recorded up to then, where the run got as far as recording.
    """

    results: Recorded | None = None


def nearest(word: str, words: Iterable[str]) -> str:
    """Return ` (did you mean 'x'?)` for the most similar of `words`, or nothing where none is similar."""
    close = difflib.get_close_matches(word, list(words), n=1, cutoff=0.6)
    return f" (did you mean '{close[0]}'?)" if close else ""


def counted(count: int, thing: str) -> str:
    """Return `1 value`, `2 values`."""
    return f"{count} {thing}" + ("" if count == 1 else "s")
