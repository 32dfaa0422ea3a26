"""The page of a paper: a row with a verdict for all that it prints, own numbers apart, and pictures.

The verdicts on what a paper prints are those of the table (`printed`). "missed" takes the place of a verdict
that the runs do not bear out: the command fails. Own numbers, which no paper prints, are "own" where they are
what they were found to be before, and are not counted.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...cosim.report.charts import charts
from ...cosim.report.redrawn import redrawn
from ..studies.parallel import Task
from . import parameters, printed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...cosim.results.results import Results
    from ...cosim.system.figure_spec import FigureSpec

MISSED, OWN = "missed", "own"


@dataclasses.dataclass(frozen=True)
class Found:
    """A value of the project: as shown with its unit, what is to be reached, and whether it is.

    `of` names the variant where there are several ("over the bus"), `reason` stands behind that of the row.
    `bounded` is True for a number that was held to a bound alone: it reproduces no printed number.
    """

    obtained: str
    reach: str = ""
    holds: bool = True
    reason: str = ""
    of: str = ""
    bounded: bool = False


Finding = Found | Sequence[Found]
Findings = Mapping[str, Finding]


@dataclasses.dataclass(frozen=True)
class Row:
    """A row of a page, all in words; `place` and `printed` are "" for an own number.

    `picture` is the stem of the picture that redraws a figure, or "".
    """

    place: str
    what: str
    printed: str
    reach: str
    obtained: str
    verdict: str
    reason: str = ""
    picture: str = ""


@dataclasses.dataclass(frozen=True)
class Picture:
    """A figure of the paper, redrawn, or one beyond it: `stem` names its files.

    It is drawn on first use, by `draw`, which may be in another process than the page. `write_panels` returns
    the same curves in HTML, to zoom into; None: those of the figure's own lines, if they are over time.
    """

    stem: str
    caption: str
    draw: Callable[[], Figure]
    write_panels: Callable[[], str] | None = None

    @functools.cached_property
    def figure(self) -> Figure:
        """The figure."""
        return self.draw()

    @functools.cached_property
    def panels(self) -> str:
        """The curves in HTML, or ""."""
        return self.write_panels() if self.write_panels is not None else redrawn(self.figure)

    @classmethod
    def over_time(cls, stem: str, caption: str, results: Results, spec: FigureSpec | None = None) -> Picture:
        """Return the picture of results over time, by a spec or their own one, with its panels."""
        spec = spec or results.figure
        draw = functools.partial(results.plot, spec=spec)
        return cls(stem, caption, draw, functools.partial(charts, results, spec, search=False))


@dataclasses.dataclass(frozen=True)
class Page:
    """The content of one paper's page. `about` is a paragraph; `commands` do the same runs by hand."""

    name: str
    title: str
    source: str
    about: str
    rows: tuple[Row, ...]
    own: tuple[Row, ...]
    pictures: tuple[Picture, ...]
    commands: tuple[str, ...]

    @property
    def missed(self) -> tuple[Row, ...]:
        """The rows, own ones too, whose verdict is "missed"."""
        return tuple(row for row in (*self.rows, *self.own) if row.verdict == MISSED)


@dataclasses.dataclass(frozen=True)
class Paper:
    """A paper: its independent runs, and the functions from their return values, by name, to the page.

    The pictures of the page are those of `pictures`, which draws none before it is looked at.
    """

    name: str
    runs: Callable[[], tuple[Task[Any], ...]]
    page: Callable[[dict[str, Any]], Page]
    pictures: Callable[[dict[str, Any]], Sequence[Picture]]


def page(
    name: str,
    *,
    title: str,
    about: str,
    found: Findings,
    own: Findings,
    pictures: Sequence[Picture],
    commands: Sequence[str],
) -> Page:
    """Return the page of a paper: `found` by the keys of its rows in the table, own numbers by their names.

    Raises KeyError as `judged` does.
    """
    return Page(
        name=name,
        title=title,
        source=printed.papers()[name].citation,
        about=about,
        rows=judged(name, found, pictures),
        own=tuple(_row("", what, "", OWN, "", _several(each)) for what, each in own.items()),
        pictures=tuple(pictures),
        commands=tuple(commands),
    )


def judged(paper: str, found: Findings, pictures: Sequence[Picture]) -> tuple[Row, ...]:
    """Return the rows of a paper's page: those of the table with what was found for their keys.

    Raises KeyError where a row finds nothing by its key or picture, and where something found has no row, and
    ValueError where a printed number would come out by staying on one side of a bound.
    """
    table = printed.rows(paper)
    stems = {picture.stem for picture in pictures}
    if unused := found.keys() - {row.by for row in table}:
        raise KeyError(f"{paper}: no row of printed.toml is obtained by {', '.join(sorted(unused))}")
    return tuple(_judged(row, _all_of(row, found, stems)) for row in table)


def _all_of(row: printed.Printed, found: Findings, stems: set[str]) -> list[Found]:
    if row.picture and row.picture not in stems:
        raise KeyError(f"{row}: there is no picture {row.picture!r}")
    if row.by and row.by not in found:
        raise KeyError(f"{row}: nothing was found by {row.by!r}")
    values = list(_several(found[row.by])) if row.by else []
    if row.comes_out and row.kind == "number" and not row.bound and any(value.bounded for value in values):
        raise ValueError(f"{row}: a printed number is not {row.verdict} by staying on one side of a bound")
    values += _parameters(row)
    if row.picture:
        values.append(Found("redrawn"))
    return [*values, Found(row.where)] if row.where else values


def _parameters(row: printed.Printed) -> list[Found]:
    """Return the parameters of a row, those of one value together."""
    by_value: dict[tuple[str, bool], list[str]] = {}
    for path in row.parameters:
        name, value, same = parameters.compared(path, row)
        by_value.setdefault((value, same), []).append(name)
    return [
        Found(f"{', '.join(names)} = {value}", "as printed", same)
        for (value, same), names in by_value.items()
    ]


def _judged(row: printed.Printed, values: Sequence[Found]) -> Row:
    made = _row(row.at, row.quantity, row.shown, row.verdict, row.reason, values)
    return dataclasses.replace(made, picture=row.picture)


def _several(finding: Finding) -> Sequence[Found]:
    return [finding] if isinstance(finding, Found) else finding


def _row(place: str, what: str, shown: str, verdict: str, reason: str, values: Sequence[Found]) -> Row:
    good = all(value.holds for value in values)
    reasons = [reason, *dict.fromkeys(value.reason for value in values)]
    missed = ["outside what was to be reached"] if not good else []
    return Row(
        place,
        what,
        shown,
        "; ".join(dict.fromkeys(value.reach for value in values if value.reach)),
        "; ".join(f"{value.of}: {value.obtained}" if value.of else value.obtained for value in values),
        verdict if good else MISSED,
        "; ".join(filter(None, missed or reasons)),
    )


def near(
    obtained: float, target: float, tolerance: float, unit: str = "", *, digits: int = 4, of: str = "",
    reason: str = "",
) -> Found:  # fmt: skip # as the two below
    """Return a number that must be within `tolerance` of `target`."""
    reach = f"{_number(target, digits, unit)} ± {tolerance:g}"
    return _found(obtained, reach, abs(obtained - target) <= tolerance, unit, digits, of, reason)


def at_most(
    obtained: float, limit: float, unit: str = "", *, digits: int = 4, of: str = "", reason: str = ""
) -> Found:
    """Return a number that must not exceed `limit`."""
    reach = f"≤ {_number(limit, digits, unit)}"
    found = _found(obtained, reach, obtained <= limit, unit, digits, of, reason)
    return dataclasses.replace(found, bounded=True)


def at_least(
    obtained: float, limit: float, unit: str = "", *, digits: int = 4, of: str = "", reason: str = ""
) -> Found:
    """Return a number that must not fall below `limit`."""
    reach = f"≥ {_number(limit, digits, unit)}"
    found = _found(obtained, reach, obtained >= limit, unit, digits, of, reason)
    return dataclasses.replace(found, bounded=True)


def apart(
    distance: float, tolerance: float, unit: str = "", *, digits: int = 4, of: str = "", reason: str = ""
) -> Found:
    """Return the largest distance from what is printed, that must not exceed `tolerance`."""
    return dataclasses.replace(
        at_most(distance, tolerance, unit, digits=digits, of=of, reason=reason), bounded=False
    )


def holds(obtained: str, true: bool, reach: str = "", *, of: str = "", reason: str = "") -> Found:
    """Return a statement: `obtained` in words, and `true` if it satisfies `reach`."""
    return Found(obtained, reach, true, reason, of)


def _found(obtained: float, reach: str, within: bool, unit: str, digits: int, of: str, reason: str) -> Found:
    good = within and not math.isnan(obtained)
    return Found(_number(obtained, digits, unit), reach, good, reason, of)


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}g} {unit}".rstrip()
