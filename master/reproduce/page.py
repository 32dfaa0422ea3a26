"""What a page of a paper says: a row with a verdict for each published number, a picture for each figure.

The verdicts:

    reproduced         the number comes out of published parameters and equations, within the reach
    calibrated         it comes out, but parameters that the paper does not print were chosen so that it does
    not reproducible   it cannot come out; the reason says why
    missed             it should come out and does not: the command fails
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Verdict = Literal["reproduced", "calibrated", "not reproducible", "missed"]


@dataclasses.dataclass(frozen=True)
class Row:
    """One number: what it is, as published, what was to be reached, as obtained, and the verdict."""

    what: str
    published: str
    reach: str
    obtained: str
    verdict: Verdict
    reason: str = ""


@dataclasses.dataclass(frozen=True)
class Picture:
    """A figure of the paper, redrawn: `stem` names its files."""

    stem: str
    caption: str
    figure: Figure


@dataclasses.dataclass(frozen=True)
class Page:
    """All of one paper. `about` is one paragraph; `commands` are those that give the same runs by hand."""

    name: str
    title: str
    source: str
    about: str
    rows: tuple[Row, ...]
    pictures: tuple[Picture, ...]
    commands: tuple[str, ...]

    @property
    def missed(self) -> tuple[Row, ...]:
        """The rows that should have been reached."""
        return tuple(row for row in self.rows if row.verdict == "missed")


@dataclasses.dataclass(frozen=True)
class Run:
    """A piece of work that needs no other: `function(*arguments, **options)`, all of it picklable."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    options: dict[str, Any] = dataclasses.field(default_factory=dict)

    def __call__(self) -> Any:
        return self.function(*self.arguments, **self.options)


@dataclasses.dataclass(frozen=True)
class Paper:
    """A paper: the runs that it needs, by name, and the page that is made of what they return."""

    name: str
    runs: Callable[[], dict[str, Run]]
    page: Callable[[dict[str, Any]], Page]


def near(
    what: str,
    published: str,
    obtained: float,
    target: float,
    tolerance: float,
    unit: str = "",
    *,
    digits: int = 4,
    calibrated: str = "",
) -> Row:
    """A number that must come within `tolerance` of `target`; `calibrated` says what was chosen for it."""
    reach = f"{_number(target, digits, unit)} ± {tolerance:g}"
    return _judged(
        what, published, reach, obtained, abs(obtained - target) <= tolerance, unit, digits, calibrated
    )


def at_most(
    what: str,
    published: str,
    obtained: float,
    limit: float,
    unit: str = "",
    *,
    digits: int = 4,
    calibrated: str = "",
) -> Row:
    """A number that must not exceed `limit`."""
    return _judged(
        what,
        published,
        f"≤ {_number(limit, digits, unit)}",
        obtained,
        obtained <= limit,
        unit,
        digits,
        calibrated,
    )


def at_least(
    what: str,
    published: str,
    obtained: float,
    limit: float,
    unit: str = "",
    *,
    digits: int = 4,
    calibrated: str = "",
) -> Row:
    """A number that must not fall below `limit`."""
    return _judged(
        what,
        published,
        f"≥ {_number(limit, digits, unit)}",
        obtained,
        obtained >= limit,
        unit,
        digits,
        calibrated,
    )


def holds(what: str, published: str, reach: str, obtained: str, true: bool, *, calibrated: str = "") -> Row:
    """A statement: `obtained` in words, `true` if it is what `reach` asks for."""
    verdict: Verdict = "missed" if not true else "calibrated" if calibrated else "reproduced"
    return Row(what, published, reach, obtained, verdict, calibrated if true else "does not hold")


def not_reproducible(what: str, published: str, obtained: str, reason: str) -> Row:
    """A printed number that cannot come out, with the one that does."""
    return Row(what, published, "-", obtained, "not reproducible", reason)


def _judged(
    what: str,
    published: str,
    reach: str,
    obtained: float,
    within: bool,
    unit: str,
    digits: int,
    calibrated: str,
) -> Row:
    shown = _number(obtained, digits, unit)
    if math.isnan(obtained) or not within:
        return Row(what, published, reach, shown, "missed", "outside what was to be reached")
    return Row(what, published, reach, shown, "calibrated" if calibrated else "reproduced", calibrated)


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}g} {unit}".rstrip()
