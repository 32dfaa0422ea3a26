"""The grammar of a unit text: names with integer or rational exponents, products, quotients, parentheses.

    unit     = power {("*" | "." | " " | "/") power}
    power    = (name | "1" | times name | "(" unit ")") [["^" | "**"] exponent]
    times    = "100" | "1000", behind "/" or "("
    exponent = ["+" | "-"] number | "(" ["+" | "-"] number ["/" number] ")"

A text is parsed, never evaluated, and only within limits: 64 characters, exponents up to 12. In "J/kg.K" it
is open whether K divides; such a text has two readings. A space is a product between two names ("N m"), but
not beside a ratio: "% Nm" is a share of a torque that nobody knows. "kgm2" is kg.m2 wherever it stands.
"""

from __future__ import annotations

import itertools
import re
import unicodedata
from fractions import Fraction

LONGEST = 64
"""Characters of a unit text at most."""

_GREATEST = 12  # of an exponent, of its denominator, and of the readings of a text

Powers = tuple[tuple[str, Fraction], ...]
"""One reading of a text: the names in it, each once, with their exponents (0 where a name cancels out)."""

_TOKEN = re.compile(
    r"\s*(?:(\*\*|[*./^()+-])|(\d+)|((?:[^\W\d_]|[%‰°])(?:[^\W\d]|[%‰°]|\d+(?=[^\W\d]))*))\s*"
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")
_RAISED = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺]+")
_SAME = {"º": "°", "˚": "°", "\u2212": "-", "·": "*", "⋅": "*", "∙": "*", "\u00d7": "*"}  # minus, times
_SAME |= {"\u2022": "*", "\u2217": "*", "\u2027": "*"}  # a bullet, an operator, a hyphenation point
_SAME |= {"\u2215": "/", "\u2044": "/"}  # signs of a division and of a fraction
_SAME |= {"\u2206": "Δ"}  # the sign of an increment
_TIMES = {"100": "%", "1000": "‰"}  # as 1/% and 1/‰
_RATIOS = frozenset({"%", "‰", "ppm", "ppb", "pct", "percent"})
_KGM = re.compile(r"(?<![^\W_])kgm((?:\^|\*\*)?2|)(?=$|[/.*)\s])", re.IGNORECASE)
_TWICE_ENCODED = re.compile("Â(?=[°²³·µ])")  # UTF-8 that was read as cp1252


class _NoUnit(Exception):
    """The text is not of the grammar."""


def plain(text: str) -> str:
    """Return a text in the characters of the grammar: "m/s²" as "m/s^2", no spaces around it, none twice."""
    text = _TWICE_ENCODED.sub("", text)
    for typed, meant in _SAME.items():
        text = text.replace(typed, meant)
    text = _RAISED.sub(lambda raised: "^" + raised[0].translate(_SUPERSCRIPTS), text)
    return " ".join(unicodedata.normalize("NFKC", text).split())


def parse(text: str) -> tuple[Powers, ...]:
    """Return the readings of a text, the usual one first; none for a text that is not of the grammar."""
    if not 0 < len(text) <= LONGEST:
        return ()
    try:
        return _Parser(_tokens(_KGM.sub(r"(kg.m\1)", text))).whole()
    except _NoUnit:
        return ()


def _tokens(text: str) -> list[str]:
    found: list[str] = []
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None or match.end() == at:
            raise _NoUnit
        token = match[match.lastindex or 0]
        spaced = text[at - 1 : at].isspace()  # a token takes the space behind it
        if found and spaced and not (_is_operator(token) or _is_operator(found[-1])):
            if not _is_name(token) or not _before_a_name(found):
                raise _NoUnit  # "m 2" is no power
            if found[-1] not in _TIMES:
                if {token.casefold(), found[-1].casefold()} & _RATIOS:
                    raise _NoUnit
                found.append("*")
        elif spaced and found and found[-1] == ")" and _is_name(token):
            found.append("*")
        found.append(token)
        at = match.end()
    return found


def _before_a_name(found: list[str]) -> bool:
    """Return True where a name behind a space may follow: a name, an exponent, or "/100"."""
    if _is_name(found[-1]):
        return True
    behind_operator = len(found) < 2 or found[-2] in ("*", "/", ".", "(")
    return found[-1].isdigit() and behind_operator == (found[-1] in _TIMES and len(found) > 1)


def _is_name(token: str) -> bool:
    return bool(token) and (token[0].isalpha() or token[0] in "%‰°")


def _is_operator(token: str) -> bool:
    return token in ("*", "/", ".", "^", "**", "(", ")")


class _Parser:
    """A parser by recursive descent: `at` is the index of the next token."""

    def __init__(self, tokens: list[str]) -> None:
        self.tokens = [*tokens, ""]
        self.at = 0

    def whole(self) -> tuple[Powers, ...]:
        if self.tokens[0] == "/":  # "/s" is "1/s"
            self.tokens.insert(0, "1")
        readings = self.product()
        if self.tokens[self.at]:
            raise _NoUnit
        return readings

    def product(self) -> tuple[Powers, ...]:
        parts = [("*", self.power())]
        while self.tokens[self.at] in ("*", ".", "/"):
            parts.append((self.take(), self.power()))
        signs = [-1 if operator == "/" else 1 for operator, _ in parts]
        orders = [signs]
        if -1 in signs:
            first = signs.index(-1)
            orders.append([*signs[:first], *[-1] * (len(signs) - first)])  # all after "/" divides
        found: dict[Powers, None] = {}
        for order, chosen in itertools.product(orders, _choices([part for _, part in parts])):
            found[_merged([_raised(part, Fraction(n)) for part, n in zip(chosen, order, strict=True)])] = None
        return _few(found)

    def power(self) -> tuple[Powers, ...]:
        token = self.take()
        if token == "(":
            readings = self.product()
            if self.take() != ")":
                raise _NoUnit
        elif token == "1":
            readings = ((),)
        elif token in _TIMES and self.tokens[self.at - 2] in ("/", "(") and _is_name(self.tokens[self.at]):
            times = ((_TIMES[token], Fraction(-1)),)
            return tuple(_merged([times, powers]) for powers in self.power())
        elif _is_name(token):
            readings = (((token, Fraction(1)),),)
        else:
            raise _NoUnit
        exponent = self.exponent(after_one=token == "1")
        if not exponent:
            raise _NoUnit  # "g0" is a standard gravity, and not 1
        return _few({_raised(powers, exponent): None for powers in readings})

    def exponent(self, after_one: bool) -> Fraction:
        token = self.tokens[self.at]
        if token in ("^", "**"):
            self.take()
            if self.tokens[self.at] != "(":
                return self.number()
            self.take()
            value = self.number()
            if self.tokens[self.at] == "/":
                self.take()
                below = self.digits()
                if not below:
                    raise _NoUnit
                value /= below
            if self.take() != ")":
                raise _NoUnit
            return value
        if token.isdigit() or token in ("+", "-"):  # "m2", "s-1"
            if after_one:
                raise _NoUnit
            return self.number()
        return Fraction(1)

    def number(self) -> Fraction:
        """Return an integer, or a decimal number such as 0.5."""
        sign = -1 if self.tokens[self.at] == "-" else 1
        if self.tokens[self.at] in ("+", "-"):
            self.take()
        value = Fraction(self.digits())
        if self.tokens[self.at] == "." and self.tokens[self.at + 1].isdigit():
            self.take()
            behind = self.take()
            value += Fraction(int(behind), 10 ** len(behind))
        return sign * value

    def digits(self) -> int:
        token = self.take()
        if not (token.isascii() and token.isdigit() and len(token) <= 3):
            raise _NoUnit
        return int(token)

    def take(self) -> str:
        token = self.tokens[self.at]
        if not token:
            raise _NoUnit
        self.at += 1
        return token


def _choices(parts: list[tuple[Powers, ...]]) -> itertools.product[tuple[Powers, ...]]:
    total = 1
    for part in parts:
        total *= len(part)
        if total > _GREATEST:
            raise _NoUnit
    return itertools.product(*parts)


def _few(found: dict[Powers, None]) -> tuple[Powers, ...]:
    if len(found) > _GREATEST:
        raise _NoUnit
    return tuple(found)


def _raised(powers: Powers, exponent: Fraction) -> Powers:
    return _merged([tuple((name, own * exponent) for name, own in powers)])


def _merged(parts: list[Powers]) -> Powers:
    """Return the product of parts, each name once. Raises _NoUnit beyond the limits."""
    total: dict[str, Fraction] = {}
    for name, exponent in itertools.chain.from_iterable(parts):
        total[name] = total.get(name, Fraction(0)) + exponent
    if any(abs(e) > _GREATEST or e.denominator > _GREATEST for e in total.values()):
        raise _NoUnit
    return tuple(total.items())
