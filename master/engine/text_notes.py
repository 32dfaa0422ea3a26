"""The recorded texts of a run: a note for each row in which one of them differs from the row before."""

from __future__ import annotations

from ...cosim.plan.plan import Plan
from ...cosim.results.text_table import Change, TextTable


class TextNotes:
    """Notes of the texts of a plan, whose numbers stand in `memory`, shape (size,).

    Another thread may ask for them.
    """

    def __init__(self, plan: Plan, memory: memoryview[float]) -> None:
        self._plan, self._memory = plan, memory
        self._changes: list[tuple[int, tuple[float, ...]]] = []

    def note(self, k: int) -> None:
        """Note the texts of row k, where one differs from the row before."""
        numbers = self._now()
        if not self._changes or self._changes[-1][1] != numbers:
            self._changes.append((k, numbers))

    def table(self, rows: int, now: bool) -> TextTable:
        """Return the texts of the first rows, and with `now` those of the present as one row more."""
        changes = [change for change in self._changes if change[0] < rows]
        present = self._now()
        if now and self._plan.text_columns and (not changes or changes[-1][1] != present):
            changes.append((rows, present))
        return TextTable(self._plan.text_columns, self._as_texts(changes))

    def since(self, first: int) -> list[Change]:
        """Return the rows with their texts that were noted, from number `first` of them on."""
        return self._as_texts(self._changes[first:])

    def _now(self) -> tuple[float, ...]:
        return tuple(self._memory[slot] for slot in self._plan.text_slots)

    def _as_texts(self, changes: list[tuple[int, tuple[float, ...]]]) -> list[Change]:
        texts = self._plan.texts
        return [(k, tuple(texts.text(n) for n in numbers)) for k, numbers in changes]
