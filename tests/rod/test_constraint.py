"""The projection onto edge lengths, against dense linear algebra and what it must conserve."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.assembly import assemble, split
from torsade.rod import constraint


def chain(n: int = 12, pieces: int = 2, seed: int = 3):
    """Crooked fibers with random masses; a few nodes held."""
    rng = np.random.default_rng(seed)
    strands = [np.cumsum(rng.normal(size=(n, 3)), axis=0) for _ in range(pieces)]
    a = assemble(strands)
    w = rng.uniform(0.5, 2.0, len(a.node_length))
    w[[0, 5]] = 0.0
    x = np.concatenate(strands)
    tangent = x[a.edges[:, 1]] - x[a.edges[:, 0]]
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return a, w, x, tangent, rng


def gradients(a, tangent):
    """(n_edges, n_nodes, 3) derivatives of edge lengths by nodes."""
    g = np.zeros((len(a.edges), len(a.node_length), 3))
    for e, (i, j) in enumerate(a.edges):
        g[e, i], g[e, j] = -tangent[e], tangent[e]
    return g


def factors(a, w, tangent):
    below, inverse = np.empty(len(a.edges)), np.empty(len(a.edges))
    constraint.factor_constraint(a, w, tangent, below, inverse)
    return below, inverse


def test_the_tridiagonal_solve_is_that_of_the_dense_matrix() -> None:
    a, w, _, tangent, rng = chain()
    g = gradients(a, tangent)
    dense = np.einsum("enc,n,fnc->ef", g, w, g)
    loss = rng.normal(size=len(a.edges))
    p = loss.copy()
    constraint.solve_constraint(a, *factors(a, w, tangent), p)
    np.testing.assert_allclose(p, np.linalg.solve(dense, loss), rtol=1e-10, atol=1e-12)


def test_projected_velocities_keep_all_lengths_and_are_the_nearest_that_do() -> None:
    """The change is along the constraints' gradients, weighted by inverse masses: least in kinetic energy."""
    a, w, _, tangent, rng = chain()
    v = rng.normal(size=(len(w), 3))
    after = v.copy()
    constraint.project_velocities(a, w, tangent, *factors(a, w, tangent), after, np.empty(len(a.edges)))
    g = gradients(a, tangent)
    assert np.abs(np.einsum("enc,nc->e", g, after)).max() < 1e-12
    assert np.array_equal(after[w == 0], v[w == 0])
    free = w > 0
    impulse = (after - v)[free] / w[free, None]
    basis = g[:, free].reshape(len(a.edges), -1)
    left = impulse.ravel() - basis.T @ np.linalg.lstsq(basis.T, impulse.ravel(), rcond=None)[0]
    assert np.abs(left).max() < 1e-10


def test_positions_come_back_to_their_lengths_and_keep_the_centre_of_mass() -> None:
    a, w, x, tangent, rng = chain(pieces=1)
    w[:] = rng.uniform(0.5, 2.0, len(w))  # nothing held
    moved = x + 0.02 * rng.normal(size=x.shape)
    before = moved.copy()
    p, pull = np.empty(len(a.edges)), np.empty(len(a.edges))
    n = constraint.project_positions(a, w, tangent, *factors(a, w, tangent), 1e-13, 50, moved, p, pull)
    assert 0 < n < 20
    lengths = np.linalg.norm(moved[a.edges[:, 1]] - moved[a.edges[:, 0]], axis=1)
    assert np.abs(lengths / a.rest_length - 1).max() < 1e-12
    mass = 1 / w
    np.testing.assert_allclose(mass @ (moved - before), 0.0, atol=1e-11)
    again = before.copy()
    constraint.add_impulses(a, w, tangent, pull, 1.0, again)
    np.testing.assert_allclose(again, moved, atol=1e-13)


def test_what_cannot_be_kept_is_said() -> None:
    """Held ends too far apart: there is no such chain."""
    x = np.outer(np.linspace(0.0, 1.0, 6), [1.0, 0.0, 0.0])
    a = assemble([x])
    w = np.ones(6)
    w[[0, -1]] = 0.0
    x[-1, 0] = 1.1
    tangent = np.tile([1.0, 0.0, 0.0], (5, 1))
    p, pull = np.empty(5), np.empty(5)
    assert constraint.project_positions(a, w, tangent, *factors(a, w, tangent), 1e-12, 30, x, p, pull) == -1


def test_a_straight_chain_between_held_ends_is_no_division_by_zero() -> None:
    a = assemble([np.outer(np.arange(6.0), [0.0, 1.0, 0.0])])
    w = np.ones(6)
    w[[0, -1]] = 0.0
    tangent = np.tile([0.0, 1.0, 0.0], (5, 1))
    v = np.zeros((6, 3))
    v[2] = [1.0, 0.5, 0.0]
    constraint.project_velocities(a, w, tangent, *factors(a, w, tangent), v, np.empty(5))
    np.testing.assert_allclose(np.diff(v[:, 1]), 0.0, atol=1e-12)
    assert v[2, 0] == 1.0


@pytest.mark.parametrize("hinge", [0, 3, 8])
def test_an_assembly_that_is_split_is_the_one_assembled_of_its_parts(hinge: int) -> None:
    rng = np.random.default_rng(1)
    first, second = np.cumsum(rng.normal(size=(11, 3)), axis=0), np.cumsum(rng.normal(size=(5, 3)), axis=0)
    got = split(assemble([first, second]), hinge)
    wanted = assemble([first[: hinge + 2], first[hinge + 1 :], second])
    for name, mine, theirs in zip(got._fields, got, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-14, err_msg=name)


def test_later_fibers_can_be_split_too() -> None:
    rng = np.random.default_rng(2)
    strands = [np.cumsum(rng.normal(size=(n, 3)), axis=0) for n in (4, 7, 5)]
    got = split(assemble(strands), 2 + 3)
    wanted = assemble([strands[0], strands[1][:5], strands[1][4:], strands[2]])
    for name, mine, theirs in zip(got._fields, got, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-14, err_msg=name)
