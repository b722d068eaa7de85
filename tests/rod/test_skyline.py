"""The direct solve of the mobility system: renumbering, envelope and factors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rod.helpers import Probe, random_loop, random_strand, straight, tangle, toy_model
from torsade.assembly import assemble
from torsade.rod.contact import contacts_among
from torsade.rod.damping import mobility_work, solve_mobility
from torsade.rod.skyline import assemble_skyline, factorise, reverse_cuthill_mckee, skyline_for

ETA_A = 0.7


def random_assembly(seed, sizes):
    strands = [
        random_loop(seed + k, n) if closed else random_strand(seed + k, n)
        for k, (n, closed) in enumerate(sizes)
    ]
    return assemble(strands, [closed for _, closed in sizes])


def random_pairs(a, rng, n):
    """Up to n pairs e < f of edges that share no node, each once."""
    pairs = np.sort(rng.integers(0, len(a.edges), size=(n, 2)), axis=1)
    apart = [not set(a.edges[e]) & set(a.edges[f]) for e, f in pairs]
    return np.unique(pairs[np.array(apart, dtype=bool)], axis=0)


def random_contacts(a, rng, pairs, node_pair):
    """Some of the pairs in contact, with random weights over five decades."""
    contacts = contacts_among(pairs)
    count = 0
    for e, f in pairs[rng.uniform(size=len(pairs)) < 0.7]:
        end = rng.integers(2)
        i, j = a.edges[e], a.edges[f]
        contacts.edges[count] = e, f
        contacts.drag_nodes[count] = (i[end], i[end], j[end], j[end]) if node_pair else (*i, *j)
        contacts.drag_weight[count] = ETA_A * 10.0 ** rng.uniform(-3, 2)
        count += 1
    contacts.count[:] = count
    return contacts


def dense_matrix(a, contacts):
    """M as a sum of couplings: w (mean velocity of two nodes - mean velocity of two others)^2."""
    couplings = [(i, i, j, j, ETA_A / l) for (i, j), l in zip(a.edges, a.rest_length, strict=True)]
    for k in range(contacts.count[1]):
        couplings.append((*contacts.drag_nodes[k], contacts.drag_weight[k]))
    B = np.zeros((len(couplings), len(a.node_length)))
    for k, (i0, i1, j0, j1, _) in enumerate(couplings):
        for node, share in ((i0, 0.5), (i1, 0.5), (j0, -0.5), (j1, -0.5)):
            B[k, node] += share
    return B.T @ (np.array([c[4] for c in couplings])[:, None] * B)


assemblies = st.lists(st.tuples(st.integers(4, 30), st.booleans()), min_size=1, max_size=3)


@settings(deadline=None, max_examples=100)
@given(
    seed=st.integers(0, 10**6),
    sizes=assemblies,
    n=st.integers(0, 60),
    node_pair=st.booleans(),
    share=st.sampled_from([0.0, 0.2, 0.9]),
    moving=st.booleans(),
)
def test_both_solvers_agree_with_dense_cholesky(seed, sizes, n, node_pair, share, moving):
    """Any contacts, any nodes fixed, at rest or moving: envelope and conjugate gradients solve M v = F."""
    rng = np.random.default_rng(seed)
    a = random_assembly(seed, sizes)
    pairs = random_pairs(a, rng, n)
    contacts = random_contacts(a, rng, pairs, node_pair)
    fixed = rng.uniform(size=len(a.node_length)) < share
    fixed[a.node_start[:-1]] = True
    force = rng.normal(size=(len(fixed), 3))
    held = rng.normal(size=force.shape) if moving else np.zeros(force.shape)
    M, free = dense_matrix(a, contacts), ~fixed
    expected = held.copy()
    L = np.linalg.cholesky(M[np.ix_(free, free)])
    rhs = force[free] - M[np.ix_(free, fixed)] @ held[fixed]
    expected[free] = np.linalg.solve(L.T, np.linalg.solve(L, rhs))
    for worth in (1e9, 0.0):
        sky = skyline_for(a, pairs, worth)
        v = np.where(fixed[:, None], held, rng.normal(size=force.shape))
        work = mobility_work(len(fixed), len(a.edges))
        assert solve_mobility(a, ETA_A, contacts, sky, force, fixed, 1e-13, v, work)
        assert np.abs(v - expected).max() <= 1e-8 * np.abs(expected).max()
        assert np.array_equal(v[fixed], held[fixed])


def test_worth_decides_which_solver():
    """Without room for values the system is solved iteratively; open chains alone always have room."""
    a = random_assembly(0, [(20, False)])
    none = np.empty((0, 2), np.int64)
    assert len(skyline_for(a, none, 0.0).values) == 0
    assert len(skyline_for(a, none, 1.0).values) == 19


def test_nothing_fixed_has_no_factors():
    """A loose body can move as a whole: the factorisation finds that, up to round-off, and says so."""
    x = straight(5, 4.0)
    a = assemble([x])
    none = np.empty((0, 2), np.int64)
    sky = skyline_for(a, none, 10.0)
    assemble_skyline(a, 1.0, contacts_among(none), np.zeros(5, bool), sky)
    assert not factorise(sky)


def reach(a, pairs, position):
    """How far the row of each node reaches back, in nodes."""
    first = position.copy()
    groups = [*a.edges, *(np.concatenate([a.edges[e], a.edges[f]]) for e, f in pairs)]
    for group in groups:
        first[group] = np.minimum(first[group], position[group].min())
    return position - first


@settings(deadline=None, max_examples=100)
@given(seed=st.integers(0, 10**6), sizes=assemblies, n=st.integers(0, 40))
def test_renumbering_is_a_permutation(seed, sizes, n):
    """Every node has one row, the same for the same contacts, and the skyline has room for all of them."""
    a = random_assembly(seed, sizes)
    pairs = random_pairs(a, np.random.default_rng(seed), n)
    position = reverse_cuthill_mckee(a, pairs)
    assert np.array_equal(np.sort(position), np.arange(len(a.node_length)))
    assert np.array_equal(position, reverse_cuthill_mckee(a, pairs))
    sky = skyline_for(a, pairs, 1e9)
    assert np.array_equal(sky.position, position)
    assert len(sky.values) == reach(a, pairs, position).sum()


@pytest.mark.parametrize("seed", range(4))
def test_renumbering_does_not_widen(seed):
    """On tangles, rows reach no farther than in the order along the fibers, in the mean and at most."""
    a, state, h = tangle(seed)
    pairs = Probe(a, toy_model(h), state).near.guarded
    natural = reach(a, pairs, np.arange(len(a.node_length)))
    renumbered = reach(a, pairs, reverse_cuthill_mckee(a, pairs))
    assert np.sum(renumbered**2) <= np.sum(natural**2)
    assert renumbered.max() <= natural.max()


def test_strands_side_by_side_interleave():
    """Two parallel strands of n nodes couple nodes n apart in number; their rows reach a few places."""
    n = 100
    a = assemble([straight(n, 1.0), straight(n, 1.0, at=(0, 0.1, 0))])
    pairs = np.stack([np.arange(n - 1), np.arange(n - 1) + n - 1], axis=1)
    assert reach(a, pairs, np.arange(2 * n)).max() == n + 1
    assert reach(a, pairs, reverse_cuthill_mckee(a, pairs)).max() <= 5
    loop = assemble([random_loop(0, n)], [True])
    assert reach(loop, pairs[:0], reverse_cuthill_mckee(loop, pairs[:0])).max() == 2
