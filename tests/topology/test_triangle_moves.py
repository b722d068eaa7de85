"""Triangle moves: what pierces what, against brute force; and knots that stay what they are."""

from __future__ import annotations

import numpy as np
import pytest
from curves import hopf_link, random_loop, random_polygon, ring, torus_knot

from torsade.arrays import Floats
from torsade.topology import braid_curves, identify_curves, linking
from torsade.topology.isotopy import carried_over, chain_of, thinned_to
from torsade.topology.triangle_moves import OUT, is_free, pierces, take_out


def crosses(p: Floats, q: Floats, a: Floats, b: Floats, c: Floats) -> bool:
    """Where the line through p and q meets the plane of a, b, c, from one linear system."""
    s, u, v = np.linalg.solve(np.stack([p - q, b - a, c - a], axis=1), p - a)
    return bool(0 < s < 1 and u > 0 and v > 0 and u + v < 1)


def test_what_pierces_is_what_crosses() -> None:
    points = np.random.default_rng(0).normal(size=(4000, 5, 3))
    found = [pierces(*five) for five in points]
    assert found == [crosses(*five) for five in points]
    assert 200 < sum(found) < 2000
    # Neither the way of the segment nor the order of corners counts.
    for p, q, a, b, c in points[:500]:
        assert pierces(p, q, a, b, c) == pierces(q, p, b, a, c) == pierces(p, q, c, a, b)


@pytest.mark.parametrize("closed", [True, False])
def test_boxes_hide_no_edge(closed: bool) -> None:
    """Random polygons full of crossings, while nodes are taken out."""
    x = random_polygon(1, 150)
    chain = chain_of([x], [closed])
    for longest in (0.0, 0.7, 1.0):
        take_out(chain, np.ones(len(x), dtype=bool), longest)
        here = np.flatnonzero(chain.after != OUT)
        edges = [(i, int(chain.after[i])) for i in here if chain.after[i] >= 0]
        for b in here:
            a, c = int(chain.before[b]), int(chain.after[b])
            if a < 0 or c < 0:
                continue
            free = not any(
                crosses(chain.x[i], chain.x[j], chain.x[a], chain.x[b], chain.x[c])
                for i, j in edges
                if not {i, j} & {a, int(b), c}
            )
            assert is_free(chain, b, chain.x[b]) == free
    assert len(here) < len(x)


@pytest.mark.parametrize(
    ("x", "name", "most"),
    [
        (ring(300), "0_1", 3),
        (random_loop(3, 300), None, 60),
        (torus_knot(2, 3, 400), "m3_1", 20),
        (braid_curves([1, -2, 1, -2])[0], "4_1", 30),
        (braid_curves([1, 1, 1, 1, 1])[0], "5_1", 30),
    ],
    ids=["ring", "loop", "trefoil", "figure eight", "5_1"],
)
def test_a_thinned_knot_is_the_same_knot(x: Floats, name: str | None, most: int) -> None:
    """Few nodes are left, and what they make is named as before."""
    chain = chain_of([x], [True])
    take_out(chain, np.ones(len(x), dtype=bool), np.inf)
    left = chain.x[chain.after != OUT]
    assert 3 <= len(left) <= most
    if name is None:
        assert str(identify_curves([left])) == str(identify_curves([x]))
    elif len(left) > 3:
        assert str(identify_curves([left])) == name
    else:
        assert name == "0_1"


def test_a_flat_curve_and_a_straight_line_can_be_thinned() -> None:
    """Nothing is in general position there."""
    line = np.outer(np.arange(50.0), [1.0, 0, 0])
    ends = np.isin(np.arange(50), (0, 49))
    assert thinned_to([line], [False], [ends])
    assert thinned_to([ring(60)], [True], [np.arange(60) % 3 == 0])
    assert thinned_to([ring(60) + 1e6], [True], [np.arange(60) % 3 == 0])


def test_a_link_is_not_carried_apart() -> None:
    a, b = hopf_link()
    away = b + np.array([10.0, 0, 0])
    assert not carried_over([a, b], [a, away], [True, True], 0.2)
    assert not thinned_to([a, b], [True, True], [np.arange(30) % 15 == 0, np.arange(30) == 0])
    beside = b + np.array([3.0, 0, 0])
    assert carried_over([a, beside], [a, away], [True, True], 0.2)


def test_strands_do_not_pass_through_each_other() -> None:
    """A node is pulled over a straight strand, above it and across."""
    n = 20
    flat = np.stack([np.linspace(-1, 1, n), np.zeros(n), np.zeros(n)], axis=1)
    arch = np.stack([np.zeros(n), np.linspace(-1, 1, n), 0.5 * np.cos(np.linspace(-1.5, 1.5, n))], axis=1)
    for height, free in ((0.3, True), (-0.3, False)):
        goal = arch.copy()
        goal[1:-1, 2] = height * np.cos(np.linspace(-1.5, 1.5, n))[1:-1]
        assert carried_over([flat, arch], [flat, goal], [False, False], 0.05) == free


def test_what_is_carried_over_keeps_its_knot() -> None:
    """Random displacements of knots: yes is only said where the name is the same; both answers occur."""
    said = {True: 0, False: 0}
    changed = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        x = braid_curves([1, -2, 1, -2], nodes=100)[0]
        y = x + rng.uniform(0.1, 0.9) * rng.normal(size=x.shape)
        yes = carried_over([x], [y], [True], 0.3)
        same = str(identify_curves([y])) == "4_1"
        assert same or not yes
        said[yes] += 1
        changed += not same
    assert min(said.values()) >= 5
    assert changed >= 5


def test_links_that_are_carried_over_keep_their_linking_number() -> None:
    said = {True: 0, False: 0}
    for seed in range(40):
        rng = np.random.default_rng(seed)
        a, b = hopf_link(40)
        goal = [x + rng.uniform(0.05, 0.5) * rng.normal(size=x.shape) for x in (a, b)]
        yes = carried_over([a, b], goal, [True, True], 0.1)
        if yes:
            assert linking(goal, True)[0, 1] == pytest.approx(linking([a, b], True)[0, 1], abs=1e-9)
        said[yes] += 1
    assert min(said.values()) >= 5
