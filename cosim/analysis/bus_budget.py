"""The bus budget of a system: its own metric over what a bus does to signals, each by itself.

Varied are delay, resolution and cycle, and if it is wanted timing, jitter and lost frames.

A point is one run, or one for each of several seeds, with a variation of all buses
(`bus_settings.BusVariation`); the nominal point, the system as its file says, is one of each series. A point
is broken when the metric is beyond the limit or has no value, and failed when its run was: an FMU refused, or
diverged to what is no number.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from collections.abc import Sequence
from typing import Any, Literal

from ..can.bus_settings import BusVariation
from ..results.metrics import Metric
from ..visible import visible
from ..writing import finite, markdown_table

_QUANTILE = 0.8


@dataclasses.dataclass(frozen=True)
class Point:
    """One run: the change of the buses, in words and as it is; the metric, or NaN and the `reason` why.

    `failed`: it is the run that has failed. A point of chance is several runs, with the `seeds` from that of
    `bus` on: `value` is the worst of their `values`, NaN if one has none, and `quantile` that which 80 % of
    them are not worse than.
    """

    label: str
    bus: BusVariation
    value: float = math.nan
    reason: str = ""
    failed: bool = False
    seeds: int = 1
    values: tuple[float, ...] = ()
    quantile: float = math.nan

    def runs(self) -> list[BusVariation]:
        """Return the variation of each of its runs."""
        return [dataclasses.replace(self.bus, seed=self.bus.seed + n) for n in range(self.seeds)]

    def of_seeds(self, found: Sequence[Point], kind: Literal["max", "min"]) -> Point:
        """Return the point with the values of its runs, of which `found` are the points."""
        if len(found) == 1:
            return dataclasses.replace(self, **_outcome(found[0]))
        sign = 1.0 if kind == "max" else -1.0
        ordered = sorted(found, key=lambda p: math.inf if math.isnan(p.value) else sign * p.value)
        return dataclasses.replace(
            self,
            **_outcome(ordered[-1]),
            values=tuple(point.value for point in found),
            quantile=ordered[math.ceil(_QUANTILE * len(ordered)) - 1].value,
        )


def _outcome(point: Point) -> dict[str, Any]:
    return {"value": point.value, "reason": point.reason, "failed": point.failed}


@dataclasses.dataclass(frozen=True)
class Series:
    """The points of one variation, from the best bus to the worst."""

    name: str
    points: tuple[Point, ...]

    @property
    def nominal(self) -> int:
        """The index of the point at which the system is as it is."""
        return next(i for i, point in enumerate(self.points) if point.bus == BusVariation())


def series(step_size: float) -> tuple[Series, ...]:
    """Return the points to run, without values.

    They are 0 to 3 steps of `step_size` [s] more delay; signals not quantized, as in the DBC, 2, 4 and 8
    times as coarse; messages 1, 2, 4 and 8 times as seldom.
    """
    times = (1, 2, 4, 8)
    return (
        Series(
            "bus delay", tuple(Point(_delay(n, step_size), BusVariation(delay_steps=n)) for n in range(4))
        ),
        Series(
            "signal resolution",
            (
                Point("ideal", BusVariation(resolution="ideal")),
                *(Point("DBC" if n == 1 else f"DBC x {n}", BusVariation(resolution=float(n))) for n in times),
            ),
        ),
        Series("message cycle", tuple(Point(f"x {n}", BusVariation(cycle=n)) for n in times)),
    )


def chance_series(timing: str, shortest: float, seeds: int) -> tuple[Series, ...]:
    """Return the points of chance to run, without values, over so many seeds.

    They are the `timing` of the buses and "frame", with a jitter of 25, 50 and 90 % of the `shortest` [s]
    cycle time; and frames that are lost with 1, 5, 10 and 20 %.
    """
    frame = BusVariation(timing="frame")
    shares = (0.25, 0.5, 0.9)
    return (
        Series(
            "timing and jitter",
            (
                Point(timing, BusVariation()),
                *((Point("frame", frame),) if timing == "instant" else ()),
                *(
                    Point(
                        f"jitter {1000.0 * share * shortest:g} ms",
                        dataclasses.replace(frame, jitter=share * shortest),
                        seeds=seeds,
                    )
                    for share in shares
                ),
            ),
        ),
        Series(
            "lost frames",
            (
                Point("0 %", BusVariation()),
                *(
                    Point(f"{percent} %", BusVariation(loss=percent / 100), seeds=seeds)
                    for percent in (1, 5, 10, 20)
                ),
            ),
        ),
    )


def _delay(steps: int, step_size: float) -> str:
    if not steps:
        return "+0 steps"
    return f"+{steps} step{'' if steps == 1 else 's'} ({1000.0 * steps * step_size:g} ms)"


@dataclasses.dataclass(frozen=True)
class Budget:
    """The outcome: the series, and the metric in `unit` that judges them with its limit, upper or lower."""

    system: str
    scenario: str
    metric: str
    unit: str
    limit: float
    kind: Literal["max", "min"]
    series: tuple[Series, ...]

    def broken(self, point: Point) -> bool:
        """Return whether the metric is beyond the limit, or there is none: a failed point is broken too."""
        return not (point.value <= self.limit if self.kind == "max" else point.value >= self.limit)

    def first_broken(self, series: Series) -> Point | None:
        """Return the first broken point from the nominal one on, or None."""
        return next((p for p in series.points[series.nominal :] if self.broken(p)), None)

    def summary(self, series: Series) -> str:
        """Return in a few words at which point a series breaks, or its run fails."""
        first, nominal = self.first_broken(series), series.points[series.nominal]
        if first is nominal:
            said = f"{_state(first)} as it is"
        elif first is not None:
            said = f"{'fails' if first.failed else 'breaks'} at {first.label}"
        else:
            said = f"holds up to {series.points[-1].label}"
        better = [p for p in series.points[: series.nominal] if self.broken(p) and first is not nominal]
        return said + "".join(f"; {_state(point)} at {point.label} too" for point in better)

    @property
    def rule(self) -> str:
        """The requirement, in words."""
        limit = Metric("", self.limit, self.unit).text
        return f"{self.metric}: at {'most' if self.kind == 'max' else 'least'} {limit}"

    def text(self, point: Point) -> str:
        """Return the value of a point with its unit; of several seeds the worst and the quantile."""
        worst = "-" if math.isnan(point.value) else Metric("", point.value, self.unit).text
        if not point.values or math.isnan(point.quantile):
            return worst
        return f"{worst} ({_QUANTILE:.0%}: {Metric('', point.quantile, self.unit).text})"

    def verdict(self, point: Point) -> str:
        """Return "holds", "broken" or "failed", the last one with the first line of the reason."""
        if not self.broken(point):
            return "holds"
        reason = point.reason.strip().splitlines()
        return f"{_state(point)}: {reason[0]}" if reason else _state(point)

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Return series, point (* the nominal one), value and verdict of every point."""
        return [
            (
                each.name if i == 0 else "",
                f"{point.label} *" if i == each.nominal else point.label,
                self.text(point),
                self.verdict(point),
            )
            for each in self.series
            for i, point in enumerate(each.points)
        ]


def _state(point: Point) -> str:
    return "failed" if point.failed else "broken"


def as_data(budget: Budget) -> dict[str, Any]:
    """Return the budget for JSON: a value that there is not is None."""
    keys = ("system", "scenario", "metric", "unit", "limit", "kind")
    return {key: getattr(budget, key) for key in keys} | {
        "series": [
            {
                "name": each.name,
                "summary": budget.summary(each),
                "first_broken": _label(budget.first_broken(each)),
                "points": [_point(budget, point) for point in each.points],
            }
            for each in budget.series
        ]
    }


def _label(point: Point | None) -> str | None:
    return None if point is None else point.label


def _point(budget: Budget, point: Point) -> dict[str, Any]:
    return {
        "label": point.label,
        "nominal": point.bus == BusVariation(),
        "bus": dataclasses.asdict(point.bus),
        "value": finite(point.value),
        "seeds": finite(point.values),
        "quantile": finite(point.quantile),
        "broken": budget.broken(point),
        "failed": point.failed,
        "reason": point.reason,
    }


def as_csv(budget: Budget) -> str:
    """Return a line for each run: series, point, seed, and the value in the metric's unit or nothing."""
    rows = [("series", "point", "seed", f"{budget.metric} [{budget.unit}]")]
    for each in budget.series:
        for point in each.points:
            for n, value in enumerate(point.values or (point.value,)):
                shown = repr(value) if math.isfinite(value) else ""
                rows.append((each.name, point.label, str(point.bus.seed + n), shown))
    file = io.StringIO()
    csv.writer(file, lineterminator="\n").writerows(rows)
    return file.getvalue()


def as_markdown(budget: Budget, figure: str) -> str:
    """Return a page: the requirement, where each series breaks, the table, the figure in file `figure`."""
    name = " ".join(part for part in (budget.system, budget.scenario) if part)
    headers, *rows = _without_emphasis([("variation", "", budget.metric, "verdict"), *budget.rows()])
    return visible(
        "\n".join(
            [
                f"# Bus budget of {name}",
                "",
                f"{budget.rule}. Each variation by itself; * is the system as it is.",
                "",
                *(f"- {each.name}: {budget.summary(each)}" for each in budget.series),
                "",
                *markdown_table(headers, rows),
                "",
                f"![{budget.metric} over each variation]({figure})",
                "",
            ]
        )
    )


def _without_emphasis(rows: Sequence[Sequence[str]]) -> list[list[str]]:
    return [[cell.replace("*", "\\*") for cell in row] for row in rows]
