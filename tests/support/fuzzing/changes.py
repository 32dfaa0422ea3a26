"""Hostile words and numbers, and the changes of any text; an input of the command line."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

DEEP = 200_000
"""Levels of nesting that no file needs."""

NUMBERS = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-320",
    "1e-300",
    "inf",
    "-inf",
    "+inf",
    "nan",
    "-nan",
    "1e400",
    "1e-400",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775809",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "0x10",
    "0x1fffffffffffffffff",
    "0o17",
    "0b1",
    "0.1",
    "1e9",
    "1e18",
    "1_000",
    "-0",
    "-0.0",
    "+1",
    "1.",
    ".5",
    "1,5",
    "1 000",
    "1e",
    "1e+",
    "--1",
    "\N{ARABIC-INDIC DIGIT ONE}\N{ARABIC-INDIC DIGIT TWO}",
    "\N{FULLWIDTH DIGIT FIVE}",
    "\N{SUPERSCRIPT TWO}",
    "\N{MINUS SIGN}1",
    "true",
    "False",
    "1979-05-27",
    "1979-05-27T07:32:00Z",
    "07:32:00",
    "1/3",
    "1e308*10",
    "9" * 5000,
    "-" + "9" * 5000,
    "0." + "0" * 5000 + "1",
    "1" + "0" * 400,
    "1e" + "9" * 40,
]
TEXTS = (
    "",
    " ",
    "\0",
    "\\u0000",
    "\N{ZERO WIDTH NO-BREAK SPACE}",
    "\u202e",
    "\u2028",
    "\x1b[31m",
    "\\u001b[2J",
    "\ud7ff\ufffd",
    "x" * 10_000,
    "x." * 5_000 + "x",
    "../" * 2,
    "/dev/zero",
    "/dev/null",
    "/dev/stdin",
    "/dev/full",
    "/proc/self/mem",
    "odd/folder.toml",
    "odd/fifo.fmu",
    "odd/zero.csv",
    "odd/loop.dbc",
    "odd/empty.fmu",
    ".",
    "$x_{1$",
    "\\frac{",
    "$\\frac{}",
    "#",
    "??",
    "\N{EURO SIGN}",
    "V(",
    "9**9**9**9",
    "m^0.5",
    "m^9999999999",
    "1e999 m",
    "(" * 500 + "m",
    "a.b.c.d",
    ".",
    "..",
    ".speed",
    "vehicle.",
    "*",
    "[*",
    "**",
    "?" * 60,
    "*a" * 40,
    "(a+)+$",
    "'",
    '"',
    "]]",
    "{}",
    "{0}",
    "%s%n",
    "\r\n",
    "\N{LATIN SMALL LETTER SHARP S}",
    "e\N{COMBINING ACUTE ACCENT}" * 20,
    "none",
    "process",
    "__class__",
    "import os",
    "con.toml",
)
WORD = re.compile(r"[A-Za-z_][\w.]*")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")
QUOTED = re.compile(r'"[^"\n]*"')

Change = Callable[[random.Random, str, str], str]


class Input(NamedTuple):
    """A command line, and the files that it names, by their names in the working folder."""

    kind: str
    arguments: list[str]
    files: dict[str, bytes]


def mutated(random: random.Random, text: str, nested: str = "[") -> bytes:
    """Return a text with one to four changes; `nested` is what nests in its language."""
    for _ in range(random.choice((1, 1, 1, 2, 2, 3, 4))):
        text = random.choice(_CHANGES)(random, text, nested)
    return encoded(random, text)


def encoded(random: random.Random, text: str) -> bytes:
    """Return a text as bytes: mostly UTF-8; at times in another encoding, or with bytes flipped."""
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    match random.randrange(40):
        case 0 | 1 if data:
            for _ in range(random.randint(1, 8)):
                data[random.randrange(len(data))] = random.randrange(256)
        case 2:
            return random.choice((b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff", b"\x00")) + bytes(data)
        case 3:
            return text.encode(random.choice(("utf-16", "utf-32", "cp1252", "cp037")), "replace")
        case 4:
            return bytes(data).replace(b"\n", random.choice((b"\r\n", b"\r", b"\n\n", b"\0\n", b"\v")))
    return bytes(data)


def replaced(pattern: re.Pattern[str], choices: Sequence[str], quote: str = "") -> Change:
    """Return the change that puts one of the choices in the place of what a pattern finds."""

    def change(random: random.Random, text: str, nested: str) -> str:
        found = list(pattern.finditer(text))
        if not found:
            return text
        chosen = random.choice(found)
        return text[: chosen.start()] + quote + random.choice(choices) + quote + text[chosen.end() :]

    return change


def _line(random: random.Random, text: str, nested: str) -> str:
    """Leave out, repeat or exchange lines."""
    lines = text.splitlines(keepends=True) or [""]
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    match random.randrange(4):
        case 0:
            del lines[i]
        case 1:
            lines.insert(j, lines[i])
        case 2:
            lines.insert(i, lines[i] * random.choice((1, 1, 300)))
        case _:
            lines[i], lines[j] = lines[j], lines[i]
    return "".join(lines)


def _inserted(random: random.Random, text: str, nested: str) -> str:
    place = random.randrange(len(text) + 1)
    return text[:place] + random.choice((*TEXTS, *NUMBERS, nested * DEEP, "\n")) + text[place:]


def _cut(random: random.Random, text: str, nested: str) -> str:
    return text[: random.randrange(len(text) + 1)]


def _swapped(pattern: re.Pattern[str]) -> Change:
    """Return the change that puts one thing of a text in the place of another one of its kind."""

    def change(random: random.Random, text: str, nested: str) -> str:
        found = list(pattern.finditer(text))
        if not found:
            return text
        one, other = random.choice(found), random.choice(found)
        return text[: one.start()] + other[0] + text[one.end() :]

    return change


_CHANGES: tuple[Change, ...] = (
    replaced(NUMBER, NUMBERS),
    replaced(NUMBER, NUMBERS),
    replaced(QUOTED, TEXTS, '"'),
    replaced(QUOTED, NUMBERS),
    replaced(NUMBER, TEXTS, '"'),
    replaced(WORD, TEXTS),
    _line,
    _line,
    _inserted,
    _cut,
    _swapped(WORD),
    _swapped(QUOTED),
    _swapped(NUMBER),
)
