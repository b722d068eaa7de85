"""The direct solve of the mobility system: order of elimination, pattern and factors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rod.helpers import midpoints, pairs_within, random_loop, random_strand, straight, tangle
from torsade.assembly import assemble
from torsade.rod import factor as direct
from torsade.rod.contact import contacts_among
from torsade.rod.damping import mobility_work, solve_mobility
from torsade.rod.ordering import couplings, minimum_degree

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
    for row in np.flatnonzero(rng.uniform(size=len(pairs)) < 0.7):
        end = rng.integers(2)
        i, j = a.edges[pairs[row]]
        contacts.edges[count] = pairs[row]
        contacts.row[count] = row
        contacts.drag_contact[count] = count
        contacts.drag_nodes[count] = (i[end], i[end], j[end], j[end]) if node_pair else (*i, *j)
        contacts.drag_weight[count] = ETA_A * 10.0 ** rng.uniform(-3, 2)
        count += 1
    contacts.count[:2] = count
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
    """Any contacts, any nodes fixed, at rest or moving: both ways solve M v = F."""
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
    made = direct.renewed(direct.no_factor(), a, contacts, np.zeros((len(a.edges), 3)), 1.0)
    assert direct.serves(made, contacts)
    for factor in (made, ()):
        v = np.where(fixed[:, None], held, rng.normal(size=force.shape))
        work = mobility_work(len(fixed), len(a.edges))
        assert solve_mobility(a, ETA_A, contacts, factor, (), force, fixed, 1e-13, v, work)
        assert np.abs(v - expected).max() <= 1e-8 * np.abs(expected).max()
        assert np.array_equal(v[fixed], held[fixed])


def open_chain(n):
    a = assemble([straight(n, 4.0)])
    return a, contacts_among(np.empty((0, 2), np.int64)), midpoints(a, straight(n, 4.0))


def test_dense_systems_are_recognised():
    """Chains take one operation per node; where less is allowed, no factor is made."""
    a, none, mid = open_chain(20)
    dense = direct.pattern(a, none, mid, 0.1, 0.9)
    assert dense.kind[0] == direct.DENSE
    assert not direct.usable(dense)
    made = direct.pattern(a, none, mid, 0.1, 1.0)
    assert direct.usable(made)
    assert len(made.value) == 19
    assert len(made.tape) == 0


def test_nothing_fixed_has_no_factors():
    """A loose body can move as a whole: the factorisation finds that, up to round-off, and says so."""
    a, none, mid = open_chain(5)
    factor = direct.pattern(a, none, mid, 0.1, 10.0)
    direct.assemble(a, 1.0, none, np.zeros(5, bool), factor)
    assert not direct.eliminate(factor, np.zeros((5, 3)))


def dense_elimination(matrix, order):
    """Couplings that eliminating nodes in an order makes: the entries of the Cholesky factor."""
    coupled = matrix[np.ix_(order, order)] != 0
    entries = []
    for k in range(len(order)):
        rows = k + 1 + np.flatnonzero(coupled[k + 1 :, k])
        entries.append(set(order[rows]))
        coupled[np.ix_(rows, rows)] = True
    return entries


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10**6), sizes=assemblies, n=st.integers(0, 40))
def test_elimination_leaves_the_fewest_neighbours(seed, sizes, n):
    """Every node goes once; what it is coupled to is what brute force says, and no node had fewer."""
    a = random_assembly(seed, sizes)
    pairs = random_pairs(a, np.random.default_rng(seed), n)
    coupled = [set() for _ in a.node_length]
    groups = [*a.edges, *(np.concatenate([a.edges[e], a.edges[f]]) for e, f in pairs)]
    for group in groups:
        for i in group:
            coupled[i] |= set(group) - {i}
    done = minimum_degree(*couplings(a, pairs, np.ones(len(pairs), bool)), np.inf)
    assert np.array_equal(np.sort(done.order), np.arange(len(a.node_length)))
    work = 0
    left = set(range(len(coupled)))
    for i in done.order:
        assert set(done.pool[done.begin[i] : done.begin[i] + done.size[i]]) == coupled[i]
        assert len(coupled[i]) == min(len(coupled[j]) for j in left)
        work += len(coupled[i]) ** 2
        left.remove(i)
        for j in coupled[i]:
            coupled[j] |= coupled[i] - {j}
            coupled[j].discard(i)
    assert work == done.work[0]


@pytest.mark.parametrize("seed", range(4))
def test_pattern_is_that_of_the_factors(seed):
    """On tangles: columns hold what brute-force elimination fills, and the same pattern is made twice."""
    a, state, h = tangle(seed)
    contacts = contacts_among(pairs_within(a, state.x, 3 * h, 1, np.pi * h))
    mid = midpoints(a, state.x)
    factor = direct.pattern(a, contacts, mid, 2 * h, 1e9)
    touching = np.linalg.norm(np.diff(mid[contacts.pairs], axis=1)[:, 0], axis=1) < direct.MARGIN * 2 * h
    assert np.array_equal(factor.known, touching)
    assert 0 < touching.sum() < len(touching)
    matrix = np.zeros((len(a.node_length),) * 2)
    groups = [*a.edges, *(np.concatenate([a.edges[e], a.edges[f]]) for e, f in contacts.pairs[touching])]
    for group in groups:
        matrix[np.ix_(group, group)] = 1
    for k, rows in enumerate(dense_elimination(matrix, factor.order)):
        assert set(factor.row[factor.start[k] : factor.start[k + 1]]) == rows
    again = direct.pattern(a, contacts, mid, 2 * h, 1e9)
    assert np.array_equal(again.order, factor.order)
    assert np.array_equal(again.tape, factor.tape)


def test_another_contact_needs_another_pattern():
    """A pattern serves while contacts are among the pairs it knows, and no longer."""
    a, state, h = tangle(0)
    pairs = pairs_within(a, state.x, 3 * h, 1, np.pi * h)
    contacts, mid = contacts_among(pairs), midpoints(a, state.x)
    assert not direct.serves(direct.no_factor(), contacts)
    factor = direct.pattern(a, contacts, mid, 2 * h, 1e9)
    contacts.count[0] = 1
    contacts.row[0] = np.flatnonzero(factor.known)[0]
    assert direct.serves(factor, contacts)
    contacts.row[0] = np.flatnonzero(~factor.known)[0]
    assert not direct.serves(factor, contacts)


def test_ropes_stay_sparse():
    """Two parallel strands in contact all along take a few operations per node, however long they are."""
    for n in (100, 1000):
        a = assemble([straight(n, 1.0), straight(n, 1.0, at=(0, 0.1 / n, 0))])
        pairs = np.stack([np.arange(n - 1), np.arange(n - 1) + n - 1], axis=1)
        done = minimum_degree(*couplings(a, pairs, np.ones(n - 1, bool)), np.inf)
        assert done.work[0] <= 16 * 2 * n
