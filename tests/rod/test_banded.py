"""Banded matrices against dense ones, with numpy's own routines."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.rod import banded


def band(seed: int, n: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows of a random symmetric banded matrix, and the same as a full one."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(n, width + 1))
    full = np.zeros((n, n))
    for i in range(n):
        for k in range(min(width, i) + 1):
            full[i, i - k] = full[i - k, i] = rows[i, k]
    return rows, full


@pytest.mark.parametrize("width", [1, 3, 7])
@pytest.mark.parametrize("shift", [0.0, -1.5, 4.0])
def test_solutions_and_inertia(width: int, shift: float) -> None:
    """Solutions to 1e-8, negative pivots as many as negative eigenvalues (Sylvester)."""
    rows, full = band(width, 60, width)
    full = full + shift * np.eye(60)
    factor = np.empty_like(rows)
    assert banded.factorise(rows, shift, factor) == (np.linalg.eigvalsh(full) < 0).sum()
    x = np.random.default_rng(1).normal(size=(60, 2))
    solution = x.copy()
    banded.solve(factor, solution)
    assert np.abs(full @ solution - x).max() < 1e-8


def test_products() -> None:
    rows, full = band(5, 40, 3)
    x = np.random.default_rng(2).normal(size=(40, 3))
    y = np.empty_like(x)
    banded.multiply(rows, x, y)
    assert np.abs(y - full @ x).max() < 1e-13


def test_blocks_are_reduced_to_their_coordinates() -> None:
    """Q^T H Q + diag(extra) with H and Q written out in full."""
    rng = np.random.default_rng(3)
    n, d = 7, 3
    own = rng.normal(size=(n, 4, 4))
    own = own + own.transpose(0, 2, 1)
    beside, basis, extra = rng.normal(size=(n - 1, 4, 4)), rng.normal(size=(n, 4, d)), rng.normal(size=(n, d))
    H, Q = np.zeros((4 * n, 4 * n)), np.zeros((4 * n, n * d))
    for e in range(n):
        here = slice(4 * e, 4 * e + 4)
        H[here, here] = own[e]
        Q[here, e * d : e * d + d] = basis[e]
        if e:
            before = slice(4 * e - 4, 4 * e)
            H[before, here], H[here, before] = beside[e - 1], beside[e - 1].T
    want = Q.T @ H @ Q + np.diag(extra.ravel())
    rows = np.empty((n * d, 2 * d))
    banded.reduce_blocks(own, beside, basis, extra, rows)
    for i in range(n * d):
        for k in range(min(2 * d - 1, i) + 1):
            assert rows[i, k] == pytest.approx(want[i, i - k], abs=1e-12)


def test_a_matrix_without_inverse_is_told_by_large_solutions() -> None:
    """A pivot of zero is replaced by a small one: no division by zero, and H x = b fails visibly."""
    rows = np.array([[1.0, 0.0], [1.0, 1.0]])
    factor = np.empty_like(rows)
    banded.factorise(rows, 0.0, factor)
    x = np.array([[1.0], [0.0]])
    banded.solve(factor, x)
    assert np.isfinite(x).all()
    assert np.abs(x).max() > 1e10
