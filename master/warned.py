"""Warnings by kinds: texts that differ by their numbers alone are of one kind."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from ..cosim.errors import counted

KINDS = 3
"""The most kinds of a unit's warnings that are kept: the first."""

_NUMBER = re.compile(r"0[xX][0-9a-fA-F]+|(?<![A-Za-z_])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


class WarningKinds:
    """The first `most` kinds of warnings: `counts` are by the first text of each, in the order they came.

    `others` is the number of warnings that are of none of these, or have no text.
    """

    def __init__(self, most: int = KINDS) -> None:
        self.counts: dict[str, int] = {}
        self.others = 0
        self._most = most
        self._kinds: dict[str, tuple[int, str]] = {}

    def add(self, text: str, times: int = 1) -> int | None:
        """Count a warning that came so many times; return the number of its kind, None for the others."""
        kind = _NUMBER.sub("#", text)
        found = self._kinds.get(kind)
        if found is None:
            if not text or len(self._kinds) == self._most:
                self.others += times
                return None
            found = self._kinds[kind] = len(self._kinds), text
        number, first = found
        self.counts[first] = self.counts.get(first, 0) + times
        return number


def warnings_text(count: int, kinds: Mapping[str, int]) -> str:
    """Return `2 warnings: too hot at 3 s (and 1 alike)` for a number of warnings and their first kinds."""
    texts = [with_count(text, n) for text, n in kinds.items()]
    return counted(count, "warning") + (f": {'; '.join(texts)}" if texts else "")


def first_kinds(texts: Iterable[str], most: int) -> tuple[dict[str, int], int]:
    """Return the counts of the first `most` kinds by their first texts, and the number of other texts."""
    kinds = WarningKinds(most)
    for text in texts:
        kinds.add(text)
    return kinds.counts, kinds.others


def with_count(text: str, n: int) -> str:
    """Return a text, and how many others are like it where it is one of `n`."""
    return text if n == 1 else f"{text} (and {n - 1} alike)"
