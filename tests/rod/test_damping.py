"""Velocities of overdamped motion against dense solves."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, random_strand, tangle, toy_model
from torsade.assembly import assemble, initial_state
from torsade.motion import ends
from torsade.rod.damping import power_of_drag

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
