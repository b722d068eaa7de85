"""Verlet lists against brute force, and runs that must not notice them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rod.helpers import midpoints, pairs_within, random_loop, random_strand
from torsade.assembly import assemble


def brute_force(a, x, cutoff, edges, length):
    mid = midpoints(a, x)
    found = []
    for e, f in combinations(range(len(a.edges)), 2):
        d = mid[e] - mid[f]
        if not d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < cutoff * cutoff:
            continue
        if a.edge_fiber[e] == a.edge_fiber[f]:
            fiber = a.edge_fiber[e]
            apart, arc = f - e, abs(a.edge_arclength[f] - a.edge_arclength[e])
            if a.closed[fiber]:
                apart = min(apart, a.edge_start[fiber + 1] - a.edge_start[fiber] - apart)
                arc = min(arc, a.fiber_length[fiber] - arc)
            if apart <= edges or arc < length:
                continue
        found.append((e, f))
    return found


@settings(deadline=None, max_examples=150)
@given(
    seed=st.integers(0, 10**6),
    sizes=st.lists(st.tuples(st.integers(4, 40), st.booleans()), min_size=1, max_size=4),
    cutoff=st.floats(0.01, 3.0),
    edges=st.integers(0, 12),
    length=st.floats(0.0, 2.0),
    far=st.sampled_from([0.0, -7.3, 1e4]),
)
def test_list_is_brute_force(seed, sizes, cutoff, edges, length, far):
    """Same pairs, each once, e < f, for open and closed fibers, any cutoff and exclusion, anywhere."""
    strands = []
    for k, (n, closed) in enumerate(sizes):
        strand = random_loop(seed + k, n) if closed else random_strand(seed + k, n, turn=2.0)
        strands.append(strand + far)
    a = assemble(strands, [closed for _, closed in sizes])
    x = np.concatenate(strands)
    pairs = pairs_within(a, x, cutoff, edges, length)
    listed = sorted(map(tuple, pairs))
    assert listed == brute_force(a, x, cutoff, edges, length)
    assert np.all(np.diff(pairs[:, 0]) >= 0)
    assert np.array_equal(pairs, pairs_within(a, x, cutoff, edges, length))


def test_many_neighbours():
    """The list grows as needed: every edge near every other."""
    x = 1e-3 * random_strand(0, 200, turn=3.0)
    a = assemble([x])
    assert len(pairs_within(a, x, 1.0, -1, 0.0)) == 199 * 198 // 2


def test_cells_that_share_a_bucket():
    """Points far apart on a line hash to few cells; none may be listed twice or lost."""
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.uniform(0.05, 40, size=(300, 1)) * np.eye(3)[rng.integers(0, 3, 300)], axis=0)
    a = assemble([x])
    for cutoff in (0.5, 5.0, 50.0):
        assert sorted(map(tuple, pairs_within(a, x, cutoff, 0, 0.0))) == brute_force(a, x, cutoff, 0, 0.0)
