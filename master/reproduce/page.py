"""The page of a paper: a row with a verdict for each published number, a picture for each figure.

The verdicts:

    reproduced         the published number results from published parameters and equations, within the reach
    calibrated         it results, but parameters that the paper does not print were chosen so that it does
    reached            a number that the paper does not print ("-") is equal to the one obtained before
    not reproducible   it cannot result; the reason is given
    missed             it should result and does not: the command fails
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, get_args

from ..studies.parallel import Task

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Verdict = Literal["reproduced", "calibrated", "reached", "not reproducible", "missed"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


@dataclasses.dataclass(frozen=True)
class PublishedNumber:
    """A number or statement of a paper: its name, as published, to be reached, as obtained, and the verdict.

    All are texts with units of measure; `published` is "-" for a number that the paper does not print.
    """

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
    """The content of one paper's page. `about` is a paragraph; `commands` do the same runs by hand."""

    name: str
    title: str
    source: str
    about: str
    rows: tuple[PublishedNumber, ...]
    pictures: tuple[Picture, ...]
    commands: tuple[str, ...]

    @property
    def missed(self) -> tuple[PublishedNumber, ...]:
        """The rows whose verdict is "missed"."""
        return tuple(row for row in self.rows if row.verdict == "missed")


@dataclasses.dataclass(frozen=True)
class Paper:
    """A paper: its independent runs, and the function from their return values, by name, to the page."""

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
) -> PublishedNumber:
    """Return a number that must be within `tolerance` of `target`; `calibrated` names the choices for it."""
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
) -> PublishedNumber:
    """Return a number that must not exceed `limit`."""
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
) -> PublishedNumber:
    """Return a number that must not fall below `limit`."""
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


def holds(
    what: str, published: str, reach: str, obtained: str, true: bool, *, calibrated: str = ""
) -> PublishedNumber:
    """Return a statement: `obtained` in words, and `true` if it satisfies `reach`."""
    reason = calibrated if true else "does not hold"
    return PublishedNumber(what, published, reach, obtained, _verdict(published, true, calibrated), reason)


def not_reproducible(what: str, published: str, obtained: str, reason: str) -> PublishedNumber:
    """Return a printed number that cannot result, with the one that does."""
    return PublishedNumber(what, published, "-", obtained, "not reproducible", reason)


def _judged(
    what: str,
    published: str,
    reach: str,
    obtained: float,
    within: bool,
    unit: str,
    digits: int,
    calibrated: str,
) -> PublishedNumber:
    shown = _number(obtained, digits, unit)
    if math.isnan(obtained) or not within:
        return PublishedNumber(what, published, reach, shown, "missed", "outside what was to be reached")
    return PublishedNumber(what, published, reach, shown, _verdict(published, True, calibrated), calibrated)


def _verdict(published: str, within: bool, calibrated: str) -> Verdict:
    if not within:
        return "missed"
    if calibrated:
        return "calibrated"
    return "reached" if published == "-" else "reproduced"


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}g} {unit}".rstrip()
