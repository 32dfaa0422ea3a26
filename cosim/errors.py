"""The two ways evcosim refuses: bad input found before a step, and a run that failed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .results.results import Results


class ConfigError(ValueError):
    """Bad input, found before any step. The message names the place, the rule and the values."""


class RunError(RuntimeError):
    """A run that failed: the message names the unit, the time and the reason.

    `results` is what was recorded up to then, where the run got as far as recording.
    """

    results: Results | None = None


def nearest(word: str, words: Iterable[str]) -> str:
    """` (did you mean 'x'?)` for the most similar of `words`, or nothing where none is similar."""
    close = difflib.get_close_matches(word, list(words), n=1, cutoff=0.6)
    return f" (did you mean '{close[0]}'?)" if close else ""


def counted(count: int, thing: str) -> str:
    """`1 value`, `2 values`."""
    return f"{count} {thing}" + ("" if count == 1 else "s")
