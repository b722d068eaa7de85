"""Symmetric banded matrices: reduced from blocks along a fiber, factorised, solved and counted.

A matrix H of bandwidth w is kept as rows (n, w + 1) with H[i, i - k] in place [i, k]. The factors of H +
shift = L D L^T have the same layout, D in place [i, 0]. There is no pivoting: matrices may be indefinite,
and the signs of D count eigenvalues below -shift (Sylvester); what is solved is refined by who calls.
"""

from __future__ import annotations

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats

SMALLEST_PIVOT = 1e-14
"""Least pivot in units of the largest entry on the diagonal; smaller ones are replaced by it."""


def reduce_blocks(own: Floats, beside: Floats, basis: Floats, extra: Floats, band: Floats) -> None:
    """Rows (n d, 2 d) of the matrix Q^T H Q + diag(extra) of an open chain of n edges.

    own (n, 4, 4) and beside (n - 1, 4, 4) are the blocks of H on edges and between neighbours, the columns
    of basis (n, 4, d) are the directions that edges may move in, extra is (n, d).
    """
    n, d = extra.shape
    band[:] = 0.0
    for e in range(n):
        for i in range(d):
            row = e * d + i
            for j in range(i + 1):
                total = extra[e, i] if i == j else 0.0
                for c in range(4):
                    for b in range(4):
                        total += basis[e, c, i] * own[e, c, b] * basis[e, b, j]
                band[row, i - j] = total
            if e > 0:
                for j in range(d):
                    total = 0.0
                    for c in range(4):
                        for b in range(4):
                            total += basis[e - 1, c, j] * beside[e - 1, c, b] * basis[e, b, i]
                    band[row, d + i - j] = total


def factorise(band: Floats, shift: float, factor: Floats) -> int:
    """L and D of band + shift, into factor of the same shape; returns how many pivots are negative."""
    n, width = band.shape
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(band[i, 0] + shift))
    least = SMALLEST_PIVOT * largest
    negative = 0
    for i in range(n):
        pivot = band[i, 0] + shift
        for k in range(min(width - 1, i), 0, -1):
            j = i - k
            total = band[i, k]
            for m in range(k + 1, min(width - 1, i) + 1):
                if m - k < width:
                    total -= factor[i, m] * factor[i - m, 0] * factor[j, m - k]
            factor[i, k] = total / factor[j, 0]
            pivot -= factor[i, k] * total
        if abs(pivot) < least:
            pivot = -least if pivot < 0.0 else least
        factor[i, 0] = pivot
        if pivot < 0.0:
            negative += 1
    return negative


def solve(factor: Floats, x: Floats) -> None:
    """Right-hand sides x (n, k) become solutions, in place."""
    n, width = factor.shape
    columns = x.shape[1]
    for i in range(n):
        for k in range(1, min(width - 1, i) + 1):
            for c in range(columns):
                x[i, c] -= factor[i, k] * x[i - k, c]
    for i in range(n):
        for c in range(columns):
            x[i, c] /= factor[i, 0]
    for i in range(n - 1, -1, -1):
        for k in range(1, min(width - 1, i) + 1):
            for c in range(columns):
                x[i - k, c] -= factor[i, k] * x[i, c]


def multiply(band: Floats, x: Floats, y: Floats) -> None:
    """y = H x for columns x, y (n, k)."""
    n, width = band.shape
    y[:] = 0.0
    for i in range(n):
        for c in range(x.shape[1]):
            y[i, c] += band[i, 0] * x[i, c]
        for k in range(1, min(width - 1, i) + 1):
            for c in range(x.shape[1]):
                y[i, c] += band[i, k] * x[i - k, c]
                y[i - k, c] += band[i, k] * x[i, c]


def condense(
    band: Floats,
    shift: float,
    border: tuple[Floats, Floats, Floats],
    factor: Floats,
    reduced: tuple[Floats, Floats],
) -> int:
    """Factorise H + shift into factor, and reduce its border, as for `solve_bordered`.

    Returns how many pivots of H + shift are negative.
    """
    right, left, corner = border
    inner, schur = reduced
    negative = factorise(band, shift, factor)
    n, k = right.shape
    for i in range(n):
        for j in range(k):
            inner[i, j] = right[i, j]
    solve(factor, inner)
    for j in range(k):
        for m in range(k):
            schur[j, m] = corner[j, m]
    for i in range(n):
        for j in range(k):
            for m in range(k):
                schur[j, m] -= left[i, j] * inner[i, m]
    return negative


def solve_bordered(
    band: Floats,
    shift: float,
    factor: Floats,
    border: tuple[Floats, Floats, Floats],
    reduced: tuple[Floats, Floats],
    r: Floats,
    s: Floats,
    refinements: int,
) -> tuple[Floats, Floats, bool]:
    """Solutions dq (n,), ds (k,) of [H + shift, U; V^T, D] with a factorised H, refined; whether there are.

    border is U (n, k), V (n, k), D (k, k); reduced is (H + shift)^-1 U (n, k) and the Schur complement
    D - V^T (H + shift)^-1 U (k, k), from `condense`.
    """
    right, left, corner = border
    inner, schur = reduced
    n, k = right.shape
    x, ds = np.zeros((n, 1)), np.zeros(k)
    rest, below, product = np.empty((n, 1)), np.empty(k), np.empty((n, 1))
    regular = True
    for _ in range(refinements + 1):
        multiply(band, x, product)
        for j in range(k):
            below[j] = s[j]
        for i in range(n):
            rest[i, 0] = r[i] - product[i, 0] - shift * x[i, 0]
            for j in range(k):
                rest[i, 0] -= right[i, j] * ds[j]
                below[j] -= left[i, j] * x[i, 0]
        for j in range(k):
            for m in range(k):
                below[j] -= corner[j, m] * ds[m]
        regular = _solve_once(factor, left, inner, schur, rest, below)
        for i in range(n):
            x[i, 0] += rest[i, 0]
        for j in range(k):
            ds[j] += below[j]
    return x.reshape(n), ds, regular


def _solve_once(factor: Floats, left: Floats, inner: Floats, schur: Floats, x: Floats, ds: Floats) -> bool:
    """Right-hand sides x (n, 1) and ds (k,) become solutions, in place; whether the complement is regular."""
    solve(factor, x)
    n, k = inner.shape
    for j in range(k):
        for i in range(n):
            ds[j] -= left[i, j] * x[i, 0]
    regular = _solve_dense(schur.copy(), ds)
    for i in range(n):
        for j in range(k):
            x[i, 0] -= inner[i, j] * ds[j]
    return regular


def _solve_dense(matrix: Floats, x: Floats) -> bool:
    """A right-hand side x (k,) becomes the solution, in place, by elimination with partial pivoting.

    The matrix (k, k) is overwritten. Returns False, and x stays unsolved, when a pivot is nothing.
    """
    k = len(x)
    for c in range(k):
        top = c
        for row in range(c + 1, k):
            if abs(matrix[row, c]) > abs(matrix[top, c]):
                top = row
        if matrix[top, c] == 0.0:
            return False
        for m in range(k):
            matrix[c, m], matrix[top, m] = matrix[top, m], matrix[c, m]
        x[c], x[top] = x[top], x[c]
        for row in range(c + 1, k):
            share = matrix[row, c] / matrix[c, c]
            for m in range(c + 1, k):
                matrix[row, m] -= share * matrix[c, m]
            x[row] -= share * x[c]
    for c in range(k - 1, -1, -1):
        for m in range(c + 1, k):
            x[c] -= matrix[c, m] * x[m]
        x[c] /= matrix[c, c]
    return True


compile_kernels(
    __name__,
    splice=("_solve_once", "_solve_dense"),
    owning=("solve_bordered", "_solve_once", "_solve_dense"),
)
