"""Riccati: the solution is scipy's, and what has none is found out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_are

from evcosim.models.bicycle import Bicycle
from evcosim.models.riccati import decays, residual, stabilizing_solution

weights = st.sampled_from([0.1, 0.5, 1.0, 3.0, 10.0])
vehicles = st.builds(
    Bicycle,
    mass=st.floats(500.0, 4000.0),
    yaw_inertia=st.floats(500.0, 8000.0),
    front_cornering_stiffness=st.floats(5e3, 2e5),
    rear_cornering_stiffness=st.floats(5e3, 2e5),
    front_axle_distance=st.floats(0.5, 3.0),
    rear_axle_distance=st.floats(0.5, 3.0),
    speed=st.floats(1.0, 90.0),
)


def flat(m: np.ndarray) -> list[float]:
    """A matrix of numpy as the module's."""
    found: list[float] = m.ravel().tolist()
    return found


def left_side(a: np.ndarray, g: np.ndarray, q: np.ndarray, x: np.ndarray) -> float:
    """The largest element of the left side of (R1)."""
    return float(np.abs(a.T @ x + x @ a - x @ g @ x + q).max())


@settings(max_examples=60)
@given(vehicles, st.tuples(*[weights] * 4), st.tuples(*[weights] * 2))
def test_the_solution_is_scipys(p: Bicycle, q: tuple[float, ...], r: tuple[float, ...]) -> None:
    """Gains within 1e-9; a residual of 10 times scipy's at most, or of 1e-12 of the terms of (R1)."""
    a, b = np.array(p.a), np.array(p.b)
    drive = np.diag(1.0 / np.array(r)) @ b.T
    g = b @ drive
    theirs = solve_continuous_are(a, b, np.diag(q), np.diag(r))
    ours = np.reshape(stabilizing_solution(flat(a), flat(g), flat(np.diag(q)), 4), (4, 4))
    assert (ours == ours.T).all()
    terms = max(max(q), np.abs(a.T @ ours).max(), np.abs(ours @ g @ ours).max())
    residuals = [left_side(a, g, np.diag(q), x) for x in (ours, theirs)]
    assert residuals[0] <= max(10.0 * residuals[1], 1e-12 * terms)
    assert np.abs(drive @ (ours - theirs)).max() <= 1e-9 * np.abs(drive @ theirs).max()
    assert decays(flat(a - g @ ours), 4)
    found = residual(flat(a), flat(g), flat(np.diag(q)), flat(ours), 4)
    assert np.abs(found).max() == pytest.approx(residuals[0], abs=1e-12 * terms)


def test_a_scalar_equation_has_its_root() -> None:
    """2 a x - g x^2 + q = 0: x = (a + sqrt(a^2 + g q))/g, the root under which a - g x = -sqrt(...)."""
    for a, g, q in ((1.0, 2.0, 3.0), (-4.0, 0.5, 1e-6), (0.0, 1.0, 4.0)):
        root = (a + np.sqrt(a * a + g * q)) / g
        assert stabilizing_solution([a], [g], [q], 1) == pytest.approx([root], rel=1e-12)


def test_what_costs_nothing_and_does_not_decay_has_no_stabilizing_solution() -> None:
    for a in ([0.0], [0.0, 1.0, 0.0, 0.0]):
        n = 1 if len(a) == 1 else 2
        g, q = [0.0] * len(a), [0.0] * len(a)
        g[-1] = 1.0
        x = stabilizing_solution(a, g, q, n)
        closed = np.reshape(a, (n, n)) - np.reshape(g, (n, n)) @ np.reshape(x, (n, n))
        assert not decays(flat(closed), n)


@given(st.integers(1, 4), st.data())
def test_a_matrix_decays_where_all_its_eigenvalues_do(n: int, data: st.DataObject) -> None:
    c = np.reshape(data.draw(st.lists(st.floats(-5.0, 5.0), min_size=n * n, max_size=n * n)), (n, n))
    slowest = np.linalg.eigvals(c).real.max()
    assume(abs(slowest) > 1e-3)
    assert decays(flat(c), n) == (slowest < 0.0)


@pytest.mark.parametrize(
    "c", [[0.0], [float("nan")], [float("inf")], [0.0, 1.0, 0.0, 0.0], [-1.0, 1.0, 0.0, 0.0]]
)
def test_what_stays_or_is_no_number_does_not_decay(c: list[float]) -> None:
    assert not decays(c, 1 if len(c) == 1 else 2)


@given(st.floats(1e-9, 1.0))
def test_a_slow_decay_beside_a_fast_one_is_one(rate: float) -> None:
    assert decays([-1000.0, 3.0, 0.0, -rate], 2)
    assert not decays([-1000.0, 3.0, 0.0, rate], 2)
