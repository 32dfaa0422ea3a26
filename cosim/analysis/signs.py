"""Reactions of outputs to inputs, and the signs to turn so that two units react alike. Arrays alone."""

from __future__ import annotations

import collections
import math
from collections.abc import Mapping

import numpy as np

from ..row_store import Array

Pair = tuple[str, str]
"""The names of an input and an output."""


def direction(change: Array) -> int:
    """Return 1 for a change of an output, shape (n,), that raises it, -1 for one that lowers it, 0 otherwise.

    Raised or lowered is an output whose changes add up to more than half of the sum of their sizes.
    """
    whole, size = float(np.sum(change)), float(np.sum(np.abs(change)))
    if abs(whole) <= 0.5 * size:
        return 0
    return 1 if whole > 0.0 else -1


def alike(theirs: Array, ours: Array) -> tuple[float, float]:
    """Return (ratio, agreement) of two changes over the same times, both shape (n,).

    `ratio` is the factor k for which k ours is nearest to theirs (least squares), `agreement` the cosine of
    the angle between them: 1 for the same course, -1 for that with the other sign. 0, 0 where one is 0.
    """
    a, b = float(np.max(np.abs(theirs))), float(np.max(np.abs(ours)))
    if a == 0.0 or b == 0.0:
        return 0.0, 0.0
    x, y = theirs / a, ours / b  # no square of them is too large or too small
    product = float(np.dot(x, y))
    square = float(np.dot(y, y))
    return product / square * (a / b), product / math.sqrt(float(np.dot(x, x)) * square)


def turned(signs: Mapping[Pair, int]) -> tuple[set[str], set[str]] | None:
    """Return the fewest inputs and outputs whose sign must be turned so that all pairs have sign 1.

    `signs` are 1 for pairs that react as they should, -1 for those with the other sign. Where an input or an
    output alone would do, it is the input. None: no choice of signs makes all pairs right.
    """
    near: dict[tuple[str, str], list[tuple[tuple[str, str], int]]] = collections.defaultdict(list)
    for (source, sink), sign in signs.items():
        near["input", source].append((("output", sink), sign))
        near["output", sink].append((("input", source), sign))
    found: dict[tuple[str, str], int] = {}
    chosen: set[tuple[str, str]] = set()
    for start in near:
        if start in found:
            continue
        group = _colored(start, near, found)
        if group is None:
            return None
        ways = [{v for v in group if found[v] == sign} for sign in (-1, 1)]
        chosen |= min(ways, key=lambda way: (len(way), sum(kind == "output" for kind, _ in way)))
    return ({n for kind, n in chosen if kind == "input"}, {n for kind, n in chosen if kind == "output"})


def _colored(
    start: tuple[str, str],
    near: Mapping[tuple[str, str], list[tuple[tuple[str, str], int]]],
    found: dict[tuple[str, str], int],
) -> list[tuple[str, str]] | None:
    """Give signs to all that hangs together with `start`; None where they contradict each other."""
    found[start], group, waiting = 1, [start], [start]
    while waiting:
        here = waiting.pop()
        for other, sign in near[here]:
            wanted = sign * found[here]
            if other not in found:
                found[other] = wanted
                group.append(other)
                waiting.append(other)
            elif found[other] != wanted:
                return None
    return group
