"""Frames: what transport keeps, and two independent ways to the reference twist."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rod.helpers import random_loop, three_cases, total_twist, writhe
from torsade.assembly import assemble, initial_state
from torsade.rod.kinematics import (
    carry_directors,
    edge_geometry,
    reference_twist_change,
    small_atan,
    spread_directors,
    transport,
)


def unit(rng, n=None):
    u = rng.normal(size=3 if n is None else (n, 3))
    return u / np.linalg.norm(u, axis=-1, keepdims=True)


def tangents(a, x):
    length, tangent = np.empty(len(a.edges)), np.empty((len(a.edges), 3))
    edge_geometry(a, x, length, tangent)
    return length, tangent


def test_lengths_and_tangents():
    """Edge vector = length times unit tangent."""
    for a, state in three_cases():
        length, tangent = tangents(a, state.x)
        edge = state.x[a.edges[:, 1]] - state.x[a.edges[:, 0]]
        assert np.allclose(length, np.linalg.norm(edge, axis=1), rtol=1e-15)
        assert np.allclose(length[:, None] * tangent, edge, rtol=0, atol=1e-16)


@settings(deadline=None, max_examples=200)
@given(st.integers(0, 10**6), st.floats(1e-9, 3.0))
def test_transport_is_the_least_rotation(seed, angle):
    """It takes a to b, keeps angles and lengths, and leaves the axis a x b alone (Bishop 1975)."""
    rng = np.random.default_rng(seed)
    a, axis = unit(rng), unit(rng)
    axis -= (axis @ a) * a
    axis /= np.linalg.norm(axis)
    b = np.cos(angle) * a + np.sin(angle) * np.cross(axis, a)
    b /= np.linalg.norm(b)
    u = np.cross(a, unit(rng))
    u /= np.linalg.norm(u)
    w = np.cross(a, u)
    moved, other = np.empty(3), np.empty(3)
    transport(u, a, b, moved)
    transport(w, a, b, other)
    assert abs(moved @ b) < 1e-14
    assert abs(moved @ moved - 1) < 1e-14
    assert abs(moved @ other) < 1e-12
    assert abs(np.cross(moved, other) @ b - 1) < 1e-12
    assert moved @ axis == pytest.approx(u @ axis, abs=1e-12)
    back = np.empty(3)
    transport(moved, b, a, back)
    assert np.allclose(back, u, rtol=0, atol=1e-12)


def carried(director, t0, t1):
    """All directors transported from tangents t0 to t1."""
    out = np.empty_like(director)
    for e in range(len(director)):
        transport(director[e], t0[e], t1[e], out[e])
    return out


def test_first_directors_are_carried_in_place():
    """carry_directors is transport of the first edge of every fiber, even though it writes what it reads."""
    rng = np.random.default_rng(3)
    t0, t1 = unit(rng, 20), unit(rng, 20)
    d = np.cross(t0, unit(rng, 20))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    expected = d.copy()
    expected[[0, 7]] = carried(d, t0, t1)[[0, 7]]
    carry_directors(np.array([0, 7, 20]), d, t0, t1)
    assert np.array_equal(d, expected)


@settings(deadline=None, max_examples=200)
@given(st.floats(-0.02, 0.02), st.sampled_from([1.0, 1e-2, 1e-4, 1e-9]))
def test_small_atan_is_atan(q, size):
    """The series is exact to round-off where it is used."""
    assert small_atan(q * size) == pytest.approx(math.atan(q * size), rel=4e-16, abs=1e-300)


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("size", [1e-6, 1e-2, 0.3])
def test_two_ways_to_the_directors(case, size):
    """Directors transported one by one are those that the first one and the swept areas give.

    The area swept on the unit sphere is the change of reference twist (Bergou 2010, 4).
    """
    a, state = three_cases()[case]
    rng = np.random.default_rng(case)
    moved = state.x + size * 0.1 * rng.normal(size=state.x.shape)
    _, t0 = tangents(a, state.x)
    _, t1 = tangents(a, moved)
    spread = state.director.copy()
    spread_directors(a.hinges, t0, state.reference_twist, spread)
    assert np.allclose(spread, state.director, rtol=0, atol=1e-13)
    change = np.empty(len(a.hinges))
    reference_twist_change(a, t0, t1, change)
    carry_directors(a.edge_start, spread, t0, t1)
    spread_directors(a.hinges, t1, state.reference_twist + change, spread)
    assert np.allclose(spread, carried(state.director, t0, t1), rtol=0, atol=1e-12)
    assert np.abs(change).max() > 0.01 * size**2


@pytest.mark.parametrize("seed", range(8))
def test_a_closed_fiber_starts_with_whole_link(seed):
    """Tw + Wr of any closed polygon is a whole number (Calugareanu, White, Fuller), exactly."""
    x = random_loop(seed, 60)
    a = assemble([x], [True])
    state = initial_state(a, [x])
    link = total_twist(a, state) / (2 * np.pi) + writhe(x)
    assert link == pytest.approx(round(link), abs=1e-11)
    assert abs(writhe(x)) > 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_link_survives_large_deformation(seed):
    """Carried through 40 large steps towards another curve, Tw + Wr changes by whole crossings only."""
    x0, x1 = random_loop(seed, 60), random_loop(seed + 100, 60)
    a = assemble([x0], [True])
    state = initial_state(a, [x0])
    _, t0 = tangents(a, x0)
    change = np.empty(len(a.hinges))
    for s in np.linspace(0, 1, 41)[1:]:
        x = (1 - s) * x0 + s * x1
        _, t1 = tangents(a, x)
        reference_twist_change(a, t0, t1, change)
        state.reference_twist[:] += change
        t0 = t1
        link = state.reference_twist.sum() / (2 * np.pi) + writhe(x)
        assert link == pytest.approx(round(link), abs=1e-10)
