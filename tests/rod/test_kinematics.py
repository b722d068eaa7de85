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
    edge_geometry,
    reference_twist,
    reference_twist_change,
    small_atan,
    transport,
    transport_directors,
)


def unit(rng, n=None):
    u = rng.normal(size=3 if n is None else (n, 3))
    return u / np.linalg.norm(u, axis=-1, keepdims=True)


def tangents(a, x):
    length, tangent = np.empty(len(a.edges)), np.empty((len(a.edges), 3))
    edge_geometry(x, a.edges, length, tangent)
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


def test_directors_are_carried_in_place():
    """transport_directors is transport, edge by edge, even though it writes what it reads."""
    rng = np.random.default_rng(3)
    t0, t1 = unit(rng, 20), unit(rng, 20)
    d = np.cross(t0, unit(rng, 20))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    expected = np.empty_like(d)
    for e in range(20):
        transport(d[e], t0[e], t1[e], expected[e])
    transport_directors(d, t0, t1)
    assert np.array_equal(d, expected)


@settings(deadline=None, max_examples=200)
@given(st.floats(-1, 1), st.floats(-1, 1), st.sampled_from([1.0, 1e-2, 1e-4, 1e-9]))
def test_small_atan_is_atan2(y, x, size):
    """The series is exact to round-off where it is used, and atan2 everywhere else."""
    if x == y == 0:
        return
    expected = math.atan2(y * size, x)
    assert small_atan(y * size, x) == pytest.approx(expected, rel=4e-16, abs=1e-300)


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("size", [1e-6, 1e-2, 0.3])
def test_two_ways_to_the_reference_twist(case, size):
    """The area swept on the unit sphere equals what the transported directors show (Bergou 2010, 4)."""
    a, state = three_cases()[case]
    rng = np.random.default_rng(case)
    moved = state.x + size * 0.1 * rng.normal(size=state.x.shape)
    _, t0 = tangents(a, state.x)
    _, t1 = tangents(a, moved)
    before = state.reference_twist.copy()
    reference_twist(state.director, t0, a.hinges, before)
    assert np.allclose(before, state.reference_twist, rtol=0, atol=1e-13)
    change = np.empty(len(a.hinges))
    reference_twist_change(t0, t1, a.hinges, change)
    director, after = state.director.copy(), state.reference_twist + change
    transport_directors(director, t0, t1)
    reference_twist(director, t1, a.hinges, after)
    assert np.allclose(after - state.reference_twist, change, rtol=0, atol=1e-12)
    assert np.abs(change).max() > 0.01 * size**2


def test_reference_twist_is_unwrapped():
    """Whole turns already there are kept: the value nearest to the old one is taken."""
    a, state = three_cases()[0]
    _, t = tangents(a, state.x)
    for turns in (-2, 1, 7):
        twist = state.reference_twist + 2 * np.pi * turns + 0.9 * np.pi
        reference_twist(state.director, t, a.hinges, twist)
        assert np.allclose(twist, state.reference_twist + 2 * np.pi * turns, rtol=0, atol=1e-12)


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
        reference_twist_change(t0, t1, a.hinges, change)
        state.reference_twist[:] += change
        t0 = t1
        link = state.reference_twist.sum() / (2 * np.pi) + writhe(x)
        assert link == pytest.approx(round(link), abs=1e-10)
