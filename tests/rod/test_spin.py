"""Spins of overdamped motion against dense solves."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import circle, random_strand, straight
from torsade.assembly import assemble
from torsade.rod.spin import solve_spin, spin_work

RNG_SEEDS = [0, 1, 2]


def dense_spins(a, eta_J, tangent, torque, weight, fixed, prescribed):
    n = len(torque)
    D = np.diag(weight)
    for k, (p, q, _) in enumerate(a.hinges):
        w = eta_J / a.hinge_length[k]
        c = tangent[p] @ tangent[q]
        D[p, p] += w
        D[q, q] += w
        D[p, q] -= w * c
        D[q, p] -= w * c
    omega = np.where(fixed, prescribed, 0.0)
    rest = ~fixed
    if rest.any():
        rhs = torque[rest] - D[np.ix_(rest, fixed)] @ omega[fixed]
        omega[rest] = np.linalg.solve(D[np.ix_(rest, rest)], rhs)
    assert n == len(omega)
    return omega


@pytest.mark.parametrize("seed", RNG_SEEDS)
@pytest.mark.parametrize("dragged", [False, True])
@pytest.mark.parametrize("turned", ["none", "first", "last", "both", "inside", "all"])
def test_spins_solve_the_dense_system(seed, dragged, turned):
    """Open and closed (cyclic) chains, with and without collision drag, with edges turned anywhere."""
    rng = np.random.default_rng(seed)
    strands = [
        random_strand(seed, 9),
        0.3 * circle(11, 1.0) + 0.05 * rng.normal(size=(11, 3)),
        random_strand(9, 4),
    ]
    a = assemble(strands, [False, True, False])
    n = len(a.edges)
    fixed = np.zeros(n, bool)
    for f in range(3):
        first, last = a.edge_start[f], a.edge_start[f + 1] - 1
        chosen = {
            "none": [], "first": [first], "last": [last], "both": [first, last],
            "inside": [first + 1, first + 2], "all": list(range(first, last + 1)),
        }[turned]  # fmt: skip
        fixed[chosen] = True
    x = np.concatenate(strands)
    edge = x[a.edges[:, 1]] - x[a.edges[:, 0]]
    tangent = edge / np.linalg.norm(edge, axis=1, keepdims=True)
    torque, prescribed = rng.normal(size=n), rng.normal(size=n)
    weight = rng.uniform(0, 2, n) if dragged else np.zeros(n)
    omega = np.empty(n)
    solve_spin(a, 0.7, tangent, torque, weight, fixed, prescribed, omega, spin_work(n))
    expected = dense_spins(a, 0.7, tangent, torque, weight, fixed, prescribed)
    assert np.abs(omega - expected).max() < 1e-8 * np.abs(expected).max()
    assert np.array_equal(omega[fixed], prescribed[fixed])


def test_a_straight_free_fiber_spins_only_as_its_torques_say():
    """Balanced torques on a fiber free to spin: differences as the series of dashpots, no runaway spin."""
    x = straight(6, 1.0)
    a = assemble([x])
    torque = np.array([1.0, 0.0, 0.0, 0.0, -1.0])
    omega, none = np.empty(5), np.zeros(5, bool)
    solve_spin(
        a, 2.0, np.tile([1.0, 0, 0], (5, 1)), torque, np.zeros(5), none, np.zeros(5), omega, spin_work(5)
    )
    assert np.allclose(np.diff(omega), -0.2 / 2.0, rtol=1e-6)
    assert abs(omega.mean()) < 1e-3


def test_one_edge_alone():
    """A single edge has nothing to resist its spin: it stays at rest unless it is turned."""
    x = straight(2, 1.0)
    a = assemble([x])
    omega, fixed = np.empty(1), np.zeros(1, bool)
    t = np.array([[1.0, 0, 0]])
    solve_spin(a, 1.0, t, np.zeros(1), np.zeros(1), fixed, np.zeros(1), omega, spin_work(1))
    assert omega[0] == 0.0
    solve_spin(a, 1.0, t, np.zeros(1), np.zeros(1), ~fixed, np.full(1, 3.0), omega, spin_work(1))
    assert omega[0] == 3.0
