"""Bordered systems against dense ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import null_space

from rod.test_banded import band
from torsade.motion.bordered import Bordered

N, K = 50, 4


def bordered(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rows, full = band(seed, N, 3)
    rng = np.random.default_rng(seed)
    return rows, full, rng.normal(size=(N, K)), rng.normal(size=(N, K))


@pytest.mark.parametrize("seed", range(4))
def test_solutions_with_equal_and_unequal_borders(seed: int) -> None:
    rows, full, right, left = bordered(seed)
    corner = np.random.default_rng(9).normal(size=(K, K))
    r, s = np.random.default_rng(8).normal(size=N), np.arange(1.0, K + 1)
    for other in (None, left):
        below = right if other is None else other
        dense = np.block([[full, right], [below.T, corner]])
        dq, ds = Bordered(rows, right, corner, other).solve(r, s)
        assert np.abs(dense @ np.append(dq, ds) - np.append(r, s)).max() < 1e-11


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("shift", [-2.0, 0.0, 3.0])
def test_inertia_counts_what_constraints_leave(seed: int, shift: float) -> None:
    """Negative eigenvalues, less one per constraint, are those of the Hessian where constraints are met."""
    rows, full, border, _ = bordered(seed)
    solver = Bordered(rows, border, np.zeros((K, K)), shift=shift)
    free = null_space(border.T)
    projected = free.T @ (full + shift * np.eye(N)) @ free
    assert solver.negative - K == (np.linalg.eigvalsh(projected) < 0).sum()
