"""What a page of a paper says: a row with a verdict for each published number, a picture for each figure.

The verdicts:

    reproduced         the published number comes out of published parameters and equations, within the reach
    calibrated         it comes out, but parameters that the paper does not print were chosen so that it does
    reached            a number that the paper does not print ("-") is what it was found to be before
    not reproducible   it cannot come out; the reason says why
    missed             it should come out and does not: the command fails
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from ..studies.parallel import Task

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Verdict = Literal["reproduced", "calibrated", "reached", "not reproducible", "missed"]


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
class Paper:
    """A paper: its runs, none of which needs another, and the page made of what they return, by name."""

    name: str
    runs: Callable[[], tuple[Task[Any], ...]]
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
    reason = calibrated if true else "does not hold"
    return Row(what, published, reach, obtained, _verdict(published, true, calibrated), reason)


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
    return Row(what, published, reach, shown, _verdict(published, True, calibrated), calibrated)


def _verdict(published: str, within: bool, calibrated: str) -> Verdict:
    if not within:
        return "missed"
    if calibrated:
        return "calibrated"
    return "reached" if published == "-" else "reproduced"


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}g} {unit}".rstrip()
