"""The table of all that the papers print, printed.toml: a row for each number, figure, table entry and claim.

A row says where it stands, what is printed, the verdict, and how the project's own value is obtained. The
pages are made of it, the counts are taken from it, and what is marked "published" anywhere must have a row.
docs/papers/README.md describes the keys.
"""

from __future__ import annotations

import dataclasses
import functools
import re
import tomllib
from collections.abc import Iterable, Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any, Literal, get_args

from ...cosim.figures.text import pretty

Kind = Literal["number", "equation", "figure", "claim"]
Verdict = Literal["reproduced", "calibrated", "by construction", "not reproducible"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)

FILE = Path(__file__).with_name("printed.toml")

_ABOUT_VERDICTS = {
    "reproduced": "follows from what the paper prints, or was fitted to nothing",
    "calibrated": "comes out because parameters that the paper does not print were chosen for it",
    "by construction": "is put in as printed, so that it cannot fail to come out",
    "not reproducible": "cannot come out, for the reason given",
}
_SECTION = re.compile(r"[IVX]+(-[A-D])?|\d+(\.\d+)?")


@dataclasses.dataclass(frozen=True)
class Source:
    """A paper: its system, authors, title and where it was published, as far as they are known."""

    name: str
    citation: str


@dataclasses.dataclass(frozen=True)
class Printed:
    """A row of the table. `value` is a number, a text, or a list (a matrix: of lists) of numbers.

    Four say how the project's value is obtained: `by`, the key of what the module of the paper
    computes; `parameters`, model parameters ("scooter.Scooter.mass") that must have the value; `picture`, the
    stem of the picture; `where`, words that say where the statement stands in the project. `bound` is the
    sign of a number that the paper itself prints as a bound: "≤" or "≥".
    """

    paper: str
    place: str
    kind: Kind
    quantity: str
    value: Any
    verdict: Verdict
    unit: str = ""
    reason: str = ""
    by: str = ""
    parameters: tuple[str, ...] = ()
    picture: str = ""
    where: str = ""
    bound: Literal["", "≤", "≥"] = ""

    def __post_init__(self) -> None:
        """Raise ValueError for a row that lacks its reason or its way, or has an unknown word."""
        if self.kind not in get_args(Kind) or self.verdict not in VERDICTS:
            raise ValueError(f"{self}: kind or verdict is unknown")
        if self.bound not in ("", "≤", "≥"):
            raise ValueError(f"{self}: bound must be ≤ or ≥")
        if not (self.by or self.parameters or self.picture or self.where):
            raise ValueError(f"{self}: nothing says how the project's value is obtained")
        if self.where and self.comes_out:
            raise ValueError(f"{self}: words alone reproduce nothing")
        if not self.reason and self.verdict in ("calibrated", "not reproducible"):
            raise ValueError(f"{self}: this verdict needs a reason")

    def __str__(self) -> str:
        """Return paper, place and quantity."""
        return f"{self.paper}, {self.place}: {self.quantity}"

    @property
    def shown(self) -> str:
        """The value as printed, with its unit."""
        return f"{self.bound} {_text(self.value)} {pretty(self.unit)}".strip()

    @property
    def comes_out(self) -> bool:
        """True where the verdict says that the project's own runs give what is printed."""
        return self.verdict in ("reproduced", "calibrated")

    @property
    def at(self) -> str:
        """The place, with a § before the number of a section."""
        parts = self.place.split(", ")
        return ", ".join(f"§{part}" if _SECTION.fullmatch(part) else part for part in parts)

    @property
    def numbers(self) -> list[float]:
        """The numbers of the value, row by row; none for a text."""
        return [float(x) for x in _flat(self.value) if isinstance(x, (Decimal, int))]

    @property
    def number(self) -> float:
        """The value, where it is one number. Raises ValueError where it is not."""
        (number,) = self.numbers
        return number


@functools.cache
def papers() -> dict[str, Source]:
    """Return the papers by the name of their system, in the order of the table."""
    return {name: Source(name, about["citation"]) for name, about in _file()["papers"].items()}


@functools.cache
def rows(paper: str | None = None) -> tuple[Printed, ...]:
    """Return the rows of a paper, or all, in the order of the table."""
    found = [Printed(**row | {"parameters": tuple(row.get("parameters", ()))}) for row in _file()["row"]]
    return tuple(row for row in found if paper is None or row.paper == paper)


def row(paper: str, by: str) -> Printed:
    """Return the row of a paper that is obtained by a key. Raises KeyError where there is none, or more."""
    found = [each for each in rows(paper) if each.by == by]
    if len(found) != 1:
        raise KeyError(f"{paper}: {len(found)} rows by {by!r}")
    return found[0]


def counted(verdicts: Iterable[str]) -> dict[str, int]:
    """Return how many there are of each verdict of a paper, the best first; others are not counted."""
    given = list(verdicts)
    return {verdict: given.count(verdict) for verdict in VERDICTS}


def sentence(verdicts: Iterable[str]) -> str:
    """Return the counts in words, for the README, the index of the pages and the last line of `reproduce`."""
    counts = counted(verdicts)
    each = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    return f"{sum(counts.values())} printed numbers, equations, figures and claims: {each}"


def about_verdicts() -> dict[str, str]:
    """Return what each verdict means."""
    return dict(_ABOUT_VERDICTS)


@functools.cache
def _file() -> dict[str, Any]:
    with FILE.open("rb") as file:
        return tomllib.load(file, parse_float=Decimal)  # 0.50 stays 0.50


def _text(value: Any) -> str:
    if isinstance(value, list):
        between = "; " if value and isinstance(value[0], list) else ", "
        inner = between.join(_text(each) if not isinstance(each, list) else _row(each) for each in value)
        return f"[{inner}]"
    return str(value)


def _row(values: list[Any]) -> str:
    return " ".join(map(str, values))


def _flat(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for each in value:
            yield from _flat(each)
    else:
        yield value
