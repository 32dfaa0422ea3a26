"""LaneKeepingController: linear-quadratic lane keeping of a four-wheel-steered vehicle.

Source: a paper on optimal lane keeping control of a 4WS electric vehicle (title and authors are not known),
section 5. For the vehicle x' = A x + B u of `bicycle`, x = (y', theta, w_z, beta), u = (delta_f, delta_r)
[rad], and the reference r = (r_1, r_2):

    u = -K x + S r                                                                                   (C1)
    K = R^-1 B' P,   A' P + P A - P B R^-1 B' P + Q = 0         minimizes integral x'Q x + u'R u dt  (C2)
    S = -[C (A - B K)^-1 B]^-1                                  so that C x = r in steady state      (C3)
    C = [1 0 0 0; 0 c_theta 0 c_beta]                           tracked: y' and theta + beta         (C4)

K and S are computed from the parameters, once for each set of them, in continuous time as in the paper.

Where the status of the lane camera's frames says that none was taken, theta and beta are predicted from the
last ones by what the inertial sensors measure, and after t_p the steering fades to straight within t_f:

    theta[k] = theta[k-1] + dt w_z[k],   beta[k] = beta[k-1] - dt (y'[k] + v_x theta[k-1])           (C5)
    u max(0, min(1, 1 - (t_b - t_p)/t_f)) in place of u, t_b without a frame for so long             (C6)

Deviations: the paper's text names y' and theta as what is tracked (c_beta = 0), for which there is no S
("Not reproducible, and misprints" in docs/systems/lane_keeping.md). The K-hat that the paper also prints
contradicts its own K; it is not used.

published: Q = I (4 x 4), R = I (2 x 2), A, B, K, S.
chosen: c_theta = 1 m/rad, c_beta = 1, which give the printed S; `delay_steps` = 0; (C5), (C6), t_p = 2 s,
t_f = 1 s.

At the edges: `delay_steps` gives out the request of so many samples ago, the time that a slow control unit
needs; at the start the older requests are that of the first inputs. Refused at the end of the initialization:
a vehicle that no steering stabilizes; weights that leave out of the cost what does not decay by itself;
outputs (C4) that steering cannot set independently. `reads_status` = false takes what stands at the inputs
for true, which a bus holds while it takes no frame.

Step: the sample at t_k computes (C1) from the inputs at t_k, and u is held until the next; there is no memory
but the older requests and the last place in the lane, and no error. (C5) is order 1.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from .base import Model, record, var
from .bicycle import Bicycle, Matrix
from .constants import SAME_TIME

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SINGULAR = 1e-9  # a singular value below this part of the largest counts as 0
MAX_DELAY = 3  # steps
TAKEN = (0, 4, 32)  # statuses of E2E with which values reach a receiver: ok, initial, some lost


class LaneKeepingController(Model):
    """Measured state and reference in, front and rear steering angles out."""

    sampled = True
    initial_inputs = (
        "lateral_velocity",
        "heading_angle",
        "yaw_rate",
        "displacement",
        "lateral_velocity_reference",
        "displacement_reference",
    )

    @record
    class Parameters(Bicycle):
        """The vehicle as the controller knows it, the weights, and the tracked outputs."""

        lateral_velocity_weight: float = var(1.0, "s2/m2", "Q: weight of y'^2", min=0.0)
        heading_angle_weight: float = var(1.0, "1/rad2", "Q: weight of theta^2", min=0.0)
        yaw_rate_weight: float = var(1.0, "s2/rad2", "Q: weight of w_z^2", min=0.0)
        displacement_weight: float = var(1.0, "1/m2", "Q: weight of beta^2", min=0.0)
        front_steering_weight: float = var(1.0, "1/rad2", "R: weight of delta_f^2", min=1e-9)
        rear_steering_weight: float = var(1.0, "1/rad2", "R: weight of delta_r^2", min=1e-9)
        tracked_heading: float = var(1.0, "m/rad", "Part of theta in the second tracked output (c_theta)")
        tracked_displacement: float = var(1.0, "1", "Part of beta in the second tracked output (c_beta)")
        delay_steps: int = var(0, "", "Samples from measurement to request", min=0, max=MAX_DELAY)
        reads_status: bool = var(True, "", "Whether the status of the lane camera's frames is read")
        prediction_time: float = var(2.0, "s", "Longest prediction without the lane camera (t_p)", min=0.0)
        fade_time: float = var(1.0, "s", "Time in which the steering then goes straight (t_f)", min=1e-3)

        @cached_property
        def gain(self) -> Matrix:
            """K of (C2), 2 x 4. Raises ValueError where there is none."""
            return _design(self).gain

        @cached_property
        def prefilter(self) -> Matrix:
            """S of (C3), 2 x 2. Raises ValueError where there is none."""
            return _design(self).prefilter

        @cached_property
        def shown(self) -> Callable[[Any], tuple[float, float]]:
            """The function State -> (front, rear) [rad], the two requests that are given out."""
            return attrgetter(f"front_{self.delay_steps}", f"rear_{self.delay_steps}")

    @record
    class Inputs:
        """The measured x, and r."""

        lateral_velocity: float = var(0.0, "m/s", "Lateral velocity (y')")
        heading_angle: float = var(0.0, "rad", "Heading relative to the lane (theta)", nominal=0.1)
        yaw_rate: float = var(0.0, "rad/s", "Yaw rate (w_z)", nominal=0.1)
        displacement: float = var(0.0, "m", "Displacement from the lane center (beta)")
        lateral_velocity_reference: float = var(0.0, "m/s", "Reference of y' (r_1)")
        displacement_reference: float = var(0.0, "m", "Reference of theta + beta (r_2)")
        camera_status: int = var(0, "", "E2E status of the lane camera's last frame; 0, 4, 32: taken")

    @record
    class State:
        """The requests of this sample and of those before it: `front_2` is two samples old."""

        front_0: float = var(0.0, "rad", "Front angle of this sample")
        rear_0: float = var(0.0, "rad", "Rear angle of this sample")
        front_1: float = var(0.0, "rad", "Front angle one sample ago")
        rear_1: float = var(0.0, "rad", "Rear angle one sample ago")
        front_2: float = var(0.0, "rad", "Front angle two samples ago")
        rear_2: float = var(0.0, "rad", "Rear angle two samples ago")
        front_3: float = var(0.0, "rad", "Front angle three samples ago")
        rear_3: float = var(0.0, "rad", "Rear angle three samples ago")
        heading_angle: float = var(0.0, "rad", "Heading of the last sample, measured or predicted")
        displacement: float = var(0.0, "m", "Displacement of the last sample, measured or predicted")
        blind_time: float = var(0.0, "s", "Time without a frame of the lane camera (t_b)", min=0.0)

    @record
    class Outputs:
        """The requested steering angles."""

        front_steering_angle: float = var(0.0, "rad", "Front road-wheel angle (delta_f)", nominal=0.1)
        rear_steering_angle: float = var(0.0, "rad", "Rear road-wheel angle (delta_r)", nominal=0.1)

    @staticmethod
    def initial(
        p: LaneKeepingController.Parameters, u: LaneKeepingController.Inputs
    ) -> LaneKeepingController.State:
        """Return the requests for the first inputs, as if these had been the same before.

        Raises ValueError for parameters to which there is no K or S.
        """
        front, rear = _law(p, u, u.heading_angle, u.displacement)
        return LaneKeepingController.State(
            front, rear, front, rear, front, rear, front, rear, u.heading_angle, u.displacement
        )

    @staticmethod
    def step(
        p: LaneKeepingController.Parameters,
        x: LaneKeepingController.State,
        u: LaneKeepingController.Inputs,
        dt: float,
    ) -> LaneKeepingController.State:
        """Return the request at t_k and those before it."""
        heading, displacement, blind = _place(p, x, u, dt)
        front, rear = _law(p, u, heading, displacement)
        if blind > p.prediction_time + SAME_TIME:  # (C6)
            part = max(0.0, 1.0 - (blind - p.prediction_time) / p.fade_time)
            front, rear = part * front, part * rear
        older = (x.front_0, x.rear_0, x.front_1, x.rear_1, x.front_2, x.rear_2)
        return LaneKeepingController.State(front, rear, *older, heading, displacement, blind)

    @staticmethod
    def outputs(
        p: LaneKeepingController.Parameters, x: LaneKeepingController.State
    ) -> LaneKeepingController.Outputs:
        """Return the request of `delay_steps` samples ago."""
        front, rear = p.shown(x)
        return LaneKeepingController.Outputs(front, rear)


def _place(
    p: LaneKeepingController.Parameters,
    x: LaneKeepingController.State,
    u: LaneKeepingController.Inputs,
    dt: float,
) -> tuple[float, float, float]:
    """Return theta [rad] and beta [m], measured or predicted, and the time without the camera [s]."""
    if not p.reads_status or u.camera_status in TAKEN:
        return u.heading_angle, u.displacement, 0.0
    moved = dt * (u.lateral_velocity + p.speed * x.heading_angle)
    return x.heading_angle + dt * u.yaw_rate, x.displacement - moved, x.blind_time + dt  # (C5)


def _law(
    p: LaneKeepingController.Parameters, u: LaneKeepingController.Inputs, th: float, beta: float
) -> tuple[float, float]:
    y, w = u.lateral_velocity, u.yaw_rate
    r_1, r_2 = u.lateral_velocity_reference, u.displacement_reference
    (k11, k12, k13, k14), (k21, k22, k23, k24) = p.gain
    (s11, s12), (s21, s22) = p.prefilter
    return (
        s11 * r_1 + s12 * r_2 - (k11 * y + k12 * th + k13 * w + k14 * beta),  # (C1)
        s21 * r_1 + s22 * r_2 - (k21 * y + k22 * th + k23 * w + k24 * beta),
    )


class _Design(NamedTuple):
    gain: Matrix
    prefilter: Matrix


@lru_cache(maxsize=64)  # an FMU builds its Parameters anew in initialization and when a state is restored
def _design(p: LaneKeepingController.Parameters) -> _Design:
    """Return K and S. Raises ValueError that names the reason where there is none, and its parameters."""
    import numpy as np
    from scipy.linalg import solve_continuous_are

    a, b = np.array(p.a), np.array(p.b)
    _check_stabilizable(p, a, b)
    weights = (
        p.lateral_velocity_weight,
        p.heading_angle_weight,
        p.yaw_rate_weight,
        p.displacement_weight,
    )
    r = np.array([p.front_steering_weight, p.rear_steering_weight])
    try:
        k = (b.T @ solve_continuous_are(a, b, np.diag(weights), np.diag(r))) / r[:, None]  # (C2)
        stable = bool(np.all(np.linalg.eigvals(a - b @ k).real < 0.0))
    except np.linalg.LinAlgError:
        stable = False
    if not stable:
        raise ValueError(
            "there is no stabilizing gain K: every state that does not decay by itself must cost something; "
            + _values(p, "lateral_velocity", "heading_angle", "yaw_rate", "displacement", suffix="_weight")
        )
    return _Design(_rows(k), _rows(_prefilter(p, a - b @ k, b)))


def _check_stabilizable(p: LaneKeepingController.Parameters, a: Array, b: Array) -> None:
    """Raise ValueError where the steering does not move an eigenvalue of A that does not decay.

    By Hautus, [s I - A, B] has full rank for every eigenvalue s of A that steering moves.
    """
    import numpy as np

    eigenvalues = np.linalg.eigvals(a)
    for s in eigenvalues:
        if s.real < -1e-6 * np.abs(eigenvalues).max():
            continue
        sizes = np.linalg.svd(np.hstack([s * np.eye(len(a)) - a, b]), compute_uv=False)
        if sizes[-1] <= SINGULAR * sizes[0]:
            raise ValueError(
                f"(A, B) is not stabilizable: no steering moves the eigenvalue {s.real:.4g} 1/s of A; "
                + _values(p, "front", "rear", suffix="_cornering_stiffness")
                + ", "
                + _values(p, "front", "rear", suffix="_axle_distance")
            )


def _prefilter(p: LaneKeepingController.Parameters, closed: Array, b: Array) -> Array:
    import numpy as np

    c = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, p.tracked_heading, 0.0, p.tracked_displacement]])  # (C4)
    steady = -c @ np.linalg.solve(closed, b)
    sizes = np.linalg.svd(steady, compute_uv=False)
    if sizes[-1] <= SINGULAR * sizes[0]:
        raise ValueError(
            "there is no prefilter S: C (A - B K)^-1 B is singular, so that steering cannot set y' and "
            "tracked_heading theta + tracked_displacement beta independently in steady state; "
            + _values(p, "heading", "displacement", prefix="tracked_")
        )
    inverse: Array = np.linalg.inv(steady)  # (C3)
    return inverse


def _values(p: LaneKeepingController.Parameters, *names: str, prefix: str = "", suffix: str = "") -> str:
    full = [f"{prefix}{name}{suffix}" for name in names]
    return ", ".join(f"{name} = {getattr(p, name):g}" for name in full)


def _rows(matrix: Array) -> Matrix:
    return tuple(tuple(float(value) for value in row) for row in matrix)
