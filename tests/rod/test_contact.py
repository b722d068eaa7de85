"""Contact forces and collision drag: gradients, sums, the thesis's laws written out by brute force."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from rod.helpers import Probe, circle, gradient, midpoints, straight, tangle, toy_model
from torsade.assembly import assemble, initial_state
from torsade.motion.overdamped import PUBLISHED, STANDARD
from torsade.rod.contact import contact_pressure

SHORT = replace(PUBLISHED, exclusion_edges=3)
LAWS = {"standard": STANDARD, "published": SHORT}


def in_contact(seed, laws=STANDARD, closed=True, **changes):
    a, state, h = tangle(seed, closed)
    probe = Probe(a, toy_model(h, laws, **changes), state)
    probe.rates(state.x, state.theta)
    assert len(probe.touching()) > 10
    return a, state, probe


def along_fiber(a, e, f):
    """Edges apart and rest arclength between midpoints, the shorter way, by walking."""
    fiber = a.edge_fiber[e]
    first, last = a.edge_start[fiber], a.edge_start[fiber + 1]
    rest = a.rest_length[first:last]
    i, j = sorted((e - first, f - first))
    inside = rest[i : j + 1].sum() - (rest[i] + rest[j]) / 2
    if a.closed[fiber]:
        return min(j - i, len(rest) - (j - i)), min(inside, rest.sum() - inside)
    return j - i, inside


def pairs_in_contact(a, m, x):
    """All pairs of edges nearer than the diameter and not excluded, by brute force."""
    mid = midpoints(a, x)
    found = []
    for e, f in combinations(range(len(a.edges)), 2):
        if np.linalg.norm(mid[f] - mid[e]) >= m.diameter:
            continue
        if a.edge_fiber[e] == a.edge_fiber[f]:
            apart, arc = along_fiber(a, e, f)
            if apart <= m.exclusion_edges or arc < m.exclusion_length:
                continue
        found.append((e, f))
    return found


def laplacian_of_collisions(a, m, x):
    """M of collision drag alone, from the laws as ERRATA states them (4.6 symmetrised, or 4.8)."""
    n = len(a.node_length)
    matrix = np.zeros((n, n))
    mid, pairs = midpoints(a, x), pairs_in_contact(a, m, x)
    if not m.node_pair:
        for e, f in pairs:
            w = m.eta_f_A * a.rest_length[e] * a.rest_length[f] / np.linalg.norm(mid[f] - mid[e]) ** 3
            b = np.zeros(n)
            b[a.edges[e]] += 0.5
            b[a.edges[f]] -= 0.5
            matrix += w * np.outer(b, b)
        return matrix
    length = np.linalg.norm(x[a.edges[:, 1]] - x[a.edges[:, 0]], axis=1)
    voronoi = np.zeros(n)
    np.add.at(voronoi, a.edges.ravel(), np.repeat(0.5 * length, 2))
    coupled = {tuple(sorted((a.edges[e, end], a.edges[f, end]))) for e, f in pairs for end in (0, 1)}
    for i, j in coupled:
        w = m.eta_f_A * 0.5 * (voronoi[i] + voronoi[j]) / np.sum((x[i] - x[j]) ** 2)
        b = np.zeros(n)
        b[i], b[j] = 1.0, -1.0
        matrix += w * np.outer(b, b)
    return matrix


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", [0, 1])
def test_product_force_is_minus_the_gradient(seed, closed):
    """F = -dE_c/dx of (4.2) to 1e-7 of the largest force."""
    a, state, probe = in_contact(seed, closed=closed, EA=0.0, B=0.0, C=0.0)
    force, torque = probe.forces(state.x, state.theta)
    by_x = -gradient(lambda x: probe.energy(x, state.theta), state.x, 1e-5)
    assert np.abs(force - by_x).max() < 1e-7 * np.abs(force).max()
    assert np.array_equal(torque, np.zeros(len(a.edges)))


def test_projected_force_is_the_gradient_at_frozen_area():
    """As published: |l_e . l_f| is not varied; with areas frozen at the state F = -dE_c/dx to 1e-7."""
    a, state, probe = in_contact(0, SHORT, EA=0.0, B=0.0, C=0.0)
    m, x = probe.m, state.x
    pairs = np.array(pairs_in_contact(a, m, x))
    edge = x[a.edges[:, 1]] - x[a.edges[:, 0]]
    area = abs(np.einsum("ij,ij->i", edge[pairs[:, 0]], edge[pairs[:, 1]]))

    def energy(y):
        mid = midpoints(a, y)
        p = 1 - np.linalg.norm(mid[pairs[:, 0]] - mid[pairs[:, 1]], axis=1) / m.diameter
        return m.diameter * m.K * np.sum(area * 0.5 * (p**2 + m.p0_squared * p**4))

    assert probe.energies(x, state.theta)[3] == pytest.approx(energy(x), rel=1e-12)
    force, _ = probe.forces(x, state.theta)
    assert np.abs(force + gradient(energy, x, 1e-5)).max() < 1e-7 * np.abs(force).max()
    full = gradient(lambda y: probe.energy(y, state.theta), x, 1e-5)
    assert np.abs(force + full).max() > 1e-3 * np.abs(force).max()


def test_pressure_is_the_derivative_of_the_potential():
    """K V'(p), V = (p^2 + p0^2 p^4)/2 with p0^2 = 50 (thesis 4.2, 4.3)."""
    m = toy_model(0.1)
    R = 0.15
    p = 1 - R / 0.2
    assert contact_pressure(m, R) == pytest.approx(m.K * (p + 100 * p**3), rel=1e-12)
    assert pytest.approx(1e3 / (3 - 0.6 * 3), rel=1e-12) == m.K


@pytest.mark.parametrize("laws", LAWS)
def test_contacts_are_those_of_brute_force(laws):
    """Every pair nearer than the diameter and far enough along the fiber, each once."""
    for seed in range(3):
        a, state, probe = in_contact(seed, LAWS[laws])
        found = sorted(map(tuple, probe.touching()))
        assert found == pairs_in_contact(a, probe.m, state.x)


@pytest.mark.parametrize("laws", LAWS)
@pytest.mark.parametrize("seed", range(3))
def test_contact_forces_and_moments_sum_to_zero(laws, seed):
    """Action equals reaction along the line of midpoints, with both area laws."""
    _, state, probe = in_contact(seed, LAWS[laws], EA=0.0, B=0.0, C=0.0)
    force, _ = probe.forces(state.x, state.theta)
    moments = np.cross(state.x, force)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    assert np.abs(moments.sum(axis=0)).max() < 1e-13 * np.abs(moments).sum()
    assert np.abs(force).max() > 0


@pytest.mark.parametrize("laws", LAWS)
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_drag_matrix_is_the_law_written_out(laws, closed, seed):
    """M, column by column, is internal damping + collisions by brute force: symmetric, >= 0."""
    a, state, probe = in_contact(seed, LAWS[laws], closed)
    m, n = probe.m, len(a.node_length)
    M = probe.drag_matrix(state.x, state.theta)
    internal = np.zeros((n, n))
    for (i, j), l in zip(a.edges, a.rest_length, strict=True):
        b = np.zeros(n)
        b[i], b[j] = 1.0, -1.0
        internal += m.eta_A / l * np.outer(b, b)
    expected = internal + laplacian_of_collisions(a, m, state.x)
    assert np.abs(M - expected).max() < 1e-12 * np.abs(expected).max()
    assert np.abs(M - M.T).max() < 1e-14 * np.abs(M).max()
    eigenvalues = np.linalg.eigvalsh((M + M.T) / 2)
    assert eigenvalues[0] > -1e-13 * eigenvalues[-1]
    assert eigenvalues[1] > 1e-9 * eigenvalues[-1]  # one body: only its translation is free
    assert np.abs(M @ np.ones(n)).max() < 1e-13 * np.abs(M).sum(axis=1).max()


@pytest.mark.parametrize("laws", LAWS)
def test_drag_forces_sum_to_zero_and_their_moment_is_known(laws):
    """Collision drag balances in force but not in moment: what is left is exactly -sum w r x dv.

    The forces +w dv and -w dv act a distance r apart. The thesis's collision torques (4.7, 4.9) have the
    same sign on both strands and are smaller by J/(A R^2), so they do not balance that couple: angular
    momentum is not a conserved quantity of the model. Only motion along r leaves no couple.
    """
    rng = np.random.default_rng(0)
    a, state, probe = in_contact(1, LAWS[laws])
    m, x, mid = probe.m, state.x, midpoints(a, state.x)
    v = rng.normal(size=x.shape)
    force = probe.drag_forces(v, 0.0)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    residual = np.zeros(3)
    if m.node_pair:
        M = laplacian_of_collisions(a, m, x)
        for i, j in combinations(range(len(x)), 2):
            residual += M[i, j] * np.cross(x[j] - x[i], v[j] - v[i])
    else:
        for e, f in probe.touching():
            r, dv = mid[f] - mid[e], v[a.edges[f]].mean(axis=0) - v[a.edges[e]].mean(axis=0)
            w = m.eta_f_A * a.rest_length[e] * a.rest_length[f] / np.linalg.norm(r) ** 3
            residual -= w * np.cross(r, dv)
    moments = np.cross(x, force)
    assert np.abs(moments.sum(axis=0) - residual).max() < 1e-12 * np.abs(moments).sum()
    torque, _ = probe.drag_torques(v)
    left = moments.sum(axis=0) + torque @ probe.work.tangent
    assert np.linalg.norm(left) > 0.5 * np.linalg.norm(residual) > 0
    towards = probe.drag_forces(x, 0.0)  # v = x: everything moves apart along r
    assert np.abs(np.cross(x, towards).sum(axis=0)).max() < 1e-12 * np.abs(np.cross(x, towards)).sum()


@pytest.mark.parametrize("laws", LAWS)
def test_drag_torques_are_the_law_written_out(laws):
    """tau_e = W (r x dv . d_3)/R, W = eta J l_e/R^2 (4.7) or eta_f J l_e l_f/R^3 (4.9 with ERRATA's sign)."""
    rng = np.random.default_rng(2)
    a, state, probe = in_contact(2, LAWS[laws])
    m, mid = probe.m, midpoints(a, state.x)
    v = rng.normal(size=state.x.shape)
    torque, weight = probe.drag_torques(v)
    expected, dragged = np.zeros(len(a.edges)), np.zeros(len(a.edges))
    for pair in probe.touching():
        for e, f in (pair, pair[::-1]):
            r, dv = mid[f] - mid[e], v[a.edges[f]].mean(axis=0) - v[a.edges[e]].mean(axis=0)
            R, l_e, l_f = np.linalg.norm(r), a.rest_length[e], a.rest_length[f]
            W = m.eta_f_J * (l_e / R**2 if m.node_pair else l_e * l_f / R**3)
            expected[e] += W * np.cross(r / R, dv) @ probe.work.tangent[e] / R
            dragged[e] += W
    assert np.abs(torque - expected).max() < 1e-12 * np.abs(expected).max()
    assert np.allclose(weight, dragged if m.spin_drag else 0.0, rtol=1e-12)


def test_a_strand_is_spun_the_way_a_rubbing_hand_would():
    """A strand along z touched at +x by one that moves along +y spins about +z (4.7, sign of r x dv)."""
    h = 0.1
    strands = [straight(3, 0.2, 2), straight(3, 0.2, 2, (1.8 * h, 0, 0))]
    a = assemble(strands)
    state = initial_state(a, strands)
    probe = Probe(a, toy_model(h), state)
    probe.forces(state.x, state.theta)
    v = np.zeros_like(state.x)
    v[3:, 1] = 1.0
    torque, _ = probe.drag_torques(v)
    assert np.all(torque > 0)


@pytest.mark.parametrize(
    ("exclusion", "n", "size"),
    [
        ((1, np.pi), 400, 1.0005),
        ((1, np.pi), 60, 1.01),
        ((10, 0.0), 63, 5.0),
        ((2, np.pi), 200, 20.0),
        ((0, 4.0), 120, 1.2),
    ],
)
def test_an_untouching_ring_has_no_contact(exclusion, n, size):
    """A ring wider than the fiber touches nowhere: exactly zero energy, force and pairs, seam included.

    Strands pi h apart along a circle of radius h are 2h apart: an exclusion of pi radii is the least that
    leaves every open ring alone.
    """
    h = 0.1
    x = circle(n, size * h)
    a = assemble([x], [True])
    state = initial_state(a, [x])
    m = toy_model(h, EA=0.0, B=0.0, C=0.0, exclusion_edges=exclusion[0], exclusion_length=exclusion[1] * h)
    probe = Probe(a, m, state)
    force, _ = probe.forces(state.x, state.theta)
    assert np.array_equal(force, np.zeros_like(force))
    assert probe.energies(state.x, state.theta)[3] == 0.0
    assert len(probe.touching()) == 0


@pytest.mark.parametrize("seam", [0, 1, 17, 50, 99])
@pytest.mark.parametrize("gap", [1.98, 2.02])
def test_a_flattened_ring_touches_from_two_radii_on(seam, gap):
    """Straight runs a little less than 2h apart touch, a little more do not, wherever the seam lies."""
    h, l = 0.1, 0.05
    run = np.arange(50) * l
    bulge = 0.5 * gap * h + 0.4 * (np.maximum(0, abs(run - run.mean()) - 0.6)) ** 2
    top = np.stack([run, bulge, 0 * run], axis=1)
    x = np.concatenate([top, (top * [1, -1, 1])[::-1]])

    def energy(shift):
        y = np.roll(x, -shift, axis=0)
        a = assemble([y], [True])
        state = initial_state(a, [y])
        probe = Probe(a, toy_model(h), state)
        total = probe.energies(state.x, state.theta)[3]
        return total, np.roll(probe.forces(state.x, state.theta)[0], shift, axis=0)

    total, force = energy(seam)
    assert (total > 0) == (gap < 2)
    assert total == pytest.approx(energy(33)[0], rel=1e-12)
    assert np.allclose(force, energy(33)[1], rtol=0, atol=1e-9 * np.abs(force).max())
