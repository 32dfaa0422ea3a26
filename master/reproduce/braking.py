"""Braking control and speed estimation of a two-wheeler: Table I, both propositions, delay and vehicle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...cosim.results.results import Results
from ...models import braking_analysis as analysis
from ...models.constants import KMH
from ...models.road_friction import Road
from ..simulation import simulate
from ..studies.parallel import Task
from . import braking_detailed as detailed
from . import braking_set_points as set_points
from . import printed
from .braking_maneuvers import CAPTIONS
from .braking_pictures import pictures
from .braking_runs import (
    CONTROLLED,
    FACTORS,
    FINE_STEP,
    MARGIN,
    NOMINAL,
    STARTS,
    Propositions,
    coupling,
    critical,
    estimate_error,
    estimated_slip,
    heavy,
    high,
    late,
    lock_of,
    propositions,
    rear_energy,
    rear_slip,
    reduced_form_error,
    stop_of,
    stops,
)
from .page import Findings, Found, Page, Paper, Picture, at_most, holds, near, page

_END = (
    "ideal signals; below 2 m/s torques are frozen and half a newton meter decides whether a wheel locks: "
    "over the bus (c) locks there without the delay too"
)
_VARIANTS = {"over the bus": "", "ideal signals": ", ideal"}
_EXTRA = (0.0, 0.01, 0.02, 0.03)  # s
_HEIGHTS = (0.8, 0.9, 1.0, 1.1, 1.2)  # share of h
_INERTIAS = (0.5, 0.75, 1.0, 1.5)  # share of J


def _runs() -> tuple[Task[Any], ...]:
    return (
        *(Task(name, simulate, ("braking", name)) for name in CAPTIONS),
        *(Task(f"{name}, ideal", simulate, ("braking", name), {"ideal": True}) for name in CAPTIONS),
        *(Task(f"{steps} late", simulate, ("braking",), _late(steps)) for steps in (1, 2)),
        *(Task(f"height {name}", stops, (name, [high(x) for x in _HEIGHTS])) for name in CONTROLLED),
        *(Task(f"inertia {name}", stops, (name, [heavy(x) for x in _INERTIAS])) for name in CONTROLLED),
        *(
            Task(f"fine {name}", stops, (name, [heavy(x) for x in _INERTIAS], FINE_STEP))
            for name in CONTROLLED
        ),
        *(Task(f"delay {name}", stops, (name, [late(x) for x in _EXTRA])) for name in CONTROLLED),
        *(Task(_on(road), propositions, (road,)) for road in Road),
        *(Task(_at(target), set_points.ends, (target,)) for target in set_points.SET_POINTS),
        *detailed.tasks(),
    )


def _late(steps: int) -> dict[str, Any]:
    return {"ideal": True, "parameters": late(0.01 * steps), "stop_time": 3.5}


def _on(road: Road) -> str:
    return f"propositions on {road.name.lower()}"


def _at(target: analysis.SetPoint) -> str:
    return f"set points {target.front:g} and {target.rear:g}"


def _pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    return pictures(found, _EXTRA, _HEIGHTS, _INERTIAS)


def _page(found: dict[str, Any]) -> Page:
    return page(
        "braking",
        title="Slip control and speed estimation of a braking two-wheeler",
        about=(
            "A two-wheeler brakes from 100 km/h to standstill; the set point of the slip is 0.22. Its speed "
            "is known (a) or taken to be that of the fastest wheel (b, c, d). The paper prints neither the "
            "vehicle nor the gains: they were chosen so that the stopping distances of Table I come out, "
            "which is why these are calibrated; the lock and the propositions were fitted to nothing. The "
            "paper's Table I and Figs. 4 to 7 come from a detailed model with suspension, elastic tires and "
            "their relaxation, of which it prints no equation; they stand here with the vehicle of its "
            "equations (1) to (5), and with such a model beside it. No numbers of the figures are printed "
            "that would tell how near the curves are."
        ),
        found={**_table(found), **_propositions(found), **_maneuvers(found)},
        own={**_critical(), **_delay(found), **_vehicle(found), **detailed.own(found)},
        pictures=_pictures(found),
        commands=(
            "evcosim run braking",
            "evcosim run braking -s estimated_speed",
            "evcosim run braking -s front_only",
            "evcosim run braking -s front_compensated",
            "evcosim run braking -s delayed",
            "evcosim run braking --fmu vehicle=DetailedTwoWheeler",
        ),
    )


def _table(found: dict[str, Any]) -> Findings:
    """Return the rows of Table I, each over the bus, with ideal signals, and with the detailed plant."""
    rows: dict[str, list[Found]] = {by: [] for by in ("(a)", "(b)", "(c)", "(d)", "(c) longer", "(d) longer")}
    for of, suffix in _VARIANTS.items():
        a, c, d = (stop_of(found[name + suffix]).distance for name in CONTROLLED)
        rows["(b)"].append(_lock(found["estimated_speed" + suffix], of))
        for by, value, tolerance in (("(a)", a, 0.3), ("(c)", c, 0.3), ("(d)", d, 0.5)):
            rows[by].append(near(value, _printed(by), tolerance, "m", of=of))
        for by, value in (("(c) longer", c), ("(d) longer", d)):
            rows[by].append(near(100.0 * (value / a - 1.0), _printed(by), 1.5, "%", digits=3, of=of))
    for by, row in detailed.table(found, {by: _printed(by) for by in rows if by != "(b)"}).items():
        rows[by].append(row)
    at_rest = [float(found[name]["vehicle.speed"][-1]) for name in (*CONTROLLED, "estimated_speed")]
    return rows | {"end speed": holds(f"{KMH * max(at_rest):g} km/h", max(at_rest) == 0.0)}


def _printed(by: str) -> float:
    return printed.row("braking", by).number


def _lock(results: Results, of: str) -> Found:
    lock = lock_of(results)
    return holds(
        f"both after {lock.time:.2f} s at {lock.speed:.1f} m/s, {'' if lock.stays else 'not '}to standstill",
        lock.time <= 1.0 and lock.speed > 15.0 and lock.stays,
        "both slips > 0.99 within 1 s, above 15 m/s, to standstill",
        of=of,
    )


def _propositions(found: dict[str, Any]) -> Findings:
    by_road: dict[str, Propositions] = {road.name.lower(): found[_on(road)] for road in Road}
    some = by_road.values()
    usual = set_points.Ends(
        max(max(x.spread) for x in some), tuple(count for x in some for count in x.equilibria)
    )
    at_others = {target: found[_at(target)] for target in set_points.SET_POINTS}
    locked = all(x.locked == STARTS for x in some)
    equilibria = [
        holds(
            ", ".join(str(x.equilibria[i]) for x in some),
            {x.equilibria[i] for x in some} == {1},
            "1 on each road",
            of=f"{factor:g} k̄",
        )
        for i, factor in enumerate(FACTORS)
    ]
    spread = [
        at_most(max(x.spread[i] for x in some), 1e-6, digits=2, of=f"{factor:g} k̄")
        for i, factor in enumerate(FACTORS)
    ]
    return {
        **set_points.findings({analysis.TARGET: usual} | at_others),
        "3.1 equilibria": equilibria,
        "3.1 spread": spread,
        "3.2": holds(
            f"k λ* = {MARGIN:g} max Ψ: {', '.join(f'{name} {x.locked}' for name, x in by_road.items())}",
            locked,
            f"{STARTS} of {STARTS} on each road",
        ),
        "both": holds(
            "Propositions 3.1 and 3.2", locked and all(each.holds for each in (*equilibria, *spread)), "both"
        ),
        "remark 3.1": _nearing(),
        "coupling": _coupling(),
        "reduced": at_most(reduced_form_error(), 1e-12, "m/s²", digits=2),
        "k-bar": _gains(),
    }


def _nearing() -> Found:
    away = []
    for factor in (*FACTORS, 100.0):
        (rest,) = analysis.equilibria(NOMINAL, critical(factor))
        away.append(max(abs(slip - analysis.TARGET_SLIP) for slip in rest))
    shown = ", ".join(f"{x:.3f}" for x in away)
    return holds(
        f"{shown} at 1.05, 10 and 100 k̄", away[0] > away[1] > away[2] > 0.0 and away[2] < 0.02, "falls to 0"
    )


def _coupling() -> Found:
    front, rear = coupling()
    return holds(
        f"{100 * front:.0f} % and {100 * rear:.0f} %", front < 0.5 * rear, "front below half of rear"
    )


def _gains() -> Found:
    k = analysis.k_bar(NOMINAL)
    return Found(f"{k.front:.1f} and {k.rear:.1f} N·m per slip")


def _maneuvers(found: dict[str, Any]) -> Findings:
    """Return what the paper says of Figs. 4 to 7, of runs with ideal signals."""
    known, front, compensated = (found[f"{name}, ideal"] for name in CONTROLLED)
    slip = rear_slip(front)
    worked, lost = rear_energy(front)
    held = max(
        abs(stop_of(found[name]).swing - analysis.TARGET_SLIP)
        for name in ("known_speed", "known_speed, ideal")
    )
    return {
        "pid": holds(
            f"held within {held:.3f}; {_lock(found['estimated_speed'], '').obtained}",
            held < 0.15 and lock_of(found["estimated_speed"]).stays,
            "held within 0.15 above 5 m/s; locked to standstill",
        ),
        "estimates": at_most(estimated_slip(known), 0.01, digits=2),
        "free wheel": at_most(100.0 * estimate_error(front), 1.0, "% of the speed", digits=2),
        "rear slip": holds(f"{slip.min():.4f} to {slip.max():.4f}", bool(slip.max() < 0.0), "below 0"),
        "rear energy": holds(
            f"{worked:.0f} J and {lost:.0f} J", abs(worked / lost - 1.0) <= 1e-3, "equal within 0.1 %"
        ),
        "no rear slip": at_most(float(np.abs(rear_slip(compensated)).max()), 1e-3, digits=2),
    }


def _critical() -> Findings:
    k = analysis.k_bar(NOMINAL)
    return {
        "critical gain k̄_f": near(k.front, 324.5, 0.1, "N·m per slip"),
        "critical gain k̄_r": near(k.rear, 135.19, 0.05, "N·m per slip", digits=5),
    }


def _delay(found: dict[str, Any]) -> Findings:
    one, two = (stop_of(found[f"{steps} late"]).distance for steps in (1, 2))
    return {
        "(a), brakes one step of 10 ms later: stopping distance": near(one, 33.85, 0.1, "m"),
        "(a), brakes two steps later: stopping distance": near(two, 36.3, 0.15, "m"),
        **{
            f"{CAPTIONS[name]}, brakes two steps later: front wheel": _late_lock(name, found)
            for name in CONTROLLED[1:]
        },
    }


def _late_lock(name: str, found: dict[str, Any]) -> Found:
    soon, late_stop = (found[f"delay {name}"][_EXTRA.index(x)] for x in (0.0, 0.02))
    lock = "does not lock" if math.isnan(late_stop.lock_speed) else f"locks at {late_stop.lock_speed:.1f} m/s"
    return holds(
        f"up to {late_stop.swing:.2f} (without {soon.swing:.2f}), {lock}; {late_stop.distance:.1f} m",
        late_stop.swing > 0.5 > soon.swing
        and math.isnan(soon.lock_speed)
        and not math.isnan(late_stop.lock_speed),
        "slip swings beyond 0.5 above 5 m/s and locks in the end, neither without the delay",
        reason=_END,
    )


def _vehicle(found: dict[str, Any]) -> Findings:
    high_, low = _HEIGHTS.index(1.1), _HEIGHTS.index(0.9)
    light = _INERTIAS.index(0.5)
    of = "stopping distance of (a), (c), (d)"
    return {
        f"h + 10 %: {of}": _three(found, "height", high_, (33.35, 47.80, 42.99), 0.05),
        f"h - 10 %: {of}": _three(found, "height", low, (33.33, 54.82, 49.88), 0.05),
        f"J - 50 %, controller at 1 kHz: {of}": _three(found, "fine", light, (33.29, 48.86, 46.44), 0.15),
    }


def _three(found: dict[str, Any], kind: str, i: int, expected: tuple[float, ...], tolerance: float) -> Found:
    seen = [found[f"{kind} {name}"][i].distance for name in CONTROLLED]
    return holds(
        f"{' / '.join(f'{x:.2f}' for x in seen)} m",
        all(abs(x - y) <= tolerance for x, y in zip(seen, expected, strict=True)),
        f"{' / '.join(f'{x:.2f}' for x in expected)} m ± {tolerance:g}",
    )


PAPER = Paper("braking", _runs, _page, _pictures)
