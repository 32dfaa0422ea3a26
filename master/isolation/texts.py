"""The numbers of texts on both sides of an isolated unit: each side has a table of its own.

A text crosses the socket once, when it is new; then its numbers are known to the master. One that is longer
than an answer comes in pieces.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...cosim.texts import Texts
from ..unit import UnitError
from . import framing

_PART = framing.LONGEST // 16  # characters of an answer, of which JSON may make six bytes each
_LONGEST = 1 << 26  # characters of a text: what is more is no text of a unit that can be trusted


class TextExchange:
    """Translates numbers of the run's table into those of the child's, and back.

    `request` calls a method of the child (`child.Server`) and returns its answer; the unit is named `name`.
    """

    def __init__(self, name: str, texts: Texts, request: Callable[..., Any]) -> None:
        self._name, self._texts, self._request = name, texts, request
        self._there = {0.0: 0.0}
        self._here = [0.0]

    def to_child(self, number: float) -> float:
        """Return the child's number of a text. Raises UnitError for an invalid answer."""
        found = self._there.get(number)
        if found is None:
            answer = self._request("learn_text", self._texts.text(number))
            if not isinstance(answer, int | float):
                raise UnitError(f"unit '{self._name}': its process sent no number for a text")
            found = self._there[number] = float(answer)
        return found

    def from_child(self, number: float) -> float:
        """Return the run's number of a text of the child. Raises UnitError for a number that no text has."""
        while not 0.0 <= number < len(self._here):
            news = self._request("texts_since", len(self._here)) if number >= 0.0 else None
            if news == []:
                news = [self._in_pieces(len(self._here))]
            if not news or not isinstance(news, list) or not all(isinstance(text, str) for text in news):
                raise UnitError(f"unit '{self._name}': its process wrote {number!r}, which no text has")
            self._here += [self._texts.number(as_c_text(text)) for text in news]
        return self._here[int(number)]

    def _in_pieces(self, number: int) -> str | None:
        """Return a text that is longer than an answer; None for a number that no text has."""
        pieces, size = [], 0
        while piece := self._request("piece_of_text", number, size):
            if not isinstance(piece, str):
                return None
            pieces.append(piece)
            size += len(piece)
            if size > _LONGEST:
                raise UnitError(
                    f"unit '{self._name}': its process sent a text of more than {_LONGEST} characters"
                )
        return "".join(pieces) or None


def as_c_text(text: str) -> str:
    """Return a text of a foreign process as a C text can be: up to a NUL, without half a character."""
    return text.partition("\0")[0].encode(errors="replace").decode()


def part_of(texts: list[str]) -> list[str]:
    """Return the first texts of a list, as many as an answer holds: none where the first is longer."""
    part: list[str] = []
    size = 0
    for text in texts:
        size += len(text)
        if size > _PART:
            break
        part.append(text)
    return part


def piece_of(text: str, start: int) -> str:
    """Return the piece of a text from a character on that an answer holds; "" behind its end."""
    return text[start : start + _PART]


def is_long(value: object) -> bool:
    """Return True for a text that no answer holds."""
    return isinstance(value, str) and len(value) > _PART
