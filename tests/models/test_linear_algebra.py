"""Linear algebra: the figures of numpy and scipy, over all that the models may ask for."""

from __future__ import annotations

import decimal
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from evcosim.models import linear_algebra as algebra
from evcosim.models.bicycle import Bicycle, discretized, eigenvalues, state_matrix

elements = st.floats(-10.0, 10.0)
pairs = st.integers(1, 8).flatmap(
    lambda n: st.tuples(*[st.lists(elements, min_size=n * n, max_size=n * n)] * 2)
)
vehicles = st.builds(
    Bicycle,
    mass=st.floats(100.0, 40e3),
    yaw_inertia=st.floats(100.0, 1e5),
    front_cornering_stiffness=st.floats(0.0, 1e6),
    rear_cornering_stiffness=st.floats(0.0, 1e6),
    front_axle_distance=st.floats(0.0, 5.0),
    rear_axle_distance=st.floats(0.0, 5.0),
    speed=st.floats(0.1, 120.0),
)


def square(m: Sequence[float]) -> np.ndarray:
    """A matrix of the module as numpy's."""
    n = math.isqrt(len(m))
    return np.reshape(m, (n, n))


def size(m: np.ndarray) -> float:
    """The 1-norm."""
    return float(np.linalg.norm(m, 1))


@given(pairs)
def test_products_are_numpys(both: tuple[list[float], list[float]]) -> None:
    a, b = both
    n = math.isqrt(len(a))
    assert square(algebra.product(a, b, n)) == pytest.approx(square(a) @ square(b), abs=1e-11)
    assert (square(algebra.transposed(a, n)) == square(a).T).all()
    assert algebra.norm(a, n) == pytest.approx(size(square(a)), rel=1e-14)


@given(pairs)
def test_linear_equations_are_solved_to_rounding(both: tuple[list[float], list[float]]) -> None:
    """The residual is that of a stable method, for any matrix; nothing that was given is changed."""
    a, b = both
    n, before = math.isqrt(len(a)), (list(a), list(b))
    assume(np.linalg.cond(square(a)) < 1e15)
    x = square(algebra.solve(a, b, n))
    assert before == (a, b)
    bound = 1e-14 * (size(square(a)) * size(x) + size(square(b))) + 1e-300
    assert size(square(a) @ x - square(b)) <= bound


def test_a_singular_matrix_solves_nothing() -> None:
    assert algebra.solve([1.0, 2.0, 2.0, 4.0], [1.0, 0.0, 0.0, 1.0], 2) == [0.0] * 4


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_what_is_no_number_has_no_finite_norm(bad: float) -> None:
    assert algebra.norm([1.0, 0.0, bad, 5.0], 2) == math.inf
    assert not all(map(math.isfinite, algebra.exponential([1.0, 0.0, bad, 5.0], 2)))


def exact_exponential(a: list[float], n: int) -> np.ndarray:
    """By its series, in decimal numbers of 60 digits, of the matrix halved eight times."""
    with decimal.localcontext(prec=60):
        small = [decimal.Decimal(x) / 256 for x in a]

        def times(b: list[decimal.Decimal], c: list[decimal.Decimal]) -> list[decimal.Decimal]:
            return [sum(b[n * i + k] * c[n * k + j] for k in range(n)) for i in range(n) for j in range(n)]

        term = [decimal.Decimal(i % (n + 1) == 0) for i in range(n * n)]
        total = term
        for k in range(1, 40):
            term = [x / k for x in times(term, small)]
            total = [x + y for x, y in zip(total, term, strict=True)]
        for _ in range(8):
            total = times(total, total)
        return square([float(x) for x in total])


@settings(max_examples=50)
@given(st.integers(1, 3).flatmap(lambda n: st.lists(elements, min_size=n * n, max_size=n * n)))
def test_an_exponential_is_exact_but_for_rounding(a: list[float]) -> None:
    n = math.isqrt(len(a))
    growth = size(exact_exponential([abs(x) for x in a], n))  # what rounding in A may become
    assert size(square(algebra.exponential(a, n)) - exact_exponential(a, n)) <= 1e-14 * growth


@settings(max_examples=40)
@given(vehicles, st.floats(1e-4, 0.02))
def test_a_step_of_the_bicycle_is_exact_and_so_scipys(p: Bicycle, dt: float) -> None:
    """Within 1e-14 of its norm where that of A dt is up to 10, and of scipy's but for what scipy is off."""
    augmented = np.zeros((6, 6))
    augmented[:4, :4], augmented[:4, 4:] = p.a, p.b
    augmented *= dt
    assume(size(augmented) <= 10.0)
    ours, theirs = np.array(discretized(p.a, p.b, dt)), expm(augmented)[:4]
    exact = exact_exponential(augmented.ravel().tolist(), 6)[:4]
    assert (ours[:, 6:] == 0.0).all()
    assert size(ours[:, :6] - exact) <= 1e-14 * size(exact)
    assert size(ours[:, :6] - theirs) <= 1e-14 * size(exact) + size(theirs - exact)


@given(vehicles, st.floats(1e-3, 1.0))
def test_two_half_steps_are_a_step(p: Bicycle, dt: float) -> None:
    half, whole = (np.array(discretized(p.a, p.b, t))[:, :4] for t in (0.5 * dt, dt))
    assume(size(np.array(p.a)) * dt < 100.0)
    assert size(half @ half - whole) <= 1e-12 * max(size(whole), size(half) ** 2)


@given(vehicles)
def test_the_eigenvalues_of_the_bicycle_are_numpys(p: Bicycle) -> None:
    theirs = np.linalg.eigvals(np.array(state_matrix(p, p.front_cornering_stiffness)))
    ours = np.array([0.0, 0.0, *eigenvalues(p)])
    scale = size(np.array(p.a))
    nearest = np.abs(ours[:, None] - theirs).min(axis=0)
    assert nearest == pytest.approx(np.zeros(4), abs=1e-7 * scale)  # a double one is known to half the digits


@given(st.integers(1, 8), st.integers(0, 4), st.data())
def test_singular_values_are_numpys(rows: int, more: int, data: st.DataObject) -> None:
    columns = rows + more
    m = data.draw(st.lists(elements, min_size=rows * columns, max_size=rows * columns))
    before = list(m)
    smallest, largest = algebra.singular_values(m, rows, columns)
    theirs = np.linalg.svd(np.reshape(m, (rows, columns)), compute_uv=False)
    assert m == before
    assert (smallest, largest) == pytest.approx((theirs[-1], theirs[0]), abs=1e-14 * theirs[0] + 1e-150)


@given(st.floats(1e-12, 1e-6), st.floats(0.0, 1.0))
def test_a_small_singular_value_is_known_beside_a_large_one(small: float, angle: float) -> None:
    c, s = math.cos(angle), math.sin(angle)
    turned = [c, s, -small * s, small * c]
    assert algebra.singular_values(turned, 2, 2) == pytest.approx((small, 1.0), rel=1e-9)


def test_rows_whose_squares_are_no_floats_are_left_as_they_are() -> None:
    assert algebra.singular_values([1e200, 0.0, 0.0, 1e-200], 2, 2) == (0.0, math.inf)
