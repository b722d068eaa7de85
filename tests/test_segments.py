"""Distances of segments and clearance of curves: closed forms, brute force, a constrained minimum."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from torsade import curve
from torsade.segments import segment_distance

FloatArray = NDArray[np.float64]


def circle(n: int, radius: float = 1.0) -> FloatArray:
    a = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def random_walk(seed: int, n: int) -> FloatArray:
    return np.cumsum(np.random.default_rng(seed).normal(size=(n, 3)), axis=0)


# --- two segments


@pytest.mark.parametrize(
    ("p0", "p1", "q0", "q1", "distance"),
    [
        ((-1, 0, 0), (1, 0, 0), (0, -1, 0.5), (0, 1, 0.5), 0.5),  # skew: common perpendicular inside
        ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), 0.0),  # crossing
        ((0, 0, 0), (1, 0, 0), (0.5, 2, 0), (0.5, 3, 4), 2.0),  # an end over an inside
        ((0, 0, 0), (1, 0, 0), (4, 4, 0), (9, 9, 0), 5.0),  # two ends
        ((0, 0, 0), (1, 0, 0), (0.5, 3, 0), (7, 3, 0), 3.0),  # parallel, side by side
        ((0, 0, 0), (1, 0, 0), (3, 0, 0), (7, 0, 0), 2.0),  # on one line, apart
        ((0, 0, 0), (2, 0, 0), (1, 0, 0), (7, 0, 0), 0.0),  # on one line, overlapping
        ((0, 0, 0), (2, 0, 0), (-1, 0, 0), (7, 0, 0), 0.0),  # on one line, one in the other
        ((0, 0, 0), (0, 0, 0), (-1, 2, 0), (1, 2, 0), 2.0),  # a point and a segment
        ((0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0), 5.0),  # two points
    ],
)
def test_closed_forms(
    p0: tuple[float, ...],
    p1: tuple[float, ...],
    q0: tuple[float, ...],
    q1: tuple[float, ...],
    distance: float,
) -> None:
    assert segment_distance(p0, p1, q0, q1) == pytest.approx(distance, abs=1e-15)
    assert segment_distance(q1, q0, p0, p1) == pytest.approx(distance, abs=1e-15)


@settings(deadline=None)
@given(st.integers(0, 10**6), st.floats(0, 1), st.sampled_from([1.0, 1e-3, 1e-7]))
def test_equals_the_constrained_minimum(seed: int, parallel: float, size: float) -> None:
    """min |p0 + s p - q0 - t q| over the unit square, from nearly parallel to random directions."""
    p0, p, q0, other = np.random.default_rng(seed).normal(size=(4, 3)) * size
    q = parallel**4 * other + (1 - parallel**4) * p
    best = lsq_linear(
        np.stack([p, -q], axis=1) / size, (q0 - p0) / size, bounds=(0, 1), tol=1e-15, method="bvls"
    )
    expected = np.sqrt(2 * best.cost) * size
    assert segment_distance(p0, p0 + p, q0, q0 + q) == pytest.approx(expected, rel=1e-6, abs=1e-8 * size)


def test_broadcasts_and_keeps_shape() -> None:
    points = np.random.default_rng(1).normal(size=(4, 5, 3))
    p0, p1, q0, q1 = points
    each = [segment_distance(*(point[k] for point in points)) for k in range(5)]
    np.testing.assert_array_equal(segment_distance(p0, p1, q0, q1), each)
    table = segment_distance(p0[:, None], p1[:, None], q0, q1)
    assert table.shape == (5, 5)
    np.testing.assert_array_equal(np.diag(table), each)


# --- clearance


def brute_clearance(strands: list[FloatArray], closed: list[bool], exclusion: float) -> float:
    """All pairs, one by one."""
    best = np.inf
    edges = [
        (k, i, x[i], x[(i + 1) % len(x)])
        for k, (x, c) in enumerate(zip(strands, closed, strict=True))
        for i in range(len(x) if c else len(x) - 1)
    ]
    for (a, i, p0, p1), (b, j, q0, q1) in combinations(edges, 2):
        if a == b:
            l = curve.edge_lengths(strands[a], closed[a])
            between = l[i + 1 : j].sum()
            if closed[a]:
                between = min(between, l[:i].sum() + l[j + 1 :].sum())
            if between <= exclusion:
                continue
        best = min(best, float(curve.segment_distance(p0, p1, q0, q1)))
    return best


@settings(deadline=None)
@given(
    st.integers(0, 10**6),
    st.lists(st.tuples(st.integers(3, 15), st.booleans()), min_size=1, max_size=4),
    st.sampled_from([0.01, 1.0, 4.0, 30.0]),
    st.floats(0, 3),
)
def test_clearance_equals_brute_force(
    seed: int, shapes: list[tuple[int, bool]], exclusion: float, unevenness: float
) -> None:
    rng = np.random.default_rng(seed)
    strands = [
        np.cumsum(rng.normal(size=(n, 3)) * np.exp(unevenness * rng.normal(size=(n, 1))), axis=0)
        for n, _ in shapes
    ]
    closed = [c for _, c in shapes]
    distance, where, edges = curve.clearance(strands, closed, exclusion)
    assert distance == pytest.approx(brute_clearance(strands, closed, exclusion), rel=1e-12, abs=1e-12)
    if distance < np.inf:  # the edges named attain it
        (p0, p1), (q0, q1) = (
            (strands[k][i], strands[k][(i + 1) % len(strands[k])]) for k, i in zip(where, edges, strict=True)
        )
        assert curve.segment_distance(p0, p1, q0, q1) == pytest.approx(distance, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_clearance_of_many_edges_equals_brute_force(seed: int) -> None:
    """More edges than one search chunk holds: all pairs of the second half, by broadcasting."""
    walk = random_walk(seed, 700)
    walk[:300] += 1e4  # what is nearest lies in the last chunks
    p, q, s = walk[:-1], walk[1:], curve.arclength(walk)
    between = s[None, :-1] - s[1:, None]
    distance = np.where(between > 10, curve.segment_distance(p[:, None], q[:, None], p, q), np.inf)
    found = curve.clearance([walk], [False], 10.0)
    assert found.distance == pytest.approx(distance.min(), rel=1e-12)
    assert distance[found.edges] == distance.min()


def test_clearance_where_only_opposite_edges_count() -> None:
    """In a hexagon with more than an edge and a half left out, opposite sides are sqrt(3) apart."""
    found = curve.clearance([circle(6)], [True], 1.5)
    assert found.distance == pytest.approx(np.sqrt(3))
    assert found.edges[1] - found.edges[0] == 3


def test_clearance_across_a_ring() -> None:
    """Opposite sides of a regular polygon are 2 R cos(pi/n) apart."""
    l = 2 * np.sin(np.pi / 40)
    found = curve.clearance([circle(40)], [True], 18.5 * l)
    assert found.distance == pytest.approx(2 * np.cos(np.pi / 40), rel=1e-12)
    assert found.edges[1] - found.edges[0] == 20


def test_ring_and_its_seam_are_no_contact() -> None:
    """Edges on both sides of the closing node are neighbours as any others are."""
    found = curve.clearance([circle(40)], [True], 0.5)
    l = 2 * np.sin(np.pi / 40)
    apart = int(np.floor(0.5 / l)) + 1  # edges left out between the nearest two that count
    assert found.distance == pytest.approx(2 * np.sin(np.pi * apart / 40), rel=1e-12)
    assert curve.clearance([circle(40)], [False], 0.5).distance == pytest.approx(l, rel=1e-12)


def test_linked_rings_are_a_radius_apart() -> None:
    """Two unit circles in planes at right angles, each through the other's centre."""
    other = circle(200)[:, [0, 2, 1]] + [1.0, 0, 0]
    found = curve.clearance([circle(200), other], [True, True], 10.0)
    assert found.strands == (0, 1)
    assert found.distance == pytest.approx(1, abs=1e-3)


def test_nothing_to_compare_is_infinitely_clear() -> None:
    assert curve.clearance([circle(9)], [True], 100.0) == (np.inf, (-1, -1), (-1, -1))
