"""A bus budget without a run: given values over the resolution of the signals."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Sequence
from typing import Literal

from evcosim.cosim.analysis.bus_budget import Budget, Series, series


def judged(
    values: Sequence[float],
    kind: Literal["max", "min"] = "max",
    limit: float = 1.5,
    failed: Collection[int] = (),
) -> Budget:
    """Return a budget with these values over the resolution, from ideal on; some runs `failed`, by number."""
    points = tuple(
        dataclasses.replace(p, value=v, reason="it fell\nover" if math.isnan(v) else "", failed=i in failed)
        for i, (p, v) in enumerate(zip(series(0.01)[1].points, values, strict=True))
    )
    return Budget("s", "t", "error", "m", limit, kind, (Series("signal resolution", points),))
