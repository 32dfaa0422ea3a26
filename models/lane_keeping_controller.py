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

from functools import cached_property, lru_cache
from typing import NamedTuple

from .base import Model, record, var
from .bicycle import STATES, Bicycle, Rows, eigenvalues
from .constants import SAME_TIME
from .linear_algebra import Matrix, combined, product, singular_values, solve, unit
from .riccati import decays, stabilizing_solution

SINGULAR = 1e-9  # a singular value below this part of the largest counts as 0
PENCIL = 12  # columns of [s I - A, B] with real and imaginary parts
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
        def gain(self) -> Rows:
            """K of (C2), 2 x 4. Raises ValueError where there is none."""
            return _design(self).gain

        @cached_property
        def prefilter(self) -> Rows:
            """S of (C3), 2 x 2. Raises ValueError where there is none."""
            return _design(self).prefilter

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
        return LaneKeepingController.State(
            front, rear, x.front_0, x.rear_0, x.front_1, x.rear_1, x.front_2, x.rear_2,
            heading, displacement, blind,
        )  # fmt: skip # requests, then what is predicted from

    @staticmethod
    def outputs(
        p: LaneKeepingController.Parameters, x: LaneKeepingController.State
    ) -> LaneKeepingController.Outputs:
        """Return the request of `delay_steps` samples ago."""
        if p.delay_steps == 0:
            return LaneKeepingController.Outputs(x.front_0, x.rear_0)
        if p.delay_steps == 1:
            return LaneKeepingController.Outputs(x.front_1, x.rear_1)
        if p.delay_steps == 2:
            return LaneKeepingController.Outputs(x.front_2, x.rear_2)
        return LaneKeepingController.Outputs(x.front_3, x.rear_3)


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
    gain: Rows
    prefilter: Rows


@lru_cache(maxsize=64)  # an FMU builds its Parameters anew in initialization and when a state is restored
def _design(p: LaneKeepingController.Parameters) -> _Design:
    """Return K and S. Raises ValueError that names the reason where there is none, and its parameters."""
    _check_stabilizable(p)
    a = _square(p.a)
    b = _square(p.b)
    k = _gain(p, a, b)
    closed = combined(1.0, a, -1.0, product(b, k, STATES))
    if not decays(closed, STATES):
        raise ValueError(
            "there is no stabilizing gain K: every state that does not decay by itself must cost something; "
            f"lateral_velocity_weight = {p.lateral_velocity_weight:g}, "
            f"heading_angle_weight = {p.heading_angle_weight:g}, "
            f"yaw_rate_weight = {p.yaw_rate_weight:g}, displacement_weight = {p.displacement_weight:g}"
        )
    return _Design(((k[0], k[1], k[2], k[3]), (k[4], k[5], k[6], k[7])), _prefilter(p, closed, b))


def _square(rows: Rows) -> Matrix:
    """Return a matrix of 4 rows as one of 4 x 4; the columns that it lacks are 0."""
    m = [0.0] * (STATES * STATES)
    for i in range(STATES):
        for j in range(len(rows[0])):
            m[STATES * i + j] = rows[i][j]
    return m


def _gain(p: LaneKeepingController.Parameters, a: Matrix, b: Matrix) -> Matrix:
    """Return K of (C2) as a matrix of 4 x 4, of which the first two rows are not 0."""
    q = [0.0] * (STATES * STATES)
    by_weight = [0.0] * (STATES * STATES)
    q[0], q[5] = p.lateral_velocity_weight, p.heading_angle_weight
    q[10], q[15] = p.yaw_rate_weight, p.displacement_weight
    for i in range(STATES):  # R^-1 B'
        by_weight[i] = b[STATES * i] / p.front_steering_weight
        by_weight[STATES + i] = b[STATES * i + 1] / p.rear_steering_weight
    x = stabilizing_solution(a, product(b, by_weight, STATES), q, STATES)
    return product(by_weight, x, STATES)  # (C2)


def _check_stabilizable(p: LaneKeepingController.Parameters) -> None:
    """Raise ValueError where the steering does not move an eigenvalue of A that does not decay.

    By Hautus, [s I - A, B] has full rank for every eigenvalue s of A that steering moves.
    """
    first, second = eigenvalues(p)
    slow = -1e-6 * max(abs(first), abs(second))
    _check_moved(p, complex(0.0, 0.0))
    if first.real >= slow:
        _check_moved(p, first)
    if second.real >= slow:
        _check_moved(p, second)


def _check_moved(p: LaneKeepingController.Parameters, s: complex) -> None:
    """Raise ValueError where the steering does not move the eigenvalue s [1/s] of A."""
    smallest, largest = singular_values(_pencil(p, s), 2 * STATES, PENCIL)
    if smallest <= SINGULAR * largest:
        raise ValueError(
            f"(A, B) is not stabilizable: no steering moves the eigenvalue {s.real:.4g} 1/s of A; "
            f"front_cornering_stiffness = {p.front_cornering_stiffness:g}, "
            f"rear_cornering_stiffness = {p.rear_cornering_stiffness:g}, "
            f"front_axle_distance = {p.front_axle_distance:g}, rear_axle_distance = {p.rear_axle_distance:g}"
        )


def _pencil(p: LaneKeepingController.Parameters, s: complex) -> Matrix:
    """Return [s I - A, B] as real numbers: a matrix of 8 x 12, with each singular value twice."""
    m = [0.0] * (2 * STATES * PENCIL)
    half = STATES + 2
    for i in range(STATES):
        below = PENCIL * (STATES + i) + half  # the row of the imaginary part, at its own columns
        for j in range(STATES):
            m[PENCIL * i + j] = -p.a[i][j]
            m[below + j] = -p.a[i][j]
        m[PENCIL * i + i] += s.real
        m[below + i] += s.real
        m[PENCIL * i + half + i] = -s.imag
        m[below - half + i] = s.imag
        for j in range(2):
            m[PENCIL * i + STATES + j] = p.b[i][j]
            m[below + STATES + j] = p.b[i][j]
    return m


def _prefilter(p: LaneKeepingController.Parameters, closed: Matrix, b: Matrix) -> Rows:
    """Return S of (C3). Raises ValueError where there is none."""
    x = solve(closed, b, STATES)
    c_th, c_beta = p.tracked_heading, p.tracked_displacement
    steady = [-x[0], -x[1], -(c_th * x[4] + c_beta * x[12]), -(c_th * x[5] + c_beta * x[13])]  # (C4)
    smallest, largest = singular_values(steady, 2, 2)
    if smallest <= SINGULAR * largest:
        raise ValueError(
            "there is no prefilter S: C (A - B K)^-1 B is singular, so that steering cannot set y' and "
            "tracked_heading theta + tracked_displacement beta independently in steady state; "
            f"tracked_heading = {p.tracked_heading:g}, tracked_displacement = {p.tracked_displacement:g}"
        )
    s = solve(steady, unit(steady, 2), 2)  # (C3)
    return (s[0], s[1]), (s[2], s[3])
