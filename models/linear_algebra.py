"""Linear algebra: products, linear equations, the exponential and singular values of small matrices.

A matrix is a list of floats, row by row: element (i, j) of one with n columns stands at n i + j. All is plain
Python, so that a model that uses it needs no package.

Source: N. J. Higham, "The scaling and squaring method for the matrix exponential revisited", SIAM J. Matrix
Anal. Appl. 26(4), 2005, for (A1); M. R. Hestenes, "Inversion of matrices by biorthogonalization and related
results", J. SIAM 6(1), 1958, for (A2).

    exp(A) = [p(-X)^-1 p(X)]^(2^s),   X = A/2^s,  |X| <= 2.69         p: Pade's of degree 13      (A1)
    V M has orthogonal rows, for an orthogonal V                      their lengths: those of M   (A2)

The coefficients of p are Higham's, and so is the 1-norm 5.37 up to which it is exact to rounding.

published: nothing that a paper of the models prints.
chosen: half of that norm, where p(-X) is so well conditioned that rounding stays below 1e-14.

At the edges: A X = B with a singular A gives X = 0.
"""

from __future__ import annotations

from math import inf, sqrt

Matrix = list[float]
"""Rows of a matrix, one after the other."""

PADE = (
    64764752532480000.0, 32382376266240000.0, 7771770303897600.0, 1187353796428800.0, 129060195264000.0,
    10559470521600.0, 670442572800.0, 33522128640.0, 1323241920.0, 40840800.0, 960960.0, 16380.0, 182.0, 1.0,
)  # fmt: skip # coefficients of p, from that of X^0 on
LARGEST_NORM = 0.5 * 5.371920351148152
SWEEPS = 60  # of (A2), at most; a handful is enough
ORTHOGONAL = 1e-15  # cosine of an angle that counts as right


def product(a: Matrix, b: Matrix, n: int) -> Matrix:
    """Return A B, both of n x n."""
    c = [0.0] * len(a)
    for i in range(n):
        for k in range(n):
            factor = a[n * i + k]
            if factor != 0.0:
                for j in range(n):
                    c[n * i + j] += factor * b[n * k + j]
    return c


def transposed(a: Matrix, n: int) -> Matrix:
    """Return A', for A of n x n."""
    b = [0.0] * len(a)
    for i in range(n):
        for j in range(n):
            b[n * j + i] = a[n * i + j]
    return b


def unit(a: Matrix, n: int) -> Matrix:
    """Return the unit matrix of the size of A, n x n."""
    b = [0.0] * len(a)
    for i in range(n):
        b[(n + 1) * i] = 1.0
    return b


def combined(x: float, a: Matrix, y: float, b: Matrix) -> Matrix:
    """Return x A + y B."""
    c = [0.0] * len(a)
    for i in range(len(a)):
        c[i] = x * a[i] + y * b[i]
    return c


def norm(a: Matrix, n: int) -> float:
    """Return the 1-norm of A, n x n: the largest sum of a column's absolute values; infinite for a NaN."""
    largest = 0.0
    for j in range(n):
        column = 0.0
        for i in range(n):
            column += abs(a[n * i + j])
        if not column < inf:
            return inf
        largest = max(largest, column)
    return largest


def solve(a: Matrix, b: Matrix, n: int) -> Matrix:
    """Return X of A X = B, all of n x n, by elimination with partial pivoting."""
    m = combined(1.0, a, 0.0, a)
    x = combined(1.0, b, 0.0, b)
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(m[n * i + k]) > abs(m[n * pivot + k]):
                pivot = i
        if m[n * pivot + k] == 0.0:
            return combined(0.0, m, 0.0, m)
        if pivot != k:
            _exchange(m, k, pivot, n)
            _exchange(x, k, pivot, n)
        for i in range(k + 1, n):
            factor = m[n * i + k] / m[n * k + k]
            if factor != 0.0:
                for j in range(k + 1, n):
                    m[n * i + j] -= factor * m[n * k + j]
                for j in range(n):
                    x[n * i + j] -= factor * x[n * k + j]
    for k in range(n - 1, -1, -1):
        for j in range(n):
            value = x[n * k + j]
            for i in range(k + 1, n):
                value -= m[n * k + i] * x[n * i + j]
            x[n * k + j] = value / m[n * k + k]
    return x


def _exchange(a: Matrix, first: int, second: int, n: int) -> None:
    """Exchange two rows of A, which has n columns."""
    for j in range(n):
        value = a[n * first + j]
        a[n * first + j] = a[n * second + j]
        a[n * second + j] = value


def exponential(a: Matrix, n: int) -> Matrix:
    """Return exp(A), for A of n x n."""
    scale, squarings, size = 1.0, 0, norm(a, n)
    while size > LARGEST_NORM and squarings < 1100:  # a norm above the largest float ends too
        scale, squarings, size = 0.5 * scale, squarings + 1, 0.5 * size
    x = combined(scale, a, 0.0, a)
    x2 = product(x, x, n)
    x4 = product(x2, x2, n)
    x6 = product(x4, x2, n)
    one = unit(a, n)
    odd = [0.0] * len(a)
    even = [0.0] * len(a)
    for i in range(len(a)):
        odd[i] = PADE[13] * x6[i] + PADE[11] * x4[i] + PADE[9] * x2[i]
        even[i] = PADE[12] * x6[i] + PADE[10] * x4[i] + PADE[8] * x2[i]
    odd = product(x6, odd, n)
    even = product(x6, even, n)
    for i in range(len(a)):
        odd[i] += PADE[7] * x6[i] + PADE[5] * x4[i] + PADE[3] * x2[i] + PADE[1] * one[i]
        even[i] += PADE[6] * x6[i] + PADE[4] * x4[i] + PADE[2] * x2[i] + PADE[0] * one[i]
    odd = product(x, odd, n)
    x = solve(combined(1.0, even, -1.0, odd), combined(1.0, even, 1.0, odd), n)  # (A1)
    for _ in range(squarings):
        x = product(x, x, n)
    return x


def singular_values(m: Matrix, rows: int, columns: int) -> tuple[float, float]:
    """Return the smallest and the largest singular value of M, rows x columns, with rows <= columns."""
    v = combined(1.0, m, 0.0, m)
    turned, sweep = True, 0
    while turned and sweep < SWEEPS:
        turned, sweep = False, sweep + 1
        for i in range(rows - 1):
            for j in range(i + 1, rows):
                if _turn(v, columns * i, columns * j, columns):
                    turned = True
    smallest, largest = 0.0, 0.0
    for i in range(rows):
        size = sqrt(_inner(v, columns * i, columns * i, columns))  # (A2)
        if i == 0 or size < smallest:
            smallest = size
        if i == 0 or size > largest:
            largest = size
    return smallest, largest


def _inner(m: Matrix, first: int, second: int, columns: int) -> float:
    """Return the inner product of the rows that begin at `first` and at `second`."""
    value = 0.0
    for k in range(columns):
        value += m[first + k] * m[second + k]
    return value


def _turn(m: Matrix, first: int, second: int, columns: int) -> bool:
    """Turn two rows until they are orthogonal; return False if they were."""
    x, y = _inner(m, first, first, columns), _inner(m, second, second, columns)
    z = _inner(m, first, second, columns)
    if not abs(z) > ORTHOGONAL * sqrt(x) * sqrt(y):  # nor is one that is no number turned
        return False
    zeta = 0.5 * (y - x) / z
    tangent = 1.0 / (abs(zeta) + sqrt(1.0 + zeta * zeta))
    if zeta < 0.0:
        tangent = -tangent
    cosine = 1.0 / sqrt(1.0 + tangent * tangent)
    sine = cosine * tangent
    for k in range(columns):
        p, q = m[first + k], m[second + k]
        m[first + k], m[second + k] = cosine * p - sine * q, sine * p + cosine * q
    return True
