"""Braking control and speed estimation of a two-wheeler: Table I, both propositions, delay and vehicle."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ...models import braking_analysis as analysis
from ...models.road_friction import Road
from ..simulation import simulate
from ..studies.parallel import Task
from .braking_pictures import pictures
from .braking_runs import (
    CONTROLLED,
    FACTORS,
    FINE_STEP,
    MARGIN,
    NOMINAL,
    STARTS,
    Propositions,
    heavy,
    high,
    late,
    lock_of,
    propositions,
    stop_of,
    stops,
)
from .page import Page, Paper, PublishedNumber, at_most, holds, near

_SOURCE = (
    "M. Tanelli, M. Prandini, F. Codecà, A. Moia, S. M. Savaresi, Analysing the interaction between braking "
    "control and speed estimation: the case of two-wheeled vehicles, IEEE CDC 2008"
)
_FITTED = "vehicle and PID gains, which the paper does not print, were chosen for Table I"
_NAMES = {
    "known_speed": "(a) full slip control, speed known",
    "estimated_speed": "(b) full slip control, speed estimated",
    "front_only": "(c) front brake only",
    "front_compensated": "(d) front brake, rear wheel compensated",
}
_END = (
    "ideal signals; below 2 m/s torques are frozen and half a newton meter decides whether a wheel locks: "
    "over the bus (c) locks there without the delay too"
)
_EXTRA = (0.0, 0.01, 0.02, 0.03)  # s
_HEIGHTS = (0.8, 0.9, 1.0, 1.1, 1.2)  # share of h
_INERTIAS = (0.5, 0.75, 1.0, 1.5)  # share of J


def _runs() -> tuple[Task[Any], ...]:
    return (
        *(Task(name, simulate, ("braking", name)) for name in _NAMES),
        *(Task(f"{name}, ideal", simulate, ("braking", name), {"ideal": True}) for name in _NAMES),
        *(Task(f"{steps} late", simulate, ("braking",), _late(steps)) for steps in (1, 2)),
        *(Task(f"height {name}", stops, (name, [high(x) for x in _HEIGHTS])) for name in CONTROLLED),
        *(Task(f"inertia {name}", stops, (name, [heavy(x) for x in _INERTIAS])) for name in CONTROLLED),
        *(
            Task(f"fine {name}", stops, (name, [heavy(x) for x in _INERTIAS], FINE_STEP))
            for name in CONTROLLED
        ),
        *(Task(f"delay {name}", stops, (name, [late(x) for x in _EXTRA])) for name in CONTROLLED),
        *(Task(_on(road), propositions, (road,)) for road in Road),
    )


def _late(steps: int) -> dict[str, Any]:
    return {"ideal": True, "parameters": late(0.01 * steps), "stop_time": 3.5}


def _on(road: Road) -> str:
    return f"propositions on {road.name.lower()}"


def _page(found: dict[str, Any]) -> Page:
    return Page(
        name="braking",
        title="Slip control and speed estimation of a braking two-wheeler",
        source=_SOURCE,
        about=(
            "A two-wheeler brakes from 100 km/h to standstill; the set point of the slip is 0.22. Its speed "
            "is known (a) or taken to be that of the fastest wheel (b, c, d). The paper prints neither the "
            "vehicle nor the gains: they were chosen so that the stopping distances of Table I come out, "
            "which is why these are calibrated; the lock and the propositions were fitted to nothing. The "
            "pictures are in the order of the text (friction, Psi, maneuvers); of the paper's figures only "
            "the number of Fig. 3 is sure, and no printed numbers tell how near the curves are."
        ),
        rows=(*_table_rows(found), *_proposition_rows(found), *_delay_rows(found), *_vehicle_rows(found)),
        pictures=pictures(found, _EXTRA, _HEIGHTS, _INERTIAS),
        commands=(
            "evcosim run braking",
            "evcosim run braking -s estimated_speed",
            "evcosim run braking -s front_only",
            "evcosim run braking -s front_compensated",
            "evcosim run braking -s delayed",
        ),
    )


def _table_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    rows = []
    for variant, suffix in (("over the bus", ""), ("ideal signals", ", ideal")):
        a, c, d = (stop_of(found[name + suffix]).distance for name in CONTROLLED)
        rows += [
            _stop_row("known_speed", variant, "33.34 m", a, 33.34, 0.3),
            _lock_row(found["estimated_speed" + suffix], variant),
            _stop_row("front_only", variant, "51.32 m", c, 51.32, 0.3),
            _longer_row("front_only", variant, "+54 %", c / a, 54.0),
            _stop_row("front_compensated", variant, "46.4 m", d, 46.4, 0.5),
            _longer_row("front_compensated", variant, "+39.2 %", d / a, 39.0),
        ]
    return rows


def _stop_row(
    name: str, variant: str, published: str, distance: float, target: float, tolerance: float
) -> PublishedNumber:
    what = f"{_NAMES[name]}: stopping distance, {variant}"
    return near(what, published, distance, target, tolerance, "m", calibrated=_FITTED)


def _longer_row(name: str, variant: str, published: str, ratio: float, target: float) -> PublishedNumber:
    what = f"{_NAMES[name]}: longer than (a), {variant}"
    return near(what, published, 100.0 * (ratio - 1.0), target, 1.5, "%", digits=3, calibrated=_FITTED)


def _lock_row(results: Any, variant: str) -> PublishedNumber:
    lock = lock_of(results)
    return holds(
        f"{_NAMES['estimated_speed']}: {variant}",
        "wheels lock",
        "both slips > 0.99 within 1 s, above 15 m/s, to standstill",
        f"both after {lock.time:.2f} s at {lock.speed:.1f} m/s, {'' if lock.stays else 'not '}to standstill",
        lock.time <= 1.0 and lock.speed > 15.0 and lock.stays,
    )


def _proposition_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    k = analysis.k_bar(NOMINAL)
    by_road: dict[str, Propositions] = {road.name.lower(): found[_on(road)] for road in Road}
    rows = [
        near("critical gain k̄_f", "-", k.front, 324.5, 3.245, "N·m per slip"),
        near("critical gain k̄_r", "-", k.rear, 135.1, 1.351, "N·m per slip"),
    ]
    for i, factor in enumerate(FACTORS):
        counts = {x.equilibria[i] for x in by_road.values()}
        rows += [
            at_most(
                f"Proposition 3.1, {factor:g} k̄: spread of {STARTS} random starts at the end, four roads",
                "attracts every start",
                max(x.spread[i] for x in by_road.values()),
                1e-6,
                digits=2,
            ),
            holds(
                f"Proposition 3.1, {factor:g} k̄: equilibria on each road",
                "one",
                "1",
                ", ".join(str(x.equilibria[i]) for x in by_road.values()),
                counts == {1},
            ),
        ]
    rows.append(
        holds(
            f"Proposition 3.2, k λ* = {MARGIN:g} max Ψ, speed of the fastest wheel: starts that lock",
            "both wheels lock",
            f"{STARTS} of {STARTS} on each road",
            ", ".join(f"{name} {x.locked}" for name, x in by_road.items()),
            all(x.locked == STARTS for x in by_road.values()),
        )
    )
    return rows


def _delay_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    one, two = (stop_of(found[f"{steps} late"]).distance for steps in (1, 2))
    rows = [
        near("(a), brakes one step of 10 ms later: stopping distance", "-", one, 33.85, 0.1, "m"),
        near("(a), brakes two steps later: stopping distance", "-", two, 36.3, 0.15, "m"),
    ]
    return [*rows, *(_late_lock_row(name, found) for name in CONTROLLED[1:])]


def _late_lock_row(name: str, found: dict[str, Any]) -> PublishedNumber:
    soon, late_stop = (found[f"delay {name}"][_EXTRA.index(x)] for x in (0.0, 0.02))
    lock = "does not lock" if math.isnan(late_stop.lock_speed) else f"locks at {late_stop.lock_speed:.1f} m/s"
    row = holds(
        f"{_NAMES[name]}, brakes two steps later: front wheel",
        "-",
        "slip swings beyond 0.5 above 5 m/s and locks in the end, neither without the delay",
        f"up to {late_stop.swing:.2f} (without {soon.swing:.2f}), {lock}; {late_stop.distance:.1f} m",
        late_stop.swing > 0.5 > soon.swing
        and math.isnan(soon.lock_speed)
        and not math.isnan(late_stop.lock_speed),
    )
    return row if row.verdict == "missed" else dataclasses.replace(row, reason=_END)


def _vehicle_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    return [
        _three(found, "height", _HEIGHTS.index(1.1), "h + 10 %", (33.35, 47.80, 42.99), 0.05),
        _three(found, "height", _HEIGHTS.index(0.9), "h - 10 %", (33.33, 54.82, 49.88), 0.05),
        _three(
            found, "fine", _INERTIAS.index(0.5), "J - 50 %, controller at 1 kHz", (33.29, 48.86, 46.44), 0.15
        ),
    ]


def _three(
    found: dict[str, Any], kind: str, i: int, what: str, expected: tuple[float, ...], tolerance: float
) -> PublishedNumber:
    seen = [found[f"{kind} {name}"][i].distance for name in CONTROLLED]
    return holds(
        f"{what}: stopping distance of (a), (c), (d)",
        "-",
        f"{' / '.join(f'{x:.2f}' for x in expected)} m ± {tolerance:g}",
        f"{' / '.join(f'{x:.2f}' for x in seen)} m",
        all(abs(x - y) <= tolerance for x, y in zip(seen, expected, strict=True)),
    )


PAPER = Paper("braking", _runs, _page)
