"""The two linear systems of overdamped motion against dense solves."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, circle, random_strand, straight, tangle, toy_model
from torsade.assembly import assemble, initial_state
from torsade.motion import ends
from torsade.rod.damping import power_of_drag, solve_spin, spin_work

RNG_SEEDS = [0, 1, 2]


def dense_velocities(a, M, force, held, prescribed):
    """Solve M v = F on the nodes that are not held; a body that floats keeps its centre (node lengths)."""
    v = np.where(held[:, None], prescribed, 0.0)
    free = ~held
    if held.any():
        v[free] = np.linalg.solve(M[np.ix_(free, free)], force[free] - M[np.ix_(free, held)] @ v[held])
        return v
    v = np.linalg.lstsq(M, force, rcond=1e-12)[0]
    return v - a.node_length @ v / a.node_length.sum()


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", RNG_SEEDS)
@pytest.mark.parametrize("case", ["floating", "held end", "moving ends", "scattered"])
def test_velocities_solve_the_dense_system(seed, closed, case):
    """Conjugate gradients agree with LAPACK on tangles with contact, whatever is held or moved."""
    a, state, h = tangle(seed, closed)
    rng = np.random.default_rng(seed)
    bc = ends.free(a)
    if case == "floating":
        push = rng.normal(size=state.x.shape)
        bc = bc._replace(force=push - push.mean(axis=0))
    elif case == "held end":
        bc = ends.clamp(ends.pull(bc, a, 1, 1, np.array([1.0, 2.0, 3.0])), a, 1, 0)
    elif case == "moving ends":
        bc = ends.move(ends.clamp(bc, a, 1, 0), a, 1, 1, np.array([0.1, -0.2, 0.3]))
    else:
        held = rng.uniform(size=len(state.x)) < 0.2
        bc = bc._replace(held=held, velocity=np.where(held[:, None], rng.normal(size=state.x.shape), 0.0))
    probe = Probe(a, toy_model(h), state, bc)
    v, _, _ = probe.rates(state.x, state.theta, 1e-12)
    assert len(probe.touching()) > 10
    force, _ = probe.forces(state.x, state.theta)
    v = v.copy()
    M = probe.drag_matrix(state.x, state.theta)
    expected = dense_velocities(a, M, force, bc.held, bc.velocity)
    assert np.abs(v - expected).max() < 1e-8 * np.abs(expected).max()
    assert np.array_equal(v[bc.held], bc.velocity[bc.held])


@pytest.mark.parametrize("seed", RNG_SEEDS)
def test_power_of_some_nodes_is_their_part_of_the_quadratic_form(seed):
    """Sum of v_i . (M v)_i over the nodes chosen, M made column by column; over all, what drag dissipates."""
    a, state, h = tangle(seed)
    probe = Probe(a, toy_model(h), state)
    M = probe.drag_matrix(state.x, state.theta)
    rng = np.random.default_rng(seed)
    v = rng.normal(size=state.x.shape)
    each = np.einsum("ic,ic->i", v, M @ v)
    for chosen in (rng.uniform(size=len(v)) < 0.3, np.ones(len(v), bool), np.zeros(len(v), bool)):
        power = power_of_drag(a, probe.m.eta_A, probe.contacts, v, chosen)
        assert power == pytest.approx(each[chosen].sum(), rel=1e-11, abs=1e-12 * np.abs(each).sum())


def test_bodies_apart_float_each_on_its_own():
    """Two strands that do not touch are two bodies: the centre of each stays, forces do not mix."""
    strands = [random_strand(0, 12), random_strand(1, 15) + 10.0]
    a = assemble(strands)
    state = initial_state(a, strands)
    state.theta[:] = np.random.default_rng(0).normal(size=len(state.theta))
    probe = Probe(a, toy_model(0.02), state)
    v, _, _ = probe.rates(state.x, state.theta, 1e-12)
    force, _ = probe.forces(state.x, state.theta)
    M = probe.drag_matrix(state.x, state.theta)
    for f in range(2):
        part = slice(a.node_start[f], a.node_start[f + 1])
        v_f = np.linalg.lstsq(M[part, part], force[part], rcond=1e-12)[0]
        v_f -= a.node_length[part] @ v_f / a.node_length[part].sum()
        assert np.abs(v[part] - v_f).max() < 1e-8 * np.abs(v_f).max()


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
