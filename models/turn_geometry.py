"""Turn geometry: the speeds at which the two rear wheels of a car roll when its front wheels are steered.

Source: B. Gasbaoui, A. Nasri (2012), as in `electronic_differential`; index 1 is the left wheel.

    R = L/tan(d)                                     turning center to the middle of the axle [m]  (9)
    v_1/v = (R - d_w/2)/R = (L - (d_w/2) tan(d))/L   left wheel [1]                               (10)
    v_2/v = (R + d_w/2)/R = (L + (d_w/2) tan(d))/L   right wheel [1]                              (11)

d > 0 [rad] steers to the left (ISO 8855), so that in a left-hand curve the left wheel is the slow one. d = 0
is R = infinity, and both ratios are 1.

published: L = 2.5 m, d_w = 1.5 m, the models' defaults.
chosen: the stop of the steering.

At the edges: an angle beyond the stop counts as the stop, and NaN stays NaN. With R < d_w/2 the turning
center would lie between the wheels and the inner one run backward; no steering does that, so a stop that
allows it is refused.
"""

from __future__ import annotations

from math import tan


def check_steering(wheelbase: float, track: float, limit: float) -> None:
    """Raise ValueError for a stop of the steering `limit` [rad] at which R <= track/2 (lengths in m)."""
    shift = 0.5 * track * tan(limit)
    if shift >= wheelbase:
        raise ValueError(
            f"steering_limit = {limit} rad turns the car about a point between its rear wheels: the radius "
            f"wheelbase/tan(steering_limit) = {wheelbase / tan(limit):.4g} m must be above track/2 = "
            f"{0.5 * track:.4g} m (wheelbase = {wheelbase} m, track = {track} m)"
        )


def wheel_ratios(wheelbase: float, track: float, limit: float, angle: float) -> tuple[float, float]:
    """Return v_1/v and v_2/v at a steering angle [rad], which counts as `limit` [rad] beyond it."""
    d = limit if angle > limit else -limit if angle < -limit else angle
    shift = 0.5 * track * tan(d) / wheelbase  # (d_w/2)/R by (9)
    return 1.0 - shift, 1.0 + shift  # (10), (11)
