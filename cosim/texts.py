"""The texts of a run: each has a number, which stands in the run's memory in its place."""

from __future__ import annotations


class Texts:
    """A growing list of different texts. The number of a text is its place; that of "" is 0."""

    def __init__(self) -> None:
        self._texts = [""]
        self._numbers = {"": 0.0}

    def __len__(self) -> int:
        return len(self._texts)

    def number(self, text: str) -> float:
        """Return the number of a text, which is added where it is new."""
        found = self._numbers.get(text)
        if found is None:
            found = self._numbers[text] = float(len(self._texts))
            self._texts.append(text)
        return found

    def text(self, number: float) -> str:
        """Return the text of a number. Raises IndexError for a number that no text has."""
        if not 0.0 <= number < len(self._texts):
            raise IndexError(f"{number!r} is the number of no text")
        return self._texts[int(number)]

    def since(self, count: int) -> list[str]:
        """Return the texts that were added when there were `count` already."""
        return self._texts[count:]
