"""Tire relaxation: the slip of an elastic tire lags behind that of its wheel.

Source: chosen; the first-order relaxation of the textbooks, (D4) of `detailed_two_wheeler`.

    sigma s' = w (slip - s),   w = max(v, w_i r)                                                [m/s]  (T1)

published: nothing.
chosen: w is held over a step; the slip is linear in it, so that the solution is exact.

At the edges: sigma = 0 is s = slip. At w = 0 s stays as it is.
"""

from __future__ import annotations

from math import exp, inf


def relaxation(sigma: float, h: float, fastest: float) -> tuple[float, float]:
    """Return lag and decay [1] of (T1) over h [s], for `relaxed`; sigma in m, `fastest` (w) in m/s."""
    way = h * fastest / sigma if sigma > 0.0 else inf
    decay = exp(-way)
    return (1.0 - decay) / way if way > 1e-8 else 1.0, decay


def relaxed(relaxation: tuple[float, float], s: float, before: float, after: float) -> float:
    """Return s [1] after a step in which the slip goes linearly from `before` to `after`."""
    lag, decay = relaxation
    return after - lag * (after - before) + decay * (s - before)  # (T1)
