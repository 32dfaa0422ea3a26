"""Road friction: the friction coefficient of a tire on four roads, by Burckhardt's formula.

Source: Burckhardt, Fahrwerktechnik: Radschlupf-Regelsysteme, 1993.

    mu(lambda) = th_1 (1 - exp(-th_2 lambda)) - th_3 lambda [1]      for 0 <= lambda <= 1        (F1)

published: nothing in the papers of the systems, which print the formula without numbers.
chosen: th_1, th_2, th_3 of Burckhardt's standard table, for all four roads; mu is odd in lambda,
mu(-lambda) = -mu(lambda): a wheel faster than the vehicle drives it.
"""

from __future__ import annotations

from enum import IntEnum
from math import copysign, exp
from typing import NamedTuple


class Road(IntEnum):
    """The surface that the tires roll on."""

    DRY = 0
    WET = 1
    COBBLE = 2
    SNOW = 3


class Friction(NamedTuple):
    """th_1, th_2 and th_3 of (F1) [1]."""

    peak: float
    steepness: float
    fall: float


FRICTION = {
    Road.DRY: Friction(1.2801, 23.99, 0.52),  # of the standard table, all four
    Road.WET: Friction(0.857, 33.822, 0.347),
    Road.COBBLE: Friction(1.3713, 6.4565, 0.6691),
    Road.SNOW: Friction(0.1946, 94.129, 0.0646),
}


def friction_coefficient(road: Road, slip: float) -> float:
    """Return mu [1] at a slip in [-1, 1]."""
    th_1, th_2, th_3 = FRICTION[road]
    x = abs(slip)
    return copysign(th_1 * (1.0 - exp(-th_2 * x)) - th_3 * x, slip)  # (F1)


def friction_slope(road: Road, slip: float) -> float:
    """Return d mu/d lambda [1] at a slip in [-1, 1]; even in the slip."""
    th_1, th_2, th_3 = FRICTION[road]
    return th_1 * th_2 * exp(-th_2 * abs(slip)) - th_3
