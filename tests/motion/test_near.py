"""Lists of edges near each other: complete when made, and for as long as they are used."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import midpoints, pairs_within, tangle, toy_model
from torsade.motion.near import find_near, list_near
from torsade.motion.scheme import Control


def control(h):
    return Control(0.0, 1e-2 * h, h, 1e-5, 0.8 * h, 1.6 * h, 0.2 * h)


def listed(near):
    """Guarded pairs and those that may touch, as sorted lists."""
    guarded = near.apart[near.guarded[: near.count[0]]]
    touching = near.contacts.pairs[near.contacts.listed[: near.contacts.count[2]]]
    return [sorted(map(tuple, pairs)) for pairs in (guarded, touching)]


def expected(a, m, x, length, how):
    """The same by comparing all edges with all."""
    reach = length.max() + 2 * how.move + 0.5 * how.skin
    guarded = pairs_within(a, x, reach, 1, 0.0)
    touching = pairs_within(a, x, m.diameter + how.skin, m.exclusion_edges, m.exclusion_length)
    return [sorted(map(tuple, pairs)) for pairs in (guarded, touching)]


@pytest.mark.parametrize("exclusion", [1, 10])
@pytest.mark.parametrize("coarse", [1.0, 6.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_lists_are_complete(seed, coarse, exclusion):
    """Guarded are pairs that a step could make cross, listed those that may touch; also after roaming.

    Pairs found once give complete lists wherever nodes have gone within `roam`; the same, made twice.
    """
    a, state, h = tangle(seed)
    m, how = toy_model(h, exclusion_edges=exclusion), control(h)
    length = coarse * a.rest_length
    near = find_near(a, m, how, midpoints(a, state.x), length)
    assert listed(near) == expected(a, m, state.x, length, how)
    assert min(len(pairs) for pairs in listed(near)) > 0
    assert listed(find_near(a, m, how, midpoints(a, state.x), length)) == listed(near)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        step = rng.normal(size=state.x.shape)
        x = state.x + how.roam * step / np.linalg.norm(step, axis=1, keepdims=True)
        list_near(m, how, midpoints(a, x), length, near)
        assert listed(near) == expected(a, m, x, length, how)
