"""Proposition 3.1 of the braking paper at other set points, and the slips that gains below max Psi leave."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

from ...models import braking_analysis as analysis
from ...models.road_friction import Road
from .braking_runs import FACTORS, NOMINAL, STARTS, critical
from .page import Findings, Found, at_most, holds

SET_POINTS = (
    analysis.SetPoint(0.1, 0.25),
    analysis.SetPoint(0.6, 0.3),
    analysis.SetPoint(0.9, 0.9),
    analysis.SetPoint(0.05, 0.9),
)
"""One of the usual range and three far from any use, beside that of the maneuvers."""

_LOW = 0.02  # slip: a tenth of what brakes well


class Ends(NamedTuple):
    """The results of the random starts at one set point, over all roads and FACTORS."""

    spread: float  # the largest of the end points, in slip
    equilibria: tuple[int, ...]  # how many there are


def ends(target: analysis.SetPoint) -> Ends:
    """Evaluate Proposition 3.1 at a set point, from the same random starts on each road."""
    starts, spread, equilibria = analysis.random_starts(STARTS), 0.0, []
    for road in Road:
        p = dataclasses.replace(NOMINAL, road=road)
        for gains in map(critical, FACTORS):
            spread = max(spread, analysis.spread(analysis.end_points(p, gains, starts, target)))
            equilibria.append(len(analysis.equilibria(p, gains, target)))
    return Ends(spread, tuple(equilibria))


def findings(found: dict[analysis.SetPoint, Ends]) -> Findings:
    """Return the rows of Proposition 3.1 for all of `found`, and of Remark 3.3."""
    names = ", ".join(f"{target.front:g}/{target.rear:g}" for target in found)
    spread = max(each.spread for each in found.values())
    counts = {count for each in found.values() for count in each.equilibria}
    return {
        "3.1 set points": [
            at_most(spread, 1e-6, digits=2, of=f"spread at {names}"),
            holds(", ".join(map(str, sorted(counts))), counts == {1}, "1", of="equilibria"),
        ],
        "usual set points": holds(
            f"{analysis.TARGET_SLIP:g} lies between; the ends are tried too",
            0.1 <= analysis.TARGET_SLIP <= 0.25 and SET_POINTS[0] in found,
        ),
        "remark 3.3": [_low_slips(target) for target in (analysis.TARGET, SET_POINTS[0])],
    }


def _low_slips(target: analysis.SetPoint) -> Found:
    gains, highest = critical(FACTORS[0]), analysis.highest_psi(NOMINAL)
    (rest,) = analysis.equilibria(NOMINAL, gains, target)
    below = gains.front < highest.front and gains.rear < highest.rear
    return holds(
        f"{rest.front:.3f} and {rest.rear:.3f}",
        below and max(rest) < _LOW,
        f"below {_LOW:g}",
        of=f"set points {target.front:g} and {target.rear:g}",
    )
