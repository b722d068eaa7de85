"""Length and thickness of curves of arcs, against circles and against brute force."""

from __future__ import annotations

import numpy as np
import pytest

import torsade as ts
from torsade.knots.ropelength import thickness

Floats = np.ndarray


def ring(n: int, radius: float = 1.0) -> Floats:
    """A regular polygon around a circle."""
    angle = 2 * np.pi * np.arange(n) / n
    return radius / np.cos(np.pi / n) * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])


def torus_knot(n: int) -> Floats:
    t = 2 * np.pi * np.arange(n) / n
    r = 2 + np.cos(3 * t)
    return np.column_stack([r * np.cos(2 * t), r * np.sin(2 * t), np.sin(3 * t)])


def arc_points(x: Floats, each: int) -> Floats:
    """Points of the inscribed arcs, as rational quadratic curves, and of nothing between them."""
    before, after = np.roll(x, 1, axis=0) - x, np.roll(x, -1, axis=0) - x
    a, b = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    reach = np.minimum(a, b) / 2
    first, last = x + (reach / a)[:, None] * before, x + (reach / b)[:, None] * after
    half = np.arccos(np.clip(-(before * after).sum(axis=1) / (a * b), -1, 1)) / 2
    w = np.cos(half)[:, None]
    t = np.arange(each) / each
    points = [
        ((1 - s) ** 2 * first + 2 * s * (1 - s) * w * x + s**2 * last)
        / ((1 - s) ** 2 + 2 * s * (1 - s) * w + s**2)
        for s in t
    ]
    return np.stack(points, axis=1).reshape(-1, 3)


@pytest.mark.parametrize("n", [4, 7, 30])
def test_a_regular_polygon_is_its_inscribed_circle(n: int) -> None:
    found = thickness([ring(n, 3.0)], chords=64)
    assert found.length == pytest.approx(6 * np.pi, rel=1e-12)
    assert found.bend == pytest.approx(3.0, rel=1e-12)
    assert 3.0 - 2e-3 * 30 / n**2 * 100 < found.half_distance <= 3.0


def test_two_linked_circles() -> None:
    """Each through the centre of the other, of twice the fiber's radius: 8 pi, the least for a link."""
    other = ring(200, 2.0)[:, [0, 2, 1]] + (2, 0, 0)
    found = thickness([ring(200, 2.0), other])
    assert 8 * np.pi <= found.ropelength < 8 * np.pi * (1 + 1e-4)
    assert found.radius == found.half_distance


def test_the_distance_is_a_lower_bound_and_a_close_one() -> None:
    """Against all pairs of points on the arcs that are far apart along the curve."""
    x = torus_knot(150)
    p = arc_points(x, 12)
    n = len(p)
    apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    far = np.minimum(apart, n - apart) > n / 6
    distance = np.linalg.norm(p[:, None] - p[None], axis=2)[far].min()
    coarse, fine = thickness([x], chords=4), thickness([x], chords=16)
    assert coarse.half_distance < fine.half_distance <= distance / 2
    assert fine.half_distance > distance / 2 * (1 - 1e-4)


def test_ropelength_does_not_depend_on_size_place_or_start() -> None:
    x = torus_knot(120)
    turned = np.roll(7e-3 * x[:, [1, 2, 0]] + 0.1, 17, axis=0)
    assert thickness([turned]).ropelength == pytest.approx(thickness([x]).ropelength, rel=1e-9)


def test_straight_corners_are_no_corners() -> None:
    square = np.array([(1, 1, 0), (0, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)], dtype=float)
    found = thickness([square])
    assert np.isfinite(found.length)
    assert found.bend == pytest.approx(0.5)  # arcs reach half the shorter edge


def test_refusals() -> None:
    with pytest.raises(ts.TorsadeError, match="no strand"):
        thickness([])
    with pytest.raises(ts.TorsadeError, match="folds straight back at node"):
        thickness([[(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 0, 0), (0, 1, 0)]])
