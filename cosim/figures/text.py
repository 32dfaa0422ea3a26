"""Texts of figures: names on several lines, units of measure as print has them."""

from __future__ import annotations

import re

from ..visible import flowing, on_one_line


def pretty(unit: str) -> str:
    """Return a unit's name as print has it: m/s2 as m/s², N.m as N·m, uH as µH, ohm as Ω."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    printed = re.sub(r"(?<=[A-Za-z])-?\d+", lambda m: m[0].translate(raised), unit).replace(".", "·")
    printed = re.sub(r"\bu(?=(?:[msgHFAVWN]|ohm)\b)", "µ", printed)
    printed = re.sub(r"(?<![A-Za-z])([kMmµ]?)ohm\b", r"\1Ω", printed)
    return on_one_line(printed)


def broken(text: str, width: int) -> str:
    """Return a text on lines of at most `width` characters.

    It is broken after spaces, then after the dots and slashes of names, then after their other marks; what
    has none of them stays longer.
    """
    lines = [""]
    for word in flowing(text).split():
        for i, part in enumerate(_parts(word, width)):
            gap = " " if i == 0 and lines[-1] else ""
            if lines[-1] and len(lines[-1]) + len(gap) + len(part) > width:
                lines.append(part)
            else:
                lines[-1] += gap + part
    return "\n".join(lines)


def _parts(word: str, width: int, marks: tuple[str, ...] = (r"./\\", "_-")) -> list[str]:
    """Return a word in parts that end in marks: of the first kind, and where it needs them, of the next."""
    if len(word) <= width or not marks:
        return [word]
    parts = re.findall(f"[^{marks[0]}]*[{marks[0]}]+|[^{marks[0]}]+", word)
    return [piece for part in parts for piece in _parts(part, width, marks[1:])]
