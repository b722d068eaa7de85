"""Symmetric banded matrices: reduced from blocks along a fiber, factorised, solved and counted.

A matrix H of bandwidth w is kept as rows (n, w + 1) with H[i, i - k] in place [i, k]. The factors of H +
shift = L D L^T have the same layout, D in place [i, 0]. There is no pivoting: matrices may be indefinite,
and the signs of D count eigenvalues below -shift (Sylvester); what is solved is refined by who calls.
"""

from __future__ import annotations

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


compile_kernels(__name__)
