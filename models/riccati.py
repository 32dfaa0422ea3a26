"""Riccati: the stabilizing solution of the algebraic Riccati equation in continuous time.

Source: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, "A structure-preserving doubling algorithm for continuous-time
algebraic Riccati equations", Linear Algebra Appl. 396, 2005, for (R2)-(R4); D. L. Kleinman, "On an iterative
technique for Riccati equation computations", IEEE Trans. Automatic Control 13(1), 1968, for (R5).

    A' X + X A - X G X + Q = 0,   A - G X stable                                                    (R1)
    W = (A - g I)' + Q (A - g I)^-1 G,   A_0 = I + 2 g W'^-1,   G_0 = 2 g (A - g I)^-1 G W^-1,
        H_0 = 2 g W^-1 Q (A - g I)^-1                                                               (R2)
    V = I + G_k H_k,   A_k+1 = A_k V^-1 A_k,   G_k+1 = G_k + A_k V^-1 G_k A_k'                      (R3)
    H_k+1 = H_k + A_k' H_k V^-1 A_k,   H_k to X                                                     (R4)
    X_k+1 = X_k + E,   (A - G X_k)' E + E (A - G X_k) + (left side of (R1) for X_k) = 0             (R5)
    C' E + E C + R = 0:   E = 2 c sum of S'^i N' R N S^i,   N = (c I - C)^-1,  S = N (c I + C)      (R6)

Matrices are those of `linear_algebra`. The sum of (R6) is doubled as (R3): its first 2^k terms after k steps.

published: nothing that is a number.
chosen: g and c above every eigenvalue, from norms; two steps of (R5), which take the rounding of (R3) away.

At the edges: where there is no stabilizing solution, the result is one under which A - G X does not decay.
"""

from __future__ import annotations

from math import sqrt

from .linear_algebra import Matrix, combined, norm, product, solve, transposed, unit

DOUBLINGS = 60  # at most: 2^60 terms
FADED = 1e-20  # what a power is at most, of which nothing more is to be expected
GROWN = 1e100  # what a power is at least that grows
REFINEMENTS = 2  # of (R5)


def stabilizing_solution(a: Matrix, g: Matrix, q: Matrix, n: int) -> Matrix:
    """Return X of (R1), symmetric; all matrices are n x n, G and Q symmetric and not negative."""
    x = _doubled(a, g, q, n)
    for _ in range(REFINEMENTS):
        e = _lyapunov(combined(1.0, a, -1.0, product(g, x, n)), residual(a, g, q, x, n), n)
        x = combined(1.0, x, 1.0, e)  # (R5)
        x = combined(0.5, x, 0.5, transposed(x, n))
    return x


def residual(a: Matrix, g: Matrix, q: Matrix, x: Matrix, n: int) -> Matrix:
    """Return the left side of (R1) for a symmetric X."""
    xa = product(x, a, n)
    linear = combined(1.0, xa, 1.0, transposed(xa, n))
    return combined(1.0, combined(1.0, linear, -1.0, product(x, product(g, x, n), n)), 1.0, q)  # (R1)


def decays(c: Matrix, n: int) -> bool:
    """Return True if exp(C t), C of n x n, goes to 0: all its eigenvalues have a negative real part."""
    rate = 2.0 * norm(c, n)
    if rate == 0.0:
        return False
    one = unit(c, n)
    s = solve(combined(rate, one, -1.0, c), combined(rate, one, 1.0, c), n)  # (R6)
    size, steps = norm(s, n), 0
    while size > FADED and size < GROWN and steps < DOUBLINGS:
        s = product(s, s, n)
        size, steps = norm(s, n), steps + 1
    return size <= FADED


def _doubled(a: Matrix, g: Matrix, q: Matrix, n: int) -> Matrix:
    """Return the limit of (R4), or what it is where it stops to converge."""
    rate = norm(a, n) + norm(transposed(a, n), n) + sqrt(norm(g, n) * norm(q, n))
    one = unit(a, n)
    shifted = combined(1.0, a, -rate, one)
    drive = solve(shifted, g, n)
    inverse = solve(shifted, one, n)
    w = solve(combined(1.0, transposed(shifted, n), 1.0, product(q, drive, n)), one, n)
    a_k = combined(1.0, one, 2.0 * rate, transposed(w, n))  # (R2)
    g_k = product(combined(2.0 * rate, drive, 0.0, drive), w, n)
    h_k = product(combined(2.0 * rate, w, 0.0, w), product(q, inverse, n), n)
    size, steps = norm(a_k, n), 0
    while size > FADED and size < GROWN and steps < DOUBLINGS:
        v = combined(1.0, one, 1.0, product(g_k, h_k, n))
        moved = solve(v, a_k, n)
        driven = solve(v, g_k, n)
        back = transposed(a_k, n)
        g_k = combined(1.0, g_k, 1.0, product(a_k, product(driven, back, n), n))  # (R3)
        h_k = combined(1.0, h_k, 1.0, product(back, product(h_k, moved, n), n))  # (R4)
        a_k = product(a_k, moved, n)
        size, steps = norm(a_k, n), steps + 1
    return h_k


def _lyapunov(c: Matrix, r: Matrix, n: int) -> Matrix:
    """Return E of (R6), or zeros where C does not decay."""
    rate = 2.0 * norm(c, n)
    one = unit(c, n)
    less = combined(rate, one, -1.0, c)
    s = solve(less, combined(rate, one, 1.0, c), n)
    inverse = solve(less, one, n)
    e = product(transposed(inverse, n), product(combined(2.0 * rate, r, 0.0, r), inverse, n), n)
    size, steps = norm(s, n), 0
    while size > FADED and size < GROWN and steps < DOUBLINGS:
        e = combined(1.0, e, 1.0, product(transposed(s, n), product(e, s, n), n))  # (R6)
        s = product(s, s, n)
        size, steps = norm(s, n), steps + 1
    if size > FADED:
        return combined(0.0, r, 0.0, r)
    return e
