"""Twist and self-linking of framed curves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from topology.curves import random_loop, random_polygon, ring, torus_knot, turned_directors
from torsade import curve
from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.topology.framing import self_linking, twist
from torsade.topology.measures import linking, writhe


def pushed_off(x: Floats, d: Floats, by: float) -> Floats:
    """A closed curve pushed along its directors: two nodes for each edge, close to its ends."""
    e = curve.edge_vectors(x, closed=True)
    near = min(
        0.01, 0.1 * by / np.linalg.norm(e, axis=1).max()
    )  # or the corner cut would be on the other side
    ends = [x + share * e + by * d for share in (near, 1 - near)]
    return np.stack(ends, axis=1).reshape(-1, 3)


@pytest.mark.parametrize("turns", [-2.75, -1.0, 0.0, 0.3, 4.0])
def test_twist_of_a_straight_rod(turns: float) -> None:
    """Directors turned evenly, right-handed when positive: Tw is how often, whatever the number of edges."""
    x = np.outer(np.arange(31.0), [0.0, 0.0, 1.0])
    angle = 2 * np.pi * turns * np.linspace(0, 1, 30)
    d = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    assert twist(x, d, False) == pytest.approx(turns, abs=1e-13)
    assert twist(x[::-1], d[::-1], False) == pytest.approx(turns, abs=1e-13)
    mirror = np.array([1.0, -1.0, 1.0])
    assert twist(x * mirror, d * mirror, False) == pytest.approx(-turns, abs=1e-13)


def test_twist_of_a_ring() -> None:
    """Directors along the axis of a plane ring do not turn; turned n times, Lk = Tw = n."""
    x = ring(60)
    axis = np.tile([0.0, 0.0, 1.0], (60, 1))
    assert twist(x, axis, True) == pytest.approx(0, abs=1e-13)
    t = curve.tangents(x, True)
    for turns in (1, -3):
        angle = 2 * np.pi * turns * np.arange(60)[:, None] / 60
        d = axis * np.cos(angle) + np.cross(t, axis) * np.sin(angle)
        assert twist(x, d, True) == pytest.approx(turns, abs=1e-12)
        assert self_linking(x, d) == pytest.approx(turns, abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(4, 40))
def test_link_of_any_framed_polygon_is_whole(seed: int, n: int) -> None:
    """Lk = Tw + Wr is a whole number for random corners and random directors."""
    x = random_polygon(seed, n)
    d = turned_directors(x, True, np.random.default_rng(seed).uniform(-9, 9, n))
    link = self_linking(x, d)
    assert link == pytest.approx(round(link), abs=1e-9)
    assert link == pytest.approx(twist(x, d, True) + writhe(x, True), abs=1e-12)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), turns=st.integers(-20, 20))
def test_link_is_that_with_the_curve_pushed_off(seed: int, turns: int) -> None:
    """Of a smooth loop: Tw + Wr equals the linking number with itself, pushed along its directors."""
    x = random_loop(seed, 150)
    assume(curve.turning_angles(x, True).max() < 1)  # at a cusp, what is pushed off would pass through it
    # The frame comes back turned by the holonomy; spread evenly, no hinge has much of it.
    around = 2 * np.pi * turns - curve.rotation_minimising_frames(x, True).holonomy
    wiggle = np.random.default_rng(seed).uniform(-0.3, 0.3, 150)
    d = turned_directors(x, True, around * np.arange(150) / 150 + wiggle)
    by = 0.01 * min(curve.edge_lengths(x, True).min(), curve.clearance([x], [True], 0.0).distance)
    expected = linking([x, pushed_off(x, d, by)], True)[0, 1]
    assert self_linking(x, d) == pytest.approx(expected, abs=1e-8)


def test_link_of_a_knot_pushed_off() -> None:
    """A trefoil framed by directors away from the core of its torus: Lk is -6, the framing of T(2, 3)."""
    n = 600
    x = torus_knot(2, 3, n)
    t = 2 * np.pi * (np.arange(n) + 0.5) / n
    core = 2 * np.stack([np.cos(2 * t), np.sin(2 * t), 0 * t], axis=1)
    d = (x + np.roll(x, -1, axis=0)) / 2 - core
    tangent = curve.tangents(x, True)
    d -= np.einsum("ec,ec->e", d, tangent)[:, None] * tangent
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    assert self_linking(x, d) == pytest.approx(-6, abs=1e-10)
    assert linking([x, pushed_off(x, d, 1e-3)], True)[0, 1] == pytest.approx(-6, abs=1e-9)


@pytest.mark.parametrize(
    ("directors", "says"),
    [
        (np.zeros((5, 3)), "directors have shape (5, 3); give one for each edge, shape (6, 3)"),
        (np.tile([0.0, 0.0, 2.0], (6, 1)), "the director of edge 0 has length 2"),
        (curve.tangents(ring(6), True), "1 of it along the edge; give unit vectors perpendicular"),
        (np.full((6, 3), np.nan), "the director of edge 0 has length nan"),
    ],
)
def test_wrong_directors_are_refused(directors: Any, says: str) -> None:
    with pytest.raises(TorsadeError) as caught:
        twist(ring(6), directors, True)
    assert says in str(caught.value)


def test_a_fold_is_refused() -> None:
    x = [[0, 0, 0], [1, 0, 0], [0.5, 0, 0]]
    with pytest.raises(TorsadeError, match="folds straight back after edge 0"):
        twist(x, [[0, 0, 1], [0, 0, 1]], False)
