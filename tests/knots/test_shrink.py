"""Kernels of tightening: forces are gradients, contacts are all found, matrices are what rows say."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.knots import shrink
from torsade.knots import tight_kernels as kernels
from torsade.knots.shrink import Settings, loops_of, relax

Floats = np.ndarray


def bent_pair() -> tuple[Floats, kernels.Loops]:
    """Two linked rings that overlap, shaken, with nodes bent too sharply."""
    random = np.random.default_rng(5)
    angle = 2 * np.pi * np.arange(30) / 30
    ring = 1.7 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    x = np.concatenate([ring, ring[:24, [0, 2, 1]] * 0.95 + (1.7, 0, 0)])
    return x + 0.02 * random.normal(size=x.shape), loops_of(np.array([30, 24]))


def test_loops_close() -> None:
    loops = loops_of(np.array([3, 4]))
    assert loops.after.tolist() == [1, 2, 0, 4, 5, 6, 3]
    assert loops.before[loops.after].tolist() == list(range(7))
    assert loops.size.tolist() == [3, 3, 3, 4, 4, 4, 4]


def test_touching_pairs_are_those_of_brute_force() -> None:
    x, loops = bent_pair()
    p = np.empty((2 * len(x), 3))
    kernels.samples(x, loops, p)
    found = {tuple(pair) for pair in kernels.touching(p, loops, 2.1, 20).tolist()}
    expected = set()
    for a in range(len(p)):
        for b in range(a + 1, len(p)):
            same = loops.strand[a // 2] == loops.strand[b // 2]
            around = min(b - a, 2 * loops.size[a // 2] - (b - a))
            if np.linalg.norm(p[a] - p[b]) < 2.1 and not (same and around <= 20):
                expected.add((a, b))
    assert found == expected
    assert len(expected) > 100


def test_forces_are_minus_the_gradient() -> None:
    """Of length, spacing, overlaps and bends together; kinks and contacts are both there."""
    x, loops = bent_pair()
    scales = shrink._scales(x, loops, 100.0)
    p, kappa = shrink._sampled(x, loops, scales)
    rows = shrink._rows(x, p, kappa, loops, scales, 0.1)
    assert (rows.gap[: rows.contacts] > 0).sum() > 50
    assert (rows.gap[rows.contacts :] > 0).sum() > 5
    force, _ = shrink._tension(x, loops, scales)
    kernels.add_forces(rows, rows.weight * np.maximum(rows.gap, 0.0), force)
    random = np.random.default_rng(1)
    for _ in range(3):
        d = 1e-6 * random.normal(size=x.shape)
        change = shrink._energy(x + d, loops, scales) - shrink._energy(x - d, loops, scales)
        assert change == pytest.approx(-2 * float((force * d).sum()), rel=1e-5)


def test_the_matrix_is_that_of_the_rows() -> None:
    """Against the sum of weight times push times push, in full."""
    x, loops = bent_pair()
    n = len(x)
    scales = shrink._scales(x, loops, 100.0)
    p, kappa = shrink._sampled(x, loops, scales)
    rows = shrink._rows(x, p, kappa, loops, scales, 0.1)
    place, start = np.empty((n, n), np.int64), np.empty(3 * n + 1, np.int64)
    kernels.mark(loops, rows, place)
    row = np.empty(9 * int((place >= 0).sum()), np.int64)
    kernels.columns(place, start, row)
    value = np.zeros(len(row))
    active = rows.gap > 0
    kernels.constraint_matrix(rows, active, place, start, value)
    found = np.zeros((3 * n, 3 * n))
    for c in range(3 * n):
        found[row[start[c] : start[c + 1]], c] = value[start[c] : start[c + 1]]
    jacobian = np.zeros((len(active), n, 3))
    for k in np.flatnonzero(active):
        np.add.at(jacobian[k], rows.node[k], rows.push[k])
    flat = jacobian.reshape(len(active), -1)
    np.testing.assert_allclose(found, flat.T @ (rows.weight[:, None] * flat), atol=1e-9)
    d = np.random.default_rng(2).normal(size=x.shape)
    rate = np.empty(len(active))
    kernels.derivative(rows, d, rate)
    np.testing.assert_allclose(rate[active], (flat @ d.ravel())[active], atol=1e-12)


def test_the_share_of_a_step_is_where_the_model_is_lowest() -> None:
    gap, rate, weight = np.array([0.5, -0.2, 0.1]), np.array([1.0, -1.0, 0.0]), np.array([2.0, 3.0, 1.0])
    slope, curve = -0.3, 0.7
    share = np.linspace(0, 1, 100_001)
    left = np.maximum(gap[:, None] - share * rate[:, None], 0)
    model = slope * share + curve * share**2 / 2 + (weight[:, None] * left**2).sum(axis=0) / 2
    found = kernels.lowest_share(gap, rate, weight, slope, curve)
    assert found == pytest.approx(share[model.argmin()], abs=1e-4)
    assert kernels.lowest_share(gap, rate, weight, -100.0, curve) == 1.0


def test_energy_falls_and_steps_are_safe() -> None:
    """Nodes never move as far as half the distance of strands."""
    x, loops = bent_pair()
    x = 1.2 * x
    energies = []
    for _ in range(8):
        found = relax(x, loops, Settings(30.0, 10.0, 1, 1e-3))
        scales = shrink._scales(x, loops, 30.0)
        p, _ = shrink._sampled(x, loops, scales)
        pairs = kernels.touching(p, loops, 4.0, scales.apart)
        nearest = np.linalg.norm(p[pairs[:, 0]] - p[pairs[:, 1]], axis=1).min()
        assert np.linalg.norm(found.x - x, axis=1).max() < nearest / 2
        energies.append(found.energy)
        x = found.x
    assert np.all(np.diff(energies) < 0)
